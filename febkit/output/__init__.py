"""Listeners of a run: plotfile, log, data files, progress bar."""
