"""What verbs may write onto: never a file that they read; an existing model or copy with --force only."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import click

FORCE: Any = click.option("--force", is_flag=True, help="Replace a file that exists.")


def check(outputs: Iterable[Path | None], inputs: Iterable[Path | str | None], force: bool = True) -> None:
    """Refuse, before anything is computed, outputs that cannot be written, that are inputs, or that exist where
    ``force`` is False."""
    from febkit.files import keep_apart, may_write

    targets = [p for p in outputs if p is not None]
    keep_apart([("output", p, None) for p in targets], [("input", p, None) for p in inputs if p is not None])
    for p in targets:
        may_write(p, force)
