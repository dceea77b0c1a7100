"""Models that a model names: the representative volumes of micro-materials, in files of its folder."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

from febkit.model import Component, InputError, Model

DEEPEST = 4  # volumes within volumes


def volumes(model: Model) -> Iterator[Component]:
    """The <RVE> of each micro-material."""
    ahead = list(model.materials)
    while ahead:
        c = ahead.pop()
        if c.type == "micro-material" and c.child("RVE") is not None:
            yield c.need("RVE")
        ahead += list(c)


def read(model: Model, read: Callable[[Path, int], Model], depth: int) -> dict[str, Model]:
    """The models of a model's volumes by the names it gives them, of those whose files are there.

    ``read`` reads a file at a depth. What is not there is missed where the model is solved, not where it is read.
    """
    out: dict[str, Model] = {}
    for leaf in volumes(model):
        name, path = leaf.text.strip(), _path(leaf, model.file)
        if name not in out and path is not None:
            if depth >= DEEPEST:
                raise InputError(f"{leaf.what}: volumes within volumes, {DEEPEST} deep and deeper", leaf.where)
            out[name] = read(path, depth + 1)
    return out


def _path(leaf: Component, file: str) -> Path | None:
    """The file that a tag names, None where the folder of the model has none of the name."""
    name, folder = leaf.text.strip().replace("\\", "/"), Path(file).resolve().parent
    if not file or not name or "\0" in name:
        return None
    found = (folder / name).resolve()
    return found if found.is_relative_to(folder) and found.is_file() else None
