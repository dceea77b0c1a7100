"""Mixtures of a solid, a fluid and solutes: biphasic-solute, triphasic and multiphasic materials at their points."""
