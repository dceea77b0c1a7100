"""Meshes ready-made: blocks, cylinders and plugs of hexahedra."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from febkit.model import ElementBlock, InputError, Mesh

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def lattice(n: Sequence[int]) -> Ints:
    """Connectivity (element, 8) of hexahedra over a lattice of (nx + 1)(ny + 1)(nz + 1) nodes, x fastest."""
    nx, ny, nz = n
    k, j, i = (a.ravel() for a in np.meshgrid(np.arange(nz), np.arange(ny), np.arange(nx), indexing="ij"))

    def node(a: int, b: int, c: int) -> Ints:
        return np.asarray(((k + c) * (ny + 1) + j + b) * (nx + 1) + i + a)

    ring = ((0, 0), (1, 0), (1, 1), (0, 1))
    return np.stack([node(a, b, c) for c in (0, 1) for a, b in ring], axis=1)


def divisions(n: int, bias: float) -> Floats:
    """0 to 1 in n parts, each ``bias`` times as long as the one before."""
    steps = float(bias) ** np.arange(n)
    return np.concatenate([[0.0], np.cumsum(steps) / steps.sum()])


def block(
    size: Sequence[float], n: Sequence[int], origin: Sequence[float] = (0.0, 0.0, 0.0),
    bias: Sequence[float] = (1.0, 1.0, 1.0),
) -> tuple[Floats, Ints]:  # fmt: skip
    """Nodes and hexahedra of a box of edges ``size`` with its low corner at ``origin``.

    ``n`` elements along each axis; each is ``bias`` times as long as the one before it.
    """
    counts = [_count(v) for v in n]
    x, y, z = (o + s * divisions(k, b) for o, s, k, b in zip(origin, size, counts, bias, strict=True))
    Z, Y, X = np.meshgrid(z, y, x, indexing="ij")
    return np.stack([X.ravel(), Y.ravel(), Z.ravel()], axis=1), lattice(counts)


def cylinder(
    radius: float, height: float, n: tuple[int, int] = (4, 4), sector: str = "full", bias: float = 1.0
) -> tuple[Floats, Ints]:
    """Nodes and hexahedra of a cylinder around z, its bottom in z = 0, with a square core.

    n: (elements along the radius, elements along z); the core takes half of the radius. ``sector``: "full" or
    "quarter" (x, y >= 0). ``bias``: length of an element in z over that of the one below.
    """
    if sector not in ("full", "quarter"):
        raise InputError(f'sector must be "full" or "quarter", not {sector!r}')
    across, up = _count(n[0]), _count(n[1])
    core = max(1, -(-across // 2))
    rings = max(1, across - core)
    flat, quads = _disc(core, rings)
    if sector == "full":
        flat, quads = _turned(flat, quads)
    z = height * divisions(up, bias)
    X = np.concatenate([np.column_stack([radius * flat, np.full(len(flat), v)]) for v in z])
    layers = [np.hstack([quads + k * len(flat), quads + (k + 1) * len(flat)]) for k in range(up)]
    return X, np.concatenate(layers)


def _disc(core: int, rings: int) -> tuple[Floats, Ints]:
    """A quarter of the unit disc: a core of core x core quadrilaterals, bulged, and rings around it."""
    g = 0.5 * np.arange(core + 1) / core
    y, x = (a.ravel() for a in np.meshgrid(g, g, indexing="ij"))
    bulge = 1.0 - 0.3 * x * y / 0.25  # the core's corner is drawn in, so that no element has a straight angle
    flat = [np.column_stack([x * bulge, y * bulge])]
    k = core + 1
    at = np.arange(k * k).reshape(k, k)
    quads = [np.stack([at[:-1, :-1], at[:-1, 1:], at[1:, 1:], at[1:, :-1]], axis=-1).reshape(-1, 4)]
    rim = np.concatenate([at[:, -1], at[-1, -2::-1]])  # from the x axis around to the y axis
    angle = np.linspace(0.0, 0.5 * np.pi, len(rim))
    inner, outer = flat[0][rim], np.column_stack([np.cos(angle), np.sin(angle)])
    before, first = rim, k * k
    for r in range(1, rings + 1):
        s = r / rings
        flat.append((1 - s) * inner + s * outer)
        now = first + np.arange(len(rim))
        quads.append(np.stack([before[:-1], now[:-1], now[1:], before[1:]], axis=1))
        before, first = now, first + len(rim)
    return np.concatenate(flat), np.concatenate(quads)


def _turned(flat: Floats, quads: Ints) -> tuple[Floats, Ints]:
    """Four quarters, joined."""
    x, y = flat.T
    every = np.concatenate([np.column_stack(p) for p in ((x, y), (-y, x), (-x, -y), (y, -x))])
    conn = np.concatenate([quads + k * len(flat) for k in range(4)])
    _, first, back = np.unique(np.round(every, 9) + 0.0, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first)
    place = np.empty(len(first), dtype=np.int64)
    place[order] = np.arange(len(first))
    return every[first[order]], place[back.ravel()][conn]


def _count(v: Any) -> int:
    n = int(v)
    if n < 1 or n != v:
        raise InputError(f"a number of elements is a whole number from 1 on, not {v}")
    return n


def joined(mesh: Mesh, name: str, kind: str, X: Any, conn: Any) -> Mesh:
    """The mesh with one more part: nodes and elements are numbered on; nodes are not merged."""
    from dataclasses import replace

    X, conn = np.asarray(X, dtype=float), np.asarray(conn, dtype=np.int64)
    if X.ndim != 2 or X.shape[1] != 3 or not np.isfinite(X).all():
        raise InputError(f"nodes must be finite numbers (node, 3), not {X.shape}")
    if conn.ndim != 2 or conn.size == 0 or conn.min() < 0 or conn.max() >= len(X):
        raise InputError(f"elements must be 0-based rows of the {len(X)} nodes")
    if any(b.name == name for b in mesh.blocks):
        raise InputError(f'there is a part "{name}" already')
    first = 1 + max((int(b.ids.max()) for b in mesh.blocks if len(b.ids)), default=0)
    start = 1 + (int(mesh.node_ids.max()) if len(mesh.node_ids) else 0)
    new = ElementBlock(name, kind, np.arange(first, first + len(conn)), conn + len(mesh.X))
    ids = np.concatenate([mesh.node_ids, np.arange(start, start + len(X))]).astype(np.int64)
    return replace(mesh, node_ids=ids, X=np.vstack([mesh.X, X]), blocks=(*mesh.blocks, new))
