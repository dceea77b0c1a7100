"""A Model to a .feb file."""

from __future__ import annotations

from os import PathLike

from febkit.files import put
from febkit.model import Model, as_record

from . import convert
from .document import Document
from .serialize import document_bytes
from .splice import splice
from .tree import tree


def to_bytes(model: Model, version: str | None = None) -> tuple[bytes, list[str]]:
    """The file's bytes, and what the version asked for cannot say.

    An untouched model written in its own version gives back the bytes it was read from; an edited one of
    version 4.0 differs from them only where it was edited.
    """
    model = as_record(model)
    if not isinstance(model, Model):
        raise TypeError(f"write(model, path) takes a model first, not {type(model).__name__}")
    version = str(version or (model.version if model.document is not None else "4.0"))
    doc = model.document
    notes: list[str] = []
    remarks: dict[str, list[str]] = {}
    if isinstance(doc, Document):
        if version == model.version and doc.baseline is model:
            return doc.data, []
        if version == model.version == "4.0" and doc.own:
            return splice(doc, doc.baseline, model), []
        remarks = doc.remarks
        comments = doc.data.count(b"<!--") - sum(map(len, remarks.values()))
        if comments > 0:
            notes.append(f"{comments} comments within sections: they stay behind in the file that was read")
    root = tree(model)
    notes += convert.down(root, version)
    return document_bytes(root, remarks), notes


def write(model: Model, path: str | PathLike[str], version: str | None = None, overwrite: bool = True) -> list[str]:
    """Writes a .feb file of version "4.0", "3.0", "2.5", "2.0" or "1.2" (default: the model's own).

    Returns a line for each thing that the version cannot say. Raises InputError for an unknown version, and where the
    file exists and ``overwrite`` is False.
    """
    data, notes = to_bytes(model, version)
    put(path, data, overwrite)
    return notes
