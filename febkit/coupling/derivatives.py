"""Derivatives of a nodal field at points as linear operators: one sparse row per point and derivative.

Whatever the method, a derivative at a point is a weighted sum of nodal values, the same at all times, for
all displacement components, the pressure and the concentrations: d^a f(x) = sum_n w_n f_n. :data:`TERMS` lists the
derivatives.
"""

from __future__ import annotations

from itertools import combinations_with_replacement, permutations
from math import factorial
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from .field import Field
from .location import Location
from .shapes import shape

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Sparse: TypeAlias = Any  # a scipy.sparse.csr_array; scipy is imported where it is needed

MAX_ORDER = 3
# (), (0,), (1,), (2,), (0, 0), (0, 1), ...: value, first, second, third derivatives
TERMS: tuple[tuple[int, ...], ...] = tuple(
    axes for order in range(MAX_ORDER + 1) for axes in combinations_with_replacement(range(3), order)
)
COUNT = (1, 4, 10, 20)  # terms up to and with each order


def monomials(x: Floats, terms: tuple[tuple[int, ...], ...] = TERMS) -> Floats:
    """Terms of a Taylor series at offsets ``x`` (..., 3): x^a / a!, so that coefficients are derivatives."""
    x = np.asarray(x, dtype=float)
    out = np.empty((*x.shape[:-1], len(terms)))
    for k, axes in enumerate(terms):
        value = np.ones(x.shape[:-1])
        for a in axes:
            value = value * x[..., a]
        out[..., k] = value / np.prod([factorial(axes.count(a)) for a in range(3)])
    return out


def evaluate(coefficient: Floats, offset: Floats) -> Floats:
    """Series (t, terms, c) at offsets (n, 3): (t, n, c)."""
    basis = monomials(offset, TERMS[: coefficient.shape[1]])
    return np.asarray(np.matmul(basis[None], coefficient))


def gradient(coefficient: Floats, offset: Floats) -> Floats:
    """d(series)/dX at offsets: (t, n, c, 3) of coefficients (t, terms, c)."""
    terms = TERMS[: coefficient.shape[1]]
    index = {t: k for k, t in enumerate(TERMS)}
    out = []
    lower = [t for t in terms if len(t) < len(terms[-1])]
    basis = monomials(offset, tuple(lower))
    for axis in range(3):
        pick = [index[tuple(sorted((*t, axis)))] for t in lower]
        out.append(np.matmul(basis[None], coefficient[:, pick]))
    return np.stack(out, axis=-1)


def full(values: Floats, order: int) -> Floats:
    """Symmetric tensors (..., 3, 3, ...) of the derivatives of one order among ``values`` (..., 20)."""
    out = np.empty((*values.shape[:-1], *(3,) * order))
    start = COUNT[order] - (COUNT[order - 1] if order else 0)
    first = COUNT[order] - start
    for k, axes in enumerate(TERMS[first:COUNT[order]]):
        same: Any
        for same in set(permutations(axes)):
            out[(..., *same)] = values[..., first + k]
    return out


def packed(tensor: Floats, order: int) -> Floats:
    """The reverse of :func:`full` for one order: (..., 3, 3, ...) to (..., terms of that order)."""
    first = COUNT[order - 1] if order else 0
    terms: Any = TERMS[first:COUNT[order]]
    return np.stack([tensor[(..., *axes)] for axes in terms], axis=-1)


def rows(m: int, columns: Ints, weights: Floats, width: int) -> Sparse:
    """Sparse rows (m * k, width) of ``weights`` (m, n, k) at ``columns`` (m, n); columns < 0 are padding."""
    from scipy.sparse import csr_array

    k = weights.shape[2]
    live = columns >= 0
    count = live.sum(axis=1)
    indptr = np.concatenate([[0], np.cumsum(np.repeat(count, k))])
    cols = np.broadcast_to(columns[:, None, :], (m, k, columns.shape[1]))
    mask = np.broadcast_to(live[:, None, :], cols.shape)
    return csr_array((weights.transpose(0, 2, 1)[mask], cols[mask], indptr), shape=(m * k, width))


def apply(operator: Sparse, field: Field, terms: int) -> Floats:
    """Derivatives (point, time, term, column) of a field's values (:attr:`Field.columns`) from sparse rows."""
    used = np.unique(operator.indices)
    values = field.values[:, used]
    t, n, c = values.shape
    flat = np.ascontiguousarray(values.transpose(1, 0, 2)).reshape(n, t * c)
    small = operator[:, used] if len(used) < operator.shape[1] else operator
    out = (small @ flat).reshape(-1, terms, t, c)
    return np.ascontiguousarray(out.transpose(0, 2, 1, 3))


def by_element(field: Field, where: Location, terms: int = COUNT[-1]) -> Sparse:
    """The element's own derivatives, curvature of the map included.

    d2N/dX2 = J^-T (d2N/dr2 - dN/dX . d2X/dr2) J^-1, and likewise the third. In a trilinear brick that is a
    parallelepiped d2X/dr2 vanishes and d2N/dr2 has mixed terms only: the pure second derivatives along its
    edges are zero, whatever the field. In a linear tetrahedron all second derivatives are zero.
    """
    from scipy.sparse import vstack

    parts, order = [], []
    for k, block in enumerate(field.blocks):
        mine = np.nonzero(where.block == k)[0]
        if not len(mine):
            continue
        conn = block.conn[where.element[mine]]
        weights = element_weights(block.type, field.X[conn], where.r[mine], terms)
        parts.append(rows(len(mine), conn, weights, len(field.X)))
        order.append(mine)
    return _sorted(vstack(parts, format="csr"), np.concatenate(order), terms)


def _sorted(operator: Sparse, points: Ints, terms: int) -> Sparse:
    """Rows put back in the order of the points."""
    back = np.argsort(points, kind="stable")
    if (back == np.arange(len(back))).all():
        return operator
    return operator[(back[:, None] * terms + np.arange(terms)).ravel()]


def element_weights(kind: str, xe: Floats, r: Floats, terms: int = COUNT[-1]) -> Floats:
    """Weights (p, n, terms) of the nodes in the spatial derivatives at natural coordinates ``r`` (p, 3)."""
    top = COUNT.index(terms)
    out = np.zeros((len(r), xe.shape[1], terms))
    out[..., 0] = shape(kind, r, 0)
    if top == 0:
        return out
    n1 = shape(kind, r, 1)
    jac = np.einsum("pni,pnj->pij", xe, n1)
    inv = np.linalg.inv(jac)
    d1 = n1 @ inv
    out[..., 1:4] = d1
    if top == 1:
        return out
    n2 = shape(kind, r, 2)
    x2 = np.einsum("pni,pnjk->pijk", xe, n2)
    d2 = n2 - np.einsum("pni,pijk->pnjk", d1, x2)
    d2 = np.einsum("pnjk,pjK,pkL->pnKL", d2, inv, inv, optimize=True)
    out[..., 4:10] = packed(d2, 2)
    if top == 2:
        return out
    n3 = shape(kind, r, 3)
    x3 = np.einsum("pni,pnjkl->pijkl", xe, n3)
    mixed = np.einsum("pnab,pajk,pbl->pnjkl", d2, x2, jac, optimize=True)
    d3 = n3 - np.einsum("pni,pijkl->pnjkl", d1, x3)
    d3 -= mixed + mixed.swapaxes(3, 4) + mixed.transpose(0, 1, 4, 3, 2)
    d3 = np.einsum("pnjkl,pjK,pkL,plM->pnKLM", d3, inv, inv, inv, optimize=True)
    out[..., 10:20] = packed(d3, 3)
    return out
