"""Parametrised models: those of the tissue-to-cell study, whole cartilage, and the hexahedral meshes they are made of.

``new("tissue", case="B", n=11)`` gives the model in memory; ``febkit new`` writes it.
"""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from febkit.model import Model

__all__ = ["new"]


def new(name: str, template: str | PathLike[str] | None = None, **values: Any) -> Model:
    """A template's model: ``name`` is tissue, cell, embedded, cartilage or chondron, ``values`` its parameters.

    ``template`` is a folder of one's own with a template.toml; ``size="small"`` picks a named size.
    """
    from febkit.model import Where

    from .template import load

    t = load(name, Path(template) if template is not None else None)
    return t.build(t.values([(values, Where())]))[0]
