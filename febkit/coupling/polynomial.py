"""Recovery by one polynomial: least squares through the nodal values of the patch around a point.

The derivatives of the polynomial at the point are the answer. On nodal values this is polynomial preserving
recovery (Zhang & Naga, SIAM J Sci Comput 26 (2005) 1192), centred at the point and not at the nodes.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from febkit.model import InputError

from .derivatives import COUNT, Sparse, monomials, rows
from .field import Field
from .location import Location
from .patch import Topology, fit, grow, padded, replace_rows, terms_of_degree

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def by_polynomial(field: Field, where: Location, points: Floats, order: int, *, degree: int | None = None,
                  rings: int = 1, own_part: bool = True) -> tuple[Sparse, Ints]:
    """Rows of derivatives up to ``order`` from a least-squares polynomial, and terms lost per point.

    The patch is the point's element and ``rings`` rings of elements around it, of the same part where
    ``own_part``; it grows where it cannot resolve the polynomial (near the surface, in coarse parts).
    ``degree`` is that of the polynomial, by default ``order``, at least 2: higher ones pass the tissue's
    node-to-node errors on (measured, see docs/handoff.md).
    Raises InputError where the mesh is too small for even the first derivatives.
    """
    degree = max(order, 2) if degree is None else degree
    if degree < order:
        raise InputError(f"a polynomial of degree {degree} has no derivatives of order {order}")
    top = Topology.of(field)
    cell = top.offset[where.block] + where.element
    first, inverse = np.unique(cell, return_inverse=True)
    patches = _node_patches(field, top, first, degree, rings, own_part)
    columns = patches[inverse]
    keep = COUNT[order]
    weights = np.zeros((len(points), columns.shape[1], keep))
    lost = np.zeros(len(points), dtype=np.int64)
    chunk = max(1, 4_000_000 // (columns.shape[1] * len(terms_of_degree(degree))))
    for i in range(0, len(points), chunk):
        s = slice(i, i + chunk)
        weights[s], lost[s] = _polynomial_weights(field.X, columns[s], points[s], degree, keep)
    return rows(len(points), columns, weights, len(field.X)), lost


def _polynomial_weights(X: Floats, columns: Ints, points: Floats, degree: int,
                        keep: int) -> tuple[Floats, Ints]:
    """Weights (m, n, keep) of the patch's nodes in the derivatives at the points, and terms lost (m,)."""
    live = columns >= 0
    d = np.where(live[..., None], X[columns] - points[:, None], 0.0)
    size = np.sqrt((d * d).sum(axis=2).max(axis=1))
    d /= size[:, None, None]
    # nearer nodes weigh more; the weight stays well above 0 so that no node of the patch is lost
    w = np.where(live, np.exp(-2.0 * (d * d).sum(axis=2)), 0.0)
    terms = terms_of_degree(degree)
    a = monomials(d, terms) * np.sqrt(w)[..., None]
    found, lost = fit(a, keep)
    found *= np.sqrt(w)[..., None]
    found *= (size[:, None] ** -np.array([len(t) for t in terms[:keep]], dtype=float))[:, None]
    return found, lost[:, :keep].sum(axis=1)


def _node_patches(field: Field, top: Topology, cells: Ints, degree: int, rings: int, own_part: bool) -> Ints:
    """Nodes (element, k) of the patches around elements, padded with -1, each rich enough for the degree."""
    from scipy.sparse import csr_array

    n = len(cells)
    patch = csr_array((np.ones(n, np.int32), cells, np.arange(n + 1)), shape=(n, len(top.part)))
    own = top.part[cells] if own_part else None
    for _ in range(rings):
        patch = grow(top, patch, own)
    need = 1.2 * len(terms_of_degree(degree))
    for _ in range(3):
        short = np.nonzero(_poor(field, top, patch, degree, need))[0]
        if not len(short):
            break
        wider = grow(top, patch[short], None if own is None else own[short])
        same = np.diff(wider.indptr) == np.diff(patch[short].indptr)
        if own is not None and same.any():  # a part too small for a fit of its own: look beyond it
            wider = replace_rows(wider, np.nonzero(same)[0], grow(top, patch[short][same], None))
        patch = replace_rows(patch, short, wider)
    nodes = patch @ top.incidence
    return padded(nodes)


def _poor(field: Field, top: Topology, patch: Sparse, degree: int, need: float) -> NDArray[np.bool_]:
    """Patches with too few nodes for the polynomial, or with nodes in too few planes."""
    columns = padded(patch @ top.incidence)
    few = np.asarray((columns >= 0).sum(axis=1) < need)
    todo = np.nonzero(~few)[0]
    if len(todo):
        live = columns[todo] >= 0
        X = field.X[columns[todo]]
        mean = (X * live[..., None]).sum(axis=1) / live.sum(axis=1)[:, None]
        d = np.where(live[..., None], X - mean[:, None], 0.0)
        d /= np.abs(d).max(axis=(1, 2))[:, None, None]
        terms = terms_of_degree(degree)
        _, lost = fit(monomials(d, terms) * live[..., None], 1)
        few[todo] = lost.any(axis=1)
    return few
