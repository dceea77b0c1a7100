"""Patches of elements around a point or node, and least squares on them."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations_with_replacement

import numpy as np
from numpy.typing import NDArray

from .derivatives import Sparse
from .field import Field

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

_DEPENDENT = 1e-7  # a column this much shorter after projection is taken as dependent on those before it


def terms_of_degree(degree: int) -> tuple[tuple[int, ...], ...]:
    """Multi-indices of all monomials in three variables up to a degree, in graded order."""
    return tuple(a for n in range(degree + 1) for a in combinations_with_replacement(range(3), n))


def fit(a: Floats, keep: int) -> tuple[Floats, NDArray[np.bool_]]:
    """Weights (m, n, keep) of the data in the first coefficients of least squares, and terms lost (m, k).

    ``a`` (m, n, k) has the basis at the data points (rows of zeros are padding). Columns are taken in
    order; one that depends on those before it gets the coefficient 0, so low orders win where a patch
    cannot tell terms apart. Modified Gram-Schmidt, each column projected twice.
    """
    q = a.copy()
    m, _, k = a.shape
    length = np.sqrt((a * a).sum(axis=1))  # (m, k)
    r = np.zeros((m, k, k))
    lost = np.zeros((m, k), dtype=bool)
    for j in range(k):
        v = q[:, :, j]
        for _ in range(2):
            if j:
                h = np.einsum("mnj,mn->mj", q[:, :, :j], v)
                v = v - np.einsum("mnj,mj->mn", q[:, :, :j], h)
                r[:, :j, j] += h
        norm = np.sqrt((v * v).sum(axis=1))
        gone = norm <= _DEPENDENT * length[:, j]
        lost[:, j] = gone
        r[:, j, j] = np.where(gone, 1.0, norm)
        r[gone, :j, j] = 0.0
        q[:, :, j] = np.where(gone[:, None], 0.0, v / np.where(gone, 1.0, norm)[:, None])
    inverse = np.linalg.inv(r)[:, :keep]
    return np.einsum("mij,mnj->mni", inverse, q), lost


@dataclass(frozen=True, slots=True, eq=False)
class Topology:
    """Who touches whom: ``nodes`` (element, node) incidence over all blocks, and each element's part."""

    incidence: Sparse
    corners: Sparse  # as incidence, vertices only
    part: Ints
    offset: Ints  # first row of each block

    @classmethod
    def of(cls, field: Field) -> Topology:
        """The topology of a field's mesh, made once per field."""
        if "topology" not in field.cache:
            field.cache["topology"] = cls._make(field)
        return field.cache["topology"]  # type: ignore[no-any-return]

    @classmethod
    def _make(cls, field: Field) -> Topology:
        from scipy.sparse import csr_array, vstack

        from febkit.solver import elements

        full: list[Sparse] = []
        vertex: list[Sparse] = []
        part, start = [], [0]
        for b in field.blocks:
            for out, conn in ((full, b.conn), (vertex, b.conn[:, :elements.get(b.type).corners])):
                n, k = conn.shape
                out.append(csr_array((np.ones(n * k, np.int32), conn.ravel(), np.arange(0, n * k + 1, k)),
                                     shape=(n, len(field.X))))
            part.append(b.part)
            start.append(start[-1] + len(b.conn))
        return cls(vstack(full, format="csr"), vstack(vertex, format="csr"), np.concatenate(part),
                   np.array(start[:-1]))


def only(m: Sparse, part: Ints, own: Ints) -> Sparse:
    """Keeps entries (row, element) whose element is in the row's own part."""
    row = np.repeat(np.arange(m.shape[0]), np.diff(m.indptr))
    m = m.copy()
    m.data = (part[m.indices] == own[row]).astype(np.int32)
    m.eliminate_zeros()
    return m


def padded(m: Sparse) -> Ints:
    """Column indices of each row (rows, width), padded with -1."""
    count = np.diff(m.indptr)
    out = np.full((m.shape[0], int(count.max(initial=0))), -1)
    out[np.arange(out.shape[1])[None] < count[:, None]] = m.indices
    return out


def grow(top: Topology, patch: Sparse, own: Ints | None) -> Sparse:
    """A ring more: all elements (of the row's own part, where given) that touch the patch's elements."""
    out = (patch @ top.corners) @ top.corners.T.tocsr()
    return out if own is None else only(out, top.part, own)


def replace_rows(m: Sparse, rows_: Ints, new: Sparse) -> Sparse:
    """``m`` with some rows exchanged."""
    from scipy.sparse import vstack

    pick = np.arange(m.shape[0])
    pick[rows_] = m.shape[0] + np.arange(len(rows_))
    return vstack([m, new], format="csr")[pick]
