"""Nodes, facets and elements by a rule: ``m.nodes(z="max")``, ``m.faces(normal=(0, 0, 1))``."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from febkit.model import InputError, Mesh

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Mask = NDArray[np.bool_]
Rule = Callable[[Floats], Any]
AXES = "xyz"
CLOSE = 1e-6  # of the mesh's size: places nearer than this are the same


class Nodes:
    """Some nodes of a mesh: ``index`` (0-based), ``ids`` (the file's labels), ``X`` (n, 3). Combine with & | - ~."""

    def __init__(self, mesh: Mesh, index: Any) -> None:
        self.mesh = mesh
        self.index: Ints = np.asarray(index, dtype=np.int64)

    @property
    def ids(self) -> Ints:
        return np.asarray(self.mesh.node_ids[self.index])

    @property
    def X(self) -> Floats:
        return np.asarray(self.mesh.X[self.index])

    def __len__(self) -> int:
        return len(self.index)

    def __and__(self, other: Nodes) -> Nodes:
        return Nodes(self.mesh, self.index[np.isin(self.index, other.index)])

    def __or__(self, other: Nodes) -> Nodes:
        return Nodes(self.mesh, np.union1d(self.index, other.index))

    def __sub__(self, other: Nodes) -> Nodes:
        return Nodes(self.mesh, self.index[~np.isin(self.index, other.index)])

    def __invert__(self) -> Nodes:
        return Nodes(self.mesh, np.setdiff1d(np.arange(len(self.mesh.X)), self.index))

    def __repr__(self) -> str:
        return f"{len(self)} of {len(self.mesh.X)} nodes"


class Faces:
    """Outer facets of a mesh: ``facets`` by type, (f, nodes) 0-based, outward; combine with | ."""

    def __init__(self, mesh: Mesh, facets: Mapping[str, Ints]) -> None:
        self.mesh = mesh
        self.facets = {k: np.asarray(v) for k, v in facets.items() if len(v)}

    @property
    def nodes(self) -> Nodes:
        flat = [f.ravel() for f in self.facets.values()]
        return Nodes(self.mesh, np.unique(np.concatenate(flat)) if flat else [])

    def __len__(self) -> int:
        return sum(map(len, self.facets.values()))

    def __or__(self, other: Faces) -> Faces:
        kinds = self.facets.keys() | other.facets.keys()
        empty = np.zeros((0, 0), int)
        both = {k: [f for f in (self.facets.get(k, empty), other.facets.get(k, empty)) if len(f)] for k in kinds}
        return Faces(self.mesh, {k: _distinct(np.concatenate(v)) for k, v in both.items()})

    def __repr__(self) -> str:
        return ", ".join(f"{len(v)} {k}" for k, v in self.facets.items()) or "no facets"


class Elements:
    """Some elements of a mesh by their ids."""

    def __init__(self, mesh: Mesh, ids: Any) -> None:
        self.mesh = mesh
        self.ids: Ints = np.asarray(ids, dtype=np.int64)

    def __len__(self) -> int:
        return len(self.ids)

    def __repr__(self) -> str:
        return f"{len(self)} of {sum(len(b.ids) for b in self.mesh.blocks)} elements"


def _distinct(f: Ints) -> Ints:
    _, first = np.unique(np.sort(f, axis=1), axis=0, return_index=True)
    return np.asarray(f[np.sort(first)])


def size(X: Floats) -> float:
    """Longest edge of the bounding box."""
    return float(np.ptp(X, axis=0).max()) if len(X) else 1.0


def chosen(
    X: Floats, whole: Floats, *, x: Any = None, y: Any = None, z: Any = None, plane: Any = None, box: Any = None,
    sphere: Any = None, where: Rule | None = None, tol: float | None = None,
) -> Mask:  # fmt: skip
    """Which places ``X`` (n, 3) meet all of the rules; "min" and "max" are those of ``whole``.

    x, y, z: a number, "min", "max" or a pair (least, greatest), None where one side is open; plane: (point, normal);
    box: (low corner, high corner); sphere: (centre, radius); where: function of X (n, 3) that gives a mask. Places
    within ``tol`` of a bound count; by default a millionth of the mesh's size.
    """
    slack = CLOSE * size(whole) if tol is None else tol
    keep = np.ones(len(X), dtype=bool)
    for k, at in enumerate((x, y, z)):
        if at is not None:
            keep &= _along(X[:, k], whole[:, k], at, slack, AXES[k])
    if plane is not None:
        point, normal = (np.asarray(v, dtype=float) for v in plane)
        keep &= np.abs((X - point) @ (normal / np.linalg.norm(normal))) <= slack
    if box is not None:
        low, high = (np.asarray(v, dtype=float) for v in box)
        keep &= (np.abs(X - 0.5 * (low + high)) <= 0.5 * (high - low) + slack).all(axis=1)
    if sphere is not None:
        centre, radius = np.asarray(sphere[0], dtype=float), float(sphere[1])
        keep &= np.linalg.norm(X - centre, axis=1) <= radius + slack
    if where is not None:
        mask = np.asarray(where(X))
        if mask.shape != keep.shape or mask.dtype != bool:
            raise InputError("where= must give one truth value for each place (n,) of X (n, 3)")
        keep &= mask
    return keep


def _along(v: Floats, whole: Floats, at: Any, slack: float, axis: str) -> Mask:
    if isinstance(at, str):
        if at not in ("min", "max"):
            raise InputError(f'{axis} = {at!r}: a number, "min", "max" or a pair (least, greatest) is wanted')
        at = float(whole.min() if at == "min" else whole.max())
    if isinstance(at, Sequence):
        low, high = at
        keep = np.ones(len(v), dtype=bool)
        keep &= v >= low - slack if low is not None else True
        keep &= v <= high + slack if high is not None else True
        return keep
    return np.asarray(np.abs(v - float(at)) <= slack)


def outer_facets(mesh: Mesh, part: str | None = None) -> dict[str, Ints]:
    """Facets that belong to one element only, by type, outward; shells give their own faces."""
    from febkit.solver import elements

    found: dict[str, list[Ints]] = {}
    blocks = [b for b in mesh.blocks if part is None or b.name == part]
    if not blocks:
        raise InputError(f'there is no part "{part}"; the mesh has {", ".join(b.name for b in mesh.blocks) or "none"}')
    for b in blocks:
        if b.type in elements.VOLUMES:
            for kind, local in elements.get(b.type).facets:
                found.setdefault(kind, []).append(b.conn[:, list(local)])
    out = {}
    for kind, parts in found.items():
        f = np.concatenate(parts)
        _, first, count = np.unique(np.sort(f, axis=1), axis=0, return_index=True, return_counts=True)
        out[kind] = f[np.sort(first[count == 1])]
    for b in blocks:
        if b.type in elements.FACETS:
            out[b.type] = np.concatenate([out[b.type], b.conn]) if b.type in out else b.conn
    return out


def normals(X: Floats, facets: Ints, kind: str) -> Floats:
    """Unit normals (f, 3) at the middle of facets."""
    from febkit.solver import elements

    corners = elements.get(kind).corners
    p = X[facets[:, :corners]]
    a, b = (p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]) if corners == 3 else (p[:, 2] - p[:, 0], p[:, 3] - p[:, 1])
    n = np.cross(a, b)
    return np.asarray(n / np.linalg.norm(n, axis=1)[:, None])


