"""FEBio's plotfile (.xplt): container, reader, writer. Importing the writer costs numpy only."""
