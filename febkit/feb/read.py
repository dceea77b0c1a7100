"""A .feb file to a Model."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

from febkit.model import InputError, Model, Where

from .build import ModelBuilder
from .document import parse


def read(path: str | PathLike[str]) -> Model:
    """The model in a .feb file. Raises InputError with file and line where it cannot be read."""
    p = Path(path)
    try:
        data = p.read_bytes()
    except OSError as e:
        raise InputError(f"cannot open the file: {e.strerror}", Where(str(p))) from None
    return read_bytes(data, str(p))


def read_bytes(data: bytes, file: str = "") -> Model:
    """The model in the bytes of a .feb file; ``file`` names it in messages and locates its includes."""
    doc = parse(data, file)
    root = doc.root
    if root.name != "febio_spec":
        raise InputError(f"this is no .feb file: its root is <{root.name}>, not <febio_spec>", root.where)
    version = root.need("version")
    if version != "4.0":
        raise InputError(f'febio_spec version "{version}" is not read', root.where)
    model = ModelBuilder(root, file, doc).build()
    object.__setattr__(model, "document", doc)
    doc.baseline = model
    return model
