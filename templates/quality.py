"""Quality of a mesh: Jacobians at integration points, scaled Jacobian, aspect ratio, volumes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from febkit.model.mesh import Floats, Ints

_HEX_SIGNS = np.array(
    [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1],
     [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]], dtype=float
)
_HEX_EDGES = (
    (0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7))
_TET_EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))
_PYRA_EDGES = ((0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 4), (2, 4), (3, 4))
_PENTA_EDGES = ((0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5))
# at each corner, its three neighbours in right-handed order
_HEX_CORNERS = (
    (1, 3, 4), (2, 0, 5), (3, 1, 6), (0, 2, 7), (7, 5, 0), (4, 6, 1), (5, 7, 2), (6, 4, 3))
_TET_CORNERS = ((1, 2, 3), (2, 0, 3), (0, 1, 3), (0, 2, 1))
_PYRA_CORNERS = ((1, 3, 4), (2, 0, 4), (3, 1, 4), (0, 2, 4))
_PENTA_CORNERS = ((1, 2, 3), (2, 0, 4), (0, 1, 5), (5, 4, 0), (3, 5, 1), (4, 3, 2))


def _hex_gradients(points: Floats) -> Floats:
    """dN/dxi (point, 8, 3) of the trilinear hexahedron, N_a = prod_i (1 + xi_i xi_ai)/8."""
    one = 1.0 + points[:, None, :] * _HEX_SIGNS
    x, y, z = one[..., 0], one[..., 1], one[..., 2]
    sx, sy, sz = _HEX_SIGNS.T
    return np.stack([sx * y * z, sy * x * z, sz * x * y], axis=-1) / 8.0


def _hex_jacobians(x: Floats) -> Floats:
    """det J (element, 8) at the 2x2x2 Gauss points (each of weight 1); x is (element, 8, 3)."""
    dN = _hex_gradients(_HEX_SIGNS / np.sqrt(3.0))
    J = np.matmul(x.swapaxes(1, 2)[:, None], dN[None])  # (element, point, 3, 3)
    det: Floats = np.einsum("epi,epi->ep", J[..., 0], np.cross(J[..., 1], J[..., 2]))
    return det


def _tet_jacobians(x: Floats) -> Floats:
    """Volume (element, 1) of the straight tetrahedron, exact for its constant Jacobian."""
    a, b, c = (x[:, i] - x[:, 0] for i in (1, 2, 3))
    v: Floats = np.einsum("ei,ei->e", a, np.cross(b, c)) / 6.0
    return v[:, None]


def _penta_jacobians(x: Floats) -> Floats:
    """w det J (element, 6) at the 3 x 2 points of the linear wedge."""
    r = np.array([[1 / 6, 1 / 6], [2 / 3, 1 / 6], [1 / 6, 2 / 3]])
    out = np.empty((len(x), 6))
    for p, (zeta, (s, t)) in enumerate((z, q) for z in (-1 / np.sqrt(3), 1 / np.sqrt(3)) for q in r):
        lo, hi = (1 - zeta) / 2, (1 + zeta) / 2
        dN = np.array([[-lo, -lo, -(1 - s - t) / 2], [lo, 0, -s / 2], [0, lo, -t / 2],
                       [-hi, -hi, (1 - s - t) / 2], [hi, 0, s / 2], [0, hi, t / 2]])
        out[:, p] = np.linalg.det(x.swapaxes(1, 2) @ dN) / 6.0
    return out


def _pyra_jacobians(x: Floats) -> Floats:
    """The pyramid is a hexahedron whose upper nodes are one: w det J (element, 8) at its 2x2x2 points."""
    return _hex_jacobians(x[:, [0, 1, 2, 3, 4, 4, 4, 4]])


@dataclass(frozen=True, slots=True)
class _Shape:
    corners: int
    edges: tuple[tuple[int, int], ...]
    frames: tuple[tuple[int, int, int], ...]
    jacobians: Callable[[Floats], Floats]
    scale: float  # makes the scaled Jacobian of the regular element 1


_HEXAHEDRON = _Shape(8, _HEX_EDGES, _HEX_CORNERS, _hex_jacobians, 1.0)
_TETRAHEDRON = _Shape(4, _TET_EDGES, _TET_CORNERS, _tet_jacobians, np.sqrt(2.0))
_WEDGE = _Shape(6, _PENTA_EDGES, _PENTA_CORNERS, _penta_jacobians, 2.0 / np.sqrt(3.0))
_PYRAMID = _Shape(5, _PYRA_EDGES, _PYRA_CORNERS, _pyra_jacobians, np.sqrt(2.0))  # by the corners of its base
SHAPES = {
    "hex8": _HEXAHEDRON, "hex20": _HEXAHEDRON, "hex27": _HEXAHEDRON, "tet4": _TETRAHEDRON,
    "tet10": _TETRAHEDRON, "penta6": _WEDGE, "pyra5": _PYRAMID,
}


@dataclass(frozen=True, slots=True)
class Quality:
    """Worst and typical figures of a mesh; elements are judged by their corners."""

    elements: int
    jacobian_min: float  # smallest det J at an integration point over the element's mean: > 0 is sound
    scaled_jacobian_min: float  # 1 for a cube, <= 0 where a corner is turned inside out
    scaled_jacobian_median: float
    aspect_max: float  # longest over shortest edge
    aspect_median: float

    def __str__(self) -> str:
        return (f"smallest Jacobian at a Gauss point {self.jacobian_min:.3f} of its element's mean; "
                f"scaled Jacobian min {self.scaled_jacobian_min:.3f}, "
                f"median {self.scaled_jacobian_median:.3f}; "
                f"edge ratio max {self.aspect_max:.2f}, median {self.aspect_median:.2f}")


def jacobians(X: Floats, kind: str, conn: Ints) -> Floats:
    """Weighted Jacobians (element, point); their sum over points is the element's volume."""
    shape = SHAPES[kind]
    return shape.jacobians(X[conn[:, :shape.corners]])


