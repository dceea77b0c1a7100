"""``python -m febkit``."""

from febkit.cli.main import main

main()
