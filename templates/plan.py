"""Quadrilaterals in a plane, from which layers grow: a rectangle, and a disc (O-grid) or a quarter of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from febkit.model.mesh import Floats, Ints

from .lattice import in_file_order, spaced

CORE, ROUND = 0.55, 0.6  # share of the radius that the core takes; how round it is (0 square, 1 circle)


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """Nodes ``x`` (node, 2), ``quads`` (quad, 4) counter-clockwise, and named lines (line, 2) of the outline, the
    plane on their left."""

    x: Floats
    quads: Ints
    lines: Mapping[str, Ints]


def rectangle(size: tuple[float, float], n: tuple[int, int]) -> Plan:
    """A rectangle around the origin; lines ``left right front back``."""
    x, y = (np.linspace(-s / 2.0, s / 2.0, k + 1) for s, k in zip(size, n, strict=True))
    ids = np.arange((n[0] + 1) * (n[1] + 1)).reshape(n[1] + 1, n[0] + 1).T
    Y, X = np.meshgrid(y, x, indexing="ij")
    lines = {"left": ids[0, ::-1], "right": ids[-1], "front": ids[:, 0], "back": ids[::-1, -1]}
    return Plan(np.stack([X.ravel(), Y.ravel()], axis=1), _quads(ids), {k: _chain(v) for k, v in lines.items()})


def disc(radius: float, n: int, rings: int, quarter: bool, ratio: float = 1.0, share: float = CORE) -> Plan:
    """A disc around the origin, ``n`` elements from its centre to the edge of the core and ``rings`` around it.

    ``share``: of the radius, that the core takes. ``ratio``: the outermost ring's width over the innermost's.
    ``quarter``: x, y >= 0 alone. Lines: ``rim``, of a quarter also ``x_plane`` (x = 0) and ``y_plane`` (y = 0).
    """
    low = 0 if quarter else -n
    at = np.arange(low, n + 1)
    ids = np.arange(len(at) ** 2).reshape(len(at), len(at)).T
    i, j = np.meshgrid(at, at, indexing="ij")
    t = np.tan(np.pi / 4.0 * in_file_order(np.stack([i, j], axis=-1)[:, :, None]) / n)
    core = _core(t) * radius * share
    edge = _outline(ids, quarter)
    angle = np.arctan2(*t[edge].T[::-1])
    rim = radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    if quarter:  # exactly on the planes of symmetry
        rim[0, 1] = rim[-1, 0] = 0.0
    x, rows = [core], [edge]
    for f in spaced(0.0, 1.0, rings, ratio)[1:]:
        rows.append(len(core) + (len(rows) - 1) * len(edge) + np.arange(len(edge)))
        x.append((1.0 - f) * core[edge] + f * rim)
    levels = np.stack(rows)  # (ring, node along it)
    if not quarter:
        levels = np.concatenate([levels, levels[:, :1]], axis=1)
    lines = {"rim": _chain(levels[-1])}
    if quarter:
        lines |= {"y_plane": _chain(np.concatenate([ids[:-1, 0], levels[:, 0]])),
                  "x_plane": _chain(np.concatenate([ids[0, :-1], levels[:, -1]])[::-1])}
    return Plan(np.concatenate(x), np.concatenate([_quads(ids), _quads(levels)]), lines)


def _core(t: Floats) -> Floats:
    """A core of radius 1, between a square and a disc."""
    reach = np.abs(t).max(axis=1, keepdims=True)
    length = np.linalg.norm(t, axis=1, keepdims=True)
    ball = reach * t / np.where(length > 0.0, length, 1.0)
    w = ROUND * reach
    x: Floats = (1.0 - w) * t / np.sqrt(2.0) + w * ball
    return x


def _outline(ids: Ints, quarter: bool) -> Ints:
    """Nodes around the core, counter-clockwise: of a quarter from the x axis to the y axis, else once around."""
    if quarter:
        return np.concatenate([ids[-1, :-1], ids[::-1, -1]])
    return np.concatenate([ids[:-1, 0], ids[-1, :-1], ids[:0:-1, -1], ids[0, :0:-1]])


def _quads(ids: Ints) -> Ints:
    """Quads of a lattice (i, j) of node numbers, i fastest."""
    quads: Ints = np.stack([ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]], axis=-1)
    return quads.swapaxes(0, 1).reshape(-1, 4)


def _chain(nodes: Ints) -> Ints:
    return np.stack([nodes[:-1], nodes[1:]], axis=1)