def volumes(X: Floats, kind: str, conn: Ints) -> Floats:
    """Element volumes (element,) by Gauss integration of the isoparametric map."""
    v: Floats = jacobians(X, kind, conn).sum(axis=1)
    return v


def scaled_jacobian(X: Floats, kind: str, conn: Ints) -> Floats:
    """Smallest over the corners of det[e1 e2 e3]/(|e1||e2||e3|), 1 for the regular element (element,).

    Knupp, P.M., 2000. Achieving finite element mesh quality via optimization of the Jacobian matrix
    norm and associated quantities. Int. J. Numer. Methods Eng. 48, 1165-1185.
    """
    shape = SHAPES[kind]
    x = X[conn[:, :shape.corners]]
    worst = np.full(len(conn), np.inf)
    for corner, (a, b, c) in enumerate(shape.frames):
        e = [x[:, n] - x[:, corner] for n in (a, b, c)]
        length = np.prod([np.linalg.norm(v, axis=1) for v in e], axis=0)
        det = np.einsum("ei,ei->e", e[0], np.cross(e[1], e[2]))
        np.minimum(worst, shape.scale * det / np.where(length > 0, length, 1.0), out=worst)
    return worst


def aspect(X: Floats, kind: str, conn: Ints) -> Floats:
    """Longest over shortest edge (element,)."""
    lengths = np.stack([np.linalg.norm(X[conn[:, a]] - X[conn[:, b]], axis=1) for a, b in SHAPES[kind].edges])
    ratio: Floats = lengths.max(axis=0) / lengths.min(axis=0)
    return ratio


def judge(X: Floats, parts: list[tuple[str, Ints]]) -> Quality:
    """Quality of all elements together."""
    jac, scaled, edges, count = [], [], [], 0
    for kind, conn in parts:
        j = jacobians(X, kind, conn)
        jac.append((j.min(axis=1) / np.abs(j.mean(axis=1))).min())
        scaled.append(scaled_jacobian(X, kind, conn))
        edges.append(aspect(X, kind, conn))
        count += len(conn)
    s, a = np.concatenate(scaled), np.concatenate(edges)
    return Quality(count, float(min(jac)), float(s.min()), float(np.median(s)), float(a.max()),
                   float(np.median(a)))
