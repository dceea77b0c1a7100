"""A .feb file of any version to a Model."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

from febkit.model import InputError, Model, Where

from . import convert, include, nested
from .build import ModelBuilder
from .document import Document, Tag, parse
from .edit import clone


def read(path: str | PathLike[str]) -> Model:
    """The model in a .feb file of version 1.0 to 4.0, with the files it includes.

    Raises InputError with file and line where it cannot be read. ``model.version`` is the file's own;
    the records are those of version 4.0.
    """
    return _read(Path(path), 0)


def _read(p: Path, depth: int) -> Model:
    """A file that is named in another at a depth, 0 for the user's own."""
    try:
        data = include.contents(p)
    except OSError as e:
        raise InputError(f"cannot open the file: {e.strerror}", Where(str(p))) from None
    return read_bytes(data, str(p), depth)


def read_bytes(data: bytes, file: str = "", depth: int = 0) -> Model:
    """The model in the bytes of a .feb file; ``file`` names it in messages and locates its includes."""
    doc = parse(data, file)
    try:
        root, own = tree(doc, file)
        model = ModelBuilder(root, file, doc if own else None).build()
    except InputError as e:  # of a tag that a conversion has made
        raise e if e.where is not None and e.where.file else type(e)(e.message, Where(file)) from None
    object.__setattr__(model, "version", doc.root.need("version"))
    object.__setattr__(model, "document", doc)
    object.__setattr__(model, "nested", nested.read(model, _read, depth))
    doc.baseline, doc.own = model, own
    return model


def sources(model: Model) -> list[str]:
    """The files that a model was read from: its own and those it includes."""
    doc = model.document
    included = doc.sources if isinstance(doc, Document) else ()
    return list(dict.fromkeys(f for f in (model.file, *included) if f))


def tree(doc: Document, file: str) -> tuple[Tag, bool]:
    """The file's tree raised to version 4.0, and whether it is the document's own."""
    root = doc.root
    if root.name != "febio_spec":
        raise InputError(f"this is no .feb file: its root is <{root.name}>, not <febio_spec>", root.where)
    foreign = any(t.name == "Include" or "from" in t.attrs for t in root)
    if root.need("version") == "4.0" and not foreign:
        return root, True
    root = clone(root)
    if foreign:
        include.resolve(root, file)
        doc.sources = tuple(dict.fromkeys(t.doc.file for t in root if t.doc is not None))
    convert.up(root)
    return root, False
