"""Facets of a mesh: its outer surface and the surfaces between its parts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from febkit.model.elements import ELEMENTS
from febkit.model.mesh import Ints

FIRST = {"hex": 4, "tet": 3, "penta": 3, "pyra": 4}  # facets from which on each shape's bottom and top come


def _of(kind: str) -> tuple[tuple[int, ...], ...]:
    """Outward facets of an element type, its bottom and top first."""
    e = ELEMENTS[kind]
    loops, k = [nodes for _, nodes in e.facets], FIRST[e.shape]
    return (*loops[k:], *loops[:k])


FACETS = {kind: _of(kind) for kind in ("hex8", "hex20", "hex27", "tet4", "tet10", "penta6", "pyra5")}
FACET_TYPES = {(ELEMENTS[n].corners, ELEMENTS[n].nodes): n for n in ("quad4", "quad8", "quad9", "tri3", "tri6")}
_CORNERS = {nodes: corners for corners, nodes in FACET_TYPES}


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
