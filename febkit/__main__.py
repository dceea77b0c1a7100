"""``python -m febkit``."""

from febkit.cli.main import command

command()
