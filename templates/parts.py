"""A mesh as templates build it: coordinates and, per named part, the elements of one type."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from febkit.model import Mesh, MeshData
from febkit.model.elements import ELEMENTS
from febkit.model.mesh import Floats, Ints


@dataclass(frozen=True, slots=True, eq=False)
class Parts:
    """Nodes ``X`` (node, 3) and parts: name -> (element type, connectivity (element, local)).

    ``shells`` are parts of facets between them, whose normals point to their front.
    """

    X: Floats
    parts: Mapping[str, tuple[str, Ints]]
    shells: Mapping[str, tuple[str, Ints]] = field(default_factory=dict)

    @property
    def elements(self) -> int:
        return sum(len(conn) for _, conn in (*self.parts.values(), *self.shells.values()))


@dataclass(frozen=True, slots=True, eq=False)
class Generated:
    """What a mesh generator hands back: the mesh, and what the template may ask about it.

    ``facts`` are names a template's expressions can use (``cells``: the numbers of the cells,
    ``parts``: the parts' names); ``report`` are lines about counts, quality and volumes; ``data`` are maps of elements.
    """

    mesh: Mesh
    facts: Mapping[str, Any] = field(default_factory=dict)
    report: Mapping[str, Any] = field(default_factory=dict)
    data: tuple[MeshData, ...] = ()


def body(part: str) -> str:
    """What a part belongs to: one whose elements are of several types has a part for each, named cell_1_tet4, ..."""
    name, _, kind = part.rpartition("_")
    return name if name and kind in ELEMENTS else part


def without_loose_nodes(X: Floats, parts: Mapping[str, tuple[str, Ints]]) -> Parts:
    """The parts with the nodes that they use."""
    used = np.unique(np.concatenate([conn.ravel() for _, conn in parts.values()]))
    new = np.full(len(X), -1, dtype=np.int64)
    new[used] = np.arange(len(used))
    return Parts(X[used], {name: (kind, new[conn]) for name, (kind, conn) in parts.items()})


def numbered(prefix: str, n: int) -> list[str]:
    """Names prefix_1 ... prefix_n."""
    return [f"{prefix}_{i}" for i in range(1, n + 1)]


def joined(arrays: list[Ints], width: int) -> Ints:
    """Rows of several connectivities in one array (an empty one where there are none)."""
    return np.concatenate(arrays) if arrays else np.empty((0, width), dtype=np.int64)