def faces(mesh: Mesh, *, part: str | None = None, normal: Any = None, within: float = 1.0, **rules: Any) -> Faces:
    """Outer facets all of whose nodes meet the rules of :func:`chosen`, whose normal is within ``within`` degrees."""
    out = {}
    for kind, f in outer_facets(mesh, part).items():
        keep = np.ones(len(f), dtype=bool)
        if normal is not None:
            n = np.asarray(normal, dtype=float)
            keep &= normals(mesh.X, f, kind) @ (n / np.linalg.norm(n)) >= np.cos(np.radians(within))
        if any(v is not None for v in rules.values()):
            keep &= chosen(mesh.X, mesh.X, **rules)[f].all(axis=1)
        out[kind] = f[keep]
    return Faces(mesh, out)


def nodes(mesh: Mesh, *, part: str | None = None, **rules: Any) -> Nodes:
    """Nodes that meet the rules of :func:`chosen`, of a part where one is named."""
    keep = chosen(mesh.X, mesh.X, **rules)
    if part is not None:
        mine = np.zeros(len(mesh.X), dtype=bool)
        mine[_block(mesh, part).conn.ravel()] = True
        keep &= mine
    return Nodes(mesh, np.flatnonzero(keep))


def elements_of(mesh: Mesh, *, part: str | None = None, **rules: Any) -> Elements:
    """Elements whose centre meets the rules of :func:`chosen`, of a part where one is named."""
    blocks = mesh.blocks if part is None else (_block(mesh, part),)
    ids = [b.ids[chosen(mesh.X[b.conn].mean(axis=1), mesh.X, **rules)] for b in blocks]
    return Elements(mesh, np.concatenate(ids) if ids else [])


def _block(mesh: Mesh, part: str) -> Any:
    for b in mesh.blocks:
        if b.name == part:
            return b
    raise InputError(f'there is no part "{part}"; the mesh has {", ".join(b.name for b in mesh.blocks) or "none"}')
