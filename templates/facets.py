"""Facets of a mesh: its outer surface and the surfaces between its parts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from febkit.model.mesh import Ints

# outward corner facets of each element type (FEBio User Manual, mesh section)
_HEX = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
_TET = ((0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3))
_PENTA = ((0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5))
# the mid-edge nodes of the same facets, in the order of FEBio's quad8 and tri6
_HEX20 = (
    (0, 3, 2, 1, 11, 10, 9, 8), (4, 5, 6, 7, 12, 13, 14, 15), (0, 1, 5, 4, 8, 17, 12, 16),
    (1, 2, 6, 5, 9, 18, 13, 17), (2, 3, 7, 6, 10, 19, 14, 18), (3, 0, 4, 7, 11, 16, 15, 19),
)
_HEX27 = tuple((*corners, centre) for corners, centre in zip(_HEX20, (24, 25, 20, 21, 22, 23), strict=True))
_TET10 = ((0, 2, 1, 6, 5, 4), (0, 1, 3, 4, 8, 7), (1, 2, 3, 5, 9, 8), (2, 0, 3, 6, 7, 9))
FACETS: dict[str, tuple[tuple[int, ...], ...]] = {
    "hex8": _HEX, "hex20": _HEX20, "hex27": _HEX27, "tet4": _TET, "tet10": _TET10, "penta6": _PENTA,
}
FACET_TYPES = {(4, 4): "quad4", (4, 8): "quad8", (4, 9): "quad9", (3, 3): "tri3", (3, 6): "tri6"}
_CORNERS = {4: 4, 8: 4, 9: 4, 3: 3, 6: 3}


@dataclass(frozen=True, slots=True, eq=False)
class Facets:
    """Facets of one shape between two parts.

    ``conn`` (facet, local) points out of part ``inside``; ``outside`` is -1 on the outer surface.
    """

    type: str
    conn: Ints
    inside: Ints
    outside: Ints


def _keys(conn: Ints, corners: int, nodes: int) -> Ints:
    """One integer per facet: its three smallest corners, which no two facets of a mesh share."""
    low = np.sort(conn[:, :corners], axis=1)[:, :3]
    return (low[:, 0] * nodes + low[:, 1]) * nodes + low[:, 2]


def between_parts(parts: Sequence[tuple[str, Ints]], nodes: int) -> list[Facets]:
    """Every facet on the outer surface or between two different parts, each from both sides.

    ``parts`` holds (element type, connectivity (element, local)); ``nodes`` is their number.
    """
    shapes: dict[tuple[int, int], list[tuple[Ints, Ints]]] = {}
    for number, (kind, conn) in enumerate(parts):
        for local in FACETS[kind]:
            facet = conn[:, local]
            owner = np.full(len(conn), number, dtype=np.int64)
            shapes.setdefault((_CORNERS[len(local)], len(local)), []).append((facet, owner))
    found = []
    for (corners, width), pieces in shapes.items():
        conn = np.concatenate([c for c, _ in pieces])
        owner = np.concatenate([o for _, o in pieces])
        other = _across(_keys(conn, corners, nodes), owner)
        keep = other != owner
        found.append(Facets(FACET_TYPES[corners, width], conn[keep], owner[keep], other[keep]))
    return found


def _across(keys: Ints, owner: Ints) -> Ints:
    """The part on the other side of each facet, -1 where there is none."""
    order = np.argsort(keys, kind="stable")
    k = keys[order]
    same = np.flatnonzero(k[1:] == k[:-1])
    a, b = order[same], order[same + 1]
    other = np.full(len(keys), -1, dtype=np.int64)
    other[a], other[b] = owner[b], owner[a]
    return other


def select(facets: Sequence[Facets], inside: Ints, outside: Ints | None = None) -> dict[str, Ints]:
    """Facets by type that point out of the parts ``inside`` into ``outside`` (None: anything else)."""
    chosen = {}
    for f in facets:
        keep = np.isin(f.inside, inside)
        keep &= ~np.isin(f.outside, inside) if outside is None else np.isin(f.outside, outside)
        if keep.any():
            chosen[f.type] = f.conn[keep]
    return chosen
