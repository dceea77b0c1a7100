"""A Model to a .feb file."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

from febkit.model import Model

from .serialize import document_bytes
from .tree import tree


def write(model: Model, path: str | PathLike[str], version: str = "4.0") -> list[str]:
    root = tree(model)
    Path(path).write_bytes(document_bytes(root))
    return []
