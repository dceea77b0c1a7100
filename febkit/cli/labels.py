"""What files are called in tables and figures."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click


def names(files: Sequence[Path], labels: Sequence[str]) -> list[str]:
    """The labels given, or the files' names without endings; their paths where those are the same."""
    if labels:
        if len(labels) != len(files):
            raise click.UsageError(f"{len(labels)} labels for {len(files)} files")
        twice = [n for n in labels if list(labels).count(n) > 1]
        if twice:
            raise click.UsageError(f'two files have the label "{twice[0]}"')
        return list(labels)
    plain = [f.stem for f in files]
    full = [str(f) for f in files]
    named = [p if plain.count(p) == 1 else f for p, f in zip(plain, full)]
    return [n if named.count(n) == 1 else f"{n} ({named[:k].count(n) + 1})" for k, n in enumerate(named)]
