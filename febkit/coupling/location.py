"""Find the element that holds a point, and the point's natural coordinates in it.

Elements are sorted by size; in each class a k-d tree of centres gives those whose bounding sphere can
hold the point, bounding boxes thin them out, and Newton's method inverts the isoparametric map
X(r) = sum_a N_a(r) X_a for all remaining pairs of point and element at once.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from febkit.model import InputError

from .field import Block, Field
from .shapes import outside, shape

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

TOLERANCE = 1e-6  # in natural coordinates: a point this far outside still counts as on the surface
_BULGE = {"hex8": 0.05, "tet4": 1e-5}  # how far an element's edges and faces may leave the box of its nodes


@dataclass(frozen=True, slots=True, eq=False)
class Location:
    """Where points lie: ``block`` (m,), ``element`` (m,) row in that block, ``r`` (m, 3); -1 where outside.

    ``sharing`` (m,) counts the elements that hold a point: more than 1 on faces, edges and nodes.
    """

    block: Ints
    element: Ints
    r: Floats
    sharing: Ints

    @property
    def inside(self) -> NDArray[np.bool_]:
        return self.block >= 0


def locate(field: Field, points: Floats) -> Location:
    """The element of each point (m, 3) in the reference configuration.

    A point that several elements share is given to the one listed first.
    """
    points = np.atleast_2d(np.asarray(points, dtype=float))
    m = len(points)
    best = np.full(m, np.iinfo(np.int64).max)
    out = Location(np.full(m, -1), np.full(m, -1), np.zeros((m, 3)), np.zeros(m, dtype=np.int64))
    for k, block in enumerate(field.blocks):
        who, e = _candidates(field, k, block, points)
        if not len(who):
            continue
        r, ok = invert(block.type, field.X[block.conn[e]], points[who])
        ok &= outside(block.type, r) <= TOLERANCE
        who, e, r = who[ok], e[ok], r[ok]
        np.add.at(out.sharing, who, 1)
        order = np.argsort(block.index[e], kind="stable")[::-1]  # the first listed is written last
        who, e, r = who[order], e[order], r[order]
        better = block.index[e] < best[who]
        who, e, r = who[better], e[better], r[better]
        best[who], out.block[who], out.element[who], out.r[who] = block.index[e], k, e, r
    return out


def require_inside(field: Field, points: Floats, where: Location, what: str = "point") -> None:
    """Raises InputError that names by coordinates the points outside the tissue."""
    lost = np.nonzero(~where.inside)[0]
    if not len(lost):
        return
    from scipy.spatial import cKDTree

    near, node = (np.asarray(a) for a in cKDTree(field.X).query(points[lost]))
    label = node if field.node_ids is None else field.node_ids[node]
    lines = [f"({', '.join(f'{c:g}' for c in points[i])}), {d:.3g} from the nearest node {n}"
             for i, d, n in list(zip(lost, near, label))[:5]]
    more = f" and {len(lost) - 5} more" if len(lost) > 5 else ""
    low, high = field.X.min(axis=0), field.X.max(axis=0)
    box = " x ".join(f"[{a:g}, {b:g}]" for a, b in zip(low, high))
    raise InputError(f"{len(lost)} of {len(points)} {what}s outside the tissue, whose nodes span {box}: "
                     + "; ".join(lines) + more)


def _candidates(field: Field, k: int, block: Block, points: Floats) -> tuple[Ints, Ints]:
    """Pairs (point, element of the block) where the element's box holds the point."""
    boxes = field.cache.get(f"boxes{k}")
    if boxes is None:
        boxes = field.cache[f"boxes{k}"] = _boxes(field.X, block)
    center, half, classes = boxes
    who, found = [], []
    for tree, members, radius in classes:
        for i, near in enumerate(tree.query_ball_point(points, radius, return_sorted=True)):
            if near:
                who.append(np.full(len(near), i))
                found.append(members[near])
    if not who:
        return np.zeros(0, np.int64), np.zeros(0, np.int64)
    a, e = np.concatenate(who), np.concatenate(found)
    hold = (np.abs(points[a] - center[e]) <= half[e]).all(axis=1)
    return a[hold], e[hold]


def _boxes(X: Floats, block: Block) -> tuple[Floats, Floats, list]:
    """Centres and half sizes of the boxes, and a k-d tree per class of sizes (factor 2 each)."""
    from scipy.spatial import cKDTree

    xe = X[block.conn]
    low, high = xe.min(axis=1), xe.max(axis=1)
    center = 0.5 * (low + high)
    half = 0.5 * (high - low)
    half = half + _BULGE.get(block.type, 0.15) * half.max(axis=1, keepdims=True)
    radius = np.linalg.norm(half, axis=1)
    level = np.ceil(np.log2(np.maximum(radius, 1e-300)))
    classes = []
    for v in np.unique(level):
        members = np.nonzero(level == v)[0]
        classes.append((cKDTree(center[members]), members, radius[members].max() * (1 + 1e-12)))
    return center, half, classes


def invert(kind: str, xe: Floats, points: Floats, iterations: int = 30) -> tuple[Floats, NDArray[np.bool_]]:
    """Natural coordinates (m, 3) of points (m, 3) in elements ``xe`` (m, n, 3), and which converged."""
    from febkit.solver import elements

    e = elements.get(kind)
    r = np.tile(e.center.astype(float), (len(points), 1))
    done = np.zeros(len(points), dtype=bool)
    todo = np.arange(len(points))
    size = np.abs(xe - xe.mean(axis=1, keepdims=True)).max(axis=(1, 2))
    for _ in range(iterations):
        x, rr = xe[todo], r[todo]
        miss = points[todo] - np.einsum("pn,pni->pi", shape(kind, rr, 0), x)
        jac = np.einsum("pni,pnj->pij", x, shape(kind, rr, 1))
        step, good = _solve(jac, miss)
        long = np.abs(step).max(axis=1)
        r[todo] = np.clip(rr + step * np.minimum(1.0, 1.0 / np.maximum(long, 1e-300))[:, None], -4.0, 4.0)
        ready = (long < 1e-13) | (np.abs(miss).max(axis=1) < 1e-15 * size[todo])
        done[todo[ready & good]] = True
        todo = todo[~ready & good]
        if not len(todo):
            break
    # round-off keeps some points from the last digits: what counts is how near the map comes
    left = ~done
    if left.any():
        miss = points[left] - np.einsum("pn,pni->pi", shape(kind, r[left], 0), xe[left])
        done[left] = np.abs(miss).max(axis=1) < 1e-9 * size[left]
    return r, done


def _solve(a: Floats, b: Floats) -> tuple[Floats, NDArray[np.bool_]]:
    """Solves 3 x 3 systems; singular ones are told apart."""
    det = np.linalg.det(a)
    good = np.abs(det) > 1e-14 * np.abs(a).max(axis=(1, 2)) ** 3
    x = np.zeros_like(b)
    if good.any():
        x[good] = np.linalg.solve(a[good], b[good][..., None])[..., 0]
    return x, good
