"""A model solved at many values of its parameters: :func:`febkit.sweep`."""
