"""Layers of wedges on the surfaces of cells, between the cell's tetrahedra and those of what surrounds it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from febkit.model import InputError, Where
from febkit.model.mesh import Floats, Ints

from .quality import jacobians


@dataclass(frozen=True, slots=True, eq=False)
class Region:
    """A closed region: the patches of triangles that bound it."""

    name: str
    patches: tuple[int, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Layered:
    """Nodes (node, 3), patches and regions without the layers, which are wedges by the name of the region they are in.
    """

    X: Floats
    patches: tuple[Ints, ...]
    regions: tuple[Region, ...]
    wedges: Mapping[str, Ints]


def layered(X: Floats, patches: Sequence[Ints], regions: Sequence[Region], layers: int, share: float,
            where: Where) -> Layered:
    """Regions that enclose nothing and lie in one other get ``layers`` of penta6 around them, out of the other.

    Nodes of the surface are moved along its normals by ``share`` of their distance to the other's next surface.
    """
    made: list[Ints] = list(patches)
    names: dict[str, list[Ints]] = {}
    outer = {r.name: list(r.patches) for r in regions}
    for r in regions:
        around = [o for o in regions if o is not r and set(r.patches) <= set(o.patches)]
        if len(r.patches) == 1 and around:
            name, k = around[0].name, r.patches[0]
            beside = np.unique(np.concatenate([patches[j].ravel() for j in around[0].patches if j != k]))
            triangles = _outward(X, patches[k])
            X, levels = _grown(X, triangles, X[beside], layers, share)
            wedges = np.concatenate([np.concatenate(pair, axis=1) for pair in zip(levels, levels[1:])])
            bad = int((jacobians(X, "penta6", wedges).min(axis=1) <= 0).sum())
            if bad:
                raise InputError(f"{bad} wedges around {r.name} are turned inside out: take a smaller wedge_share, "
                                 "more smoothing or a finer surface", where)
            names.setdefault(name, []).append(wedges)
            outer[name][outer[name].index(k)] = len(made)
            made.append(levels[-1])
    if not names:
        raise InputError('tets = "hybrid" puts wedges around parts that lie whole in one other, as cells in their PCM; '
                         "here is none: take tet4 or tet10", where)
    return Layered(X, tuple(made), tuple(Region(n, tuple(p)) for n, p in outer.items()),
                   {n: np.concatenate(w) for n, w in names.items()})


def _outward(X: Floats, triangles: Ints) -> Ints:
    """Closed triangles whose normals point out of what they enclose."""
    a, b, c = np.moveaxis(X[triangles], 1, 0)
    return triangles if np.einsum("ni,ni->", a, np.cross(b, c)) > 0 else triangles[:, ::-1]


def _grown(X: Floats, triangles: Ints, beside: Floats, layers: int, share: float) -> tuple[Floats, list[Ints]]:
    """Nodes with those of the layers, and the triangles of each level from the surface on."""
    from scipy.sparse import coo_matrix
    from scipy.spatial import cKDTree

    used, own = np.unique(triangles, return_inverse=True)
    own = own.reshape(-1, 3)
    a, b, c = (X[triangles[:, i]] for i in range(3))
    normal = np.zeros((len(used), 3))
    np.add.at(normal, own.ravel(), np.repeat(np.cross(b - a, c - a), 3, axis=0))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    ends = own[:, [0, 1, 2]].ravel(), own[:, [1, 2, 0]].ravel()
    link = coo_matrix((np.ones(len(ends[0])), ends), shape=(len(used), len(used))).tocsr()
    far = share * cKDTree(beside).query(X[used])[0]
    for _ in range(5):  # neighbours' thicknesses alike, none above its share
        far = np.minimum(far, 0.5 * far + 0.5 * (link @ far) / np.asarray(link.sum(axis=1)).ravel())
    added = [X[used] + (k / layers) * far[:, None] * normal for k in range(1, layers + 1)]
    first = len(X) + len(used) * np.arange(layers)
    return np.concatenate([X, *added]), [triangles, *(own + n for n in first)]
