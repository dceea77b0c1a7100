"""A mesh as templates build it: coordinates and, per named part, the elements of one type."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from febkit.model import Mesh, MeshData
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


def numbered(prefix: str, n: int) -> list[str]:
    """Names prefix_1 ... prefix_n."""
    return [f"{prefix}_{i}" for i in range(1, n + 1)]


def joined(arrays: list[Ints], width: int) -> Ints:
    """Rows of several connectivities in one array (an empty one where there are none)."""
    return np.concatenate(arrays) if arrays else np.empty((0, width), dtype=np.int64)
