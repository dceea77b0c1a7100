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
    """The models of a model's volumes by the names it gives them; ``read`` reads a file at a depth."""
    out: dict[str, Model] = {}
    for leaf in volumes(model):
        name = leaf.text.strip()
        if name not in out:
            if depth >= DEEPEST:
                raise InputError(f"{leaf.what}: volumes within volumes, {DEEPEST} deep and deeper", leaf.where)
            out[name] = read(_path(leaf, model.file), depth + 1)
    return out


def _path(leaf: Component, file: str) -> Path:
    name, folder = leaf.text.strip().replace("\\", "/"), Path(file).resolve().parent
    found = (folder / name).resolve()
    if not file or not name or "\0" in name or not found.is_relative_to(folder):
        raise InputError(f'{leaf.what}: "{name}" is no file in the folder of the model', leaf.where)
    if not found.is_file():
        raise InputError(f'{leaf.what}: there is no file "{name}" in the folder of the model', leaf.where)
    return found
