"""Elements of a result sorted into groups of one type and one part."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from febkit.model import InputError
from febkit.results.mesh import texts

from .kinematics import Group
from .materials import closed_form

if TYPE_CHECKING:
    import xarray as xr

    from febkit.model import Component
    from febkit.solver.elements.base import Element

Ints = NDArray[np.int64]
CHUNK = 1024  # elements to a group: its arrays stay in the processor's cache


def element_of(type_name: str) -> Element:
    """The solid element of FEBio's name, with FEBio's default integration rule."""
    from febkit.solver import elements

    try:
        el = elements.get(type_name)
    except KeyError:
        raise InputError(f"elements of type {type_name!r} are unknown") from None
    if el.dim != 3:
        raise InputError(f"cells must be made of solid elements; {type_name} is not one")
    return el


def make(
    ds: xr.Dataset, rows: Ints, owner: Ints, materials: dict[str, Component] | None = None
) -> list[Group]:
    """Groups of at most :data:`CHUNK` of the elements ``rows`` (e,), of one element type and material each.

    Parts of one material go together; without ``materials`` all parts do.
    """
    parts, types = texts(ds, "parts"), texts(ds, "element_types")
    type_code = np.asarray(ds["element_type"].values)[rows]
    part_code = np.asarray(ds["part"].values)[rows] if parts else np.zeros(len(rows), dtype=int)
    conn = np.asarray(ds["connectivity"].values)[rows]
    X = np.asarray(ds["X"].values, dtype=float)
    label = {k: _label(parts, k, materials) for k in np.unique(part_code)}
    names = sorted(set(label.values()))
    code = np.array([names.index(label[k]) for k in part_code], dtype=int)
    out = []
    for t in np.unique(type_code):
        element = element_of(types[t])
        for m in np.unique(code[type_code == t]):
            pick = np.flatnonzero((type_code == t) & (code == m))
            for some in np.array_split(pick, -(-len(pick) // CHUNK)):
                nodes = np.ascontiguousarray(conn[some, : element.nodes].T)
                out.append(Group(element, rows[some], nodes, owner[some], names[m], X))
    return out


def _label(parts: list[str], k: int, materials: dict[str, Component] | None) -> str:
    """The part itself, or one that stands for all parts of its material where their law is one."""
    if not parts or materials is None or parts[k] not in materials:
        return ""
    mine = materials[parts[k]]
    return next(p for p in materials if materials[p] is mine) if closed_form(mine) else parts[k]
