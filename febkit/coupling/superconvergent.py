"""Superconvergent patch recovery (Zienkiewicz & Zhu, Int J Numer Methods Eng 33 (1992) 1331).

Around each vertex a polynomial is fitted to the gradients at the superconvergent points of the elements
there; its values at the nodes, interpolated by the shape functions, are the recovered gradient. Higher
derivatives apply the same to the recovered field. At the surface the patch grows inward by a ring.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .derivatives import COUNT, TERMS, Sparse, by_element, element_weights, monomials, rows
from .field import Field
from .location import Location
from .patch import Topology, fit, grow, only, padded, terms_of_degree
from .shapes import barlow, parents, shape

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def by_patches(field: Field, where: Location, order: int, *, own_part: bool = True) -> tuple[Sparse, Ints]:
    """Rows of derivatives up to ``order``, and the number of terms lost at each point.

    The value is the element's own, less the error of interpolation. A first derivative is interpolated from
    recovered nodal gradients, a second from the recovered gradients of these, and so on; mixed ones are the
    mean over their orders. With ``own_part`` only elements of the point's part are looked at, where it has
    enough of them.
    """
    from scipy.sparse import vstack

    top = Topology.of(field)
    part = top.part[top.offset[where.block] + where.element]
    k = COUNT[order]
    pieces, who, lost = [], [], np.zeros(len(part), dtype=np.int64)
    for p in np.unique(part) if own_part else [-1]:
        mine = np.nonzero(part == p)[0] if own_part else np.arange(len(part))
        near = Location(where.block[mine], where.element[mine], where.r[mine], where.sharing[mine])
        found, gone = _in_part(field, top, near, order, int(p))
        if gone and own_part:
            found, gone = _in_part(field, top, near, order, -1)
        lost[mine] = gone
        pieces.append(found)
        who.append(mine)
    stacked = pieces[0] if len(pieces) == 1 else vstack(pieces, format="csr")
    back = np.argsort(np.concatenate(who), kind="stable")
    return stacked[(back[:, None] * k + np.arange(k)).ravel()], lost


def _in_part(field: Field, top: Topology, where: Location, order: int, part: int) -> tuple[Sparse, int]:
    """Rows for points of one part (-1: all parts are alike)."""
    from scipy.sparse import vstack

    level: dict[tuple[int, ...], Sparse] = {(): by_element(field, where, 1)}
    found = dict(level)
    lost = 0
    for _ in range(order):
        used = np.unique(np.concatenate([m.indices for m in level.values()]))
        gradient, gone = nodal_gradient(field, top, used, part)
        lost += gone
        paths: dict[tuple[int, ...], list[Sparse]] = {}
        for axes, m in level.items():
            for axis in range(3):
                paths.setdefault(tuple(sorted((*axes, axis))), []).append(m @ gradient[axis])
        level = {axes: _mean(ms) for axes, ms in paths.items()}
        found |= level
    k = COUNT[order]
    m = len(where.block)
    found[()] = _corrected(field, where, found, order)
    stacked = vstack([found[t] for t in TERMS[:k]], format="csr")
    return stacked[(np.arange(m)[:, None] + m * np.arange(k)).ravel()], lost


def _corrected(field: Field, where: Location, found: dict[tuple[int, ...], Sparse], order: int) -> Sparse:
    """The value that goes with the recovered derivatives: f = sum_a N_a (f_a - terms of order 2 and up at a).

    Interpolation alone is off by these terms, and a series of order 2 would start from a value of order 1.
    """
    value = found[()]
    if order < 2:
        return value
    terms = TERMS[COUNT[1]:COUNT[order]]
    weights = np.zeros((len(where.block), len(terms)))
    for k, b in enumerate(field.blocks):
        mine = np.nonzero(where.block == k)[0]
        if len(mine):
            xe = field.X[b.conn[where.element[mine]]]
            n = shape(b.type, where.r[mine], 0)
            d = xe - np.einsum("pn,pni->pi", n, xe)[:, None]
            weights[mine] = np.einsum("pn,pnk->pk", n, monomials(d, terms))
    for j, t in enumerate(terms):
        value = value - found[t].multiply(weights[:, j, None]).tocsr()
    return value


def _mean(paths: list[Sparse]) -> Sparse:
    out = paths[0]
    for p in paths[1:]:
        out = out + p
    return out / len(paths)


def nodal_gradient(field: Field, top: Topology, nodes: Ints, part: int = -1) -> tuple[list[Sparse], int]:
    """Recovered d/dX, d/dY, d/dZ as sparse operators (n, n) with rows at ``nodes``, and terms lost.

    A mid-side node takes the mean of the polynomials of the vertices its edge, face or element ends in.
    """
    from scipy.sparse import coo_array, csr_array

    base = _vertices(field)[nodes]  # (node, <= 8) the vertices each node is recovered from
    count = (base >= 0).sum(axis=1)
    target = np.repeat(np.arange(len(nodes)), count)
    vertex = base[base >= 0]
    weight = np.repeat(1.0 / count, count)
    unique, inverse = np.unique(vertex, return_inverse=True)
    points, sampling, offset, degree = _samples(field, top)
    offsets = field.X[nodes[target]] - field.X[unique[inverse]]
    pair_rows, lost = _fits(field, top, unique, inverse, offsets, points, offset, degree, part)
    average = csr_array((weight, np.arange(len(vertex)), np.concatenate([[0], np.cumsum(count)])),
                        shape=(len(nodes), len(vertex)))
    spread = average @ pair_rows
    out = []
    for axis in range(3):
        g = coo_array(spread @ sampling[axis])
        out.append(csr_array((g.data, (nodes[g.row], g.col)), shape=(len(field.X),) * 2))
    return out, lost


def _vertices(field: Field) -> Ints:
    """Vertices (node, <= 8) each node is recovered from: itself, or those of its edge, face or element."""
    if "vertices" not in field.cache:
        out = np.full((len(field.X), 8), -1)
        for b in field.blocks:
            table = parents(b.type)
            for j, weights in enumerate(table):
                ends = np.nonzero(weights)[0]
                out[b.conn[:, j], :len(ends)] = b.conn[:, ends]
        field.cache["vertices"] = out
    return field.cache["vertices"]  # type: ignore[no-any-return]


def _samples(field: Field, top: Topology) -> tuple[Floats, list[Sparse], Ints, int]:
    """Superconvergent points (s, 3), gradient there as sparse rows, first sample of each element, degree."""
    from scipy.sparse import vstack

    if "samples" not in field.cache:
        points, sampling, count = [], [[], [], []], []  # type: ignore[var-annotated]
        for b in field.blocks:
            r, _ = barlow(b.type)
            n, g = len(b.conn), len(r)
            xe = np.repeat(field.X[b.conn], g, axis=0)
            w = element_weights(b.type, xe, np.tile(r, (n, 1)), 4)
            points.append(np.einsum("pn,pni->pi", w[..., 0], xe))
            conn = np.repeat(b.conn, g, axis=0)
            for axis in range(3):
                sampling[axis].append(rows(n * g, conn, w[..., 1 + axis:2 + axis], len(field.X)))
            count.append(np.full(n, g))
        first = np.concatenate([[0], np.cumsum(np.concatenate(count))])
        degree = min(barlow(b.type)[1] for b in field.blocks)
        gradients = [vstack(s, format="csr") for s in sampling]
        field.cache["samples"] = (np.concatenate(points), gradients, first, degree)
    return field.cache["samples"]  # type: ignore[no-any-return]


def _fits(field: Field, top: Topology, vertices: Ints, inverse: Ints, offsets: Floats, points: Floats,
          first: Ints, degree: int, part: int) -> tuple[Sparse, int]:
    """Rows (pair, sample): the polynomial around vertex ``vertices[inverse]``, evaluated ``offsets`` away."""
    from scipy.sparse import csr_array, vstack

    terms = terms_of_degree(degree)
    patch = csr_array(top.corners.T.tocsr()[vertices])
    own = None if part < 0 else np.full(len(vertices), part)
    if own is not None:
        patch = only(patch, top.part, own)
    by_vertex = np.argsort(inverse, kind="stable")
    starts = np.concatenate([[0], np.cumsum(np.bincount(inverse, minlength=len(vertices)))])
    todo, pieces, order, lost = np.arange(len(vertices)), [], [], 0
    for ring in range(4):
        columns = _sample_columns(padded(patch), first)
        enough = np.zeros(len(todo), dtype=bool)
        for s in _chunks(len(todo), columns.shape[1] * len(terms)):
            weights, gone, size = _vertex_weights(field.X[vertices[todo[s]]], columns[s], points, terms)
            good = ~gone.any(axis=1) & ((columns[s] >= 0).sum(axis=1) >= 1.6 * len(terms)) | (ring == 3)
            enough[s] = good
            lost += int(gone[good].sum())
            local = np.nonzero(good)[0]
            pair, owner = _pairs(by_vertex, starts, todo[s][local])
            basis = monomials(offsets[pair] / size[local][owner][:, None], terms)
            w = np.einsum("pk,pnk->pn", basis, weights[local][owner])
            pieces.append(rows(len(pair), columns[s][local][owner], w[..., None], len(points)))
            order.append(pair)
        if enough.all():
            break
        todo = todo[~enough]
        patch = grow(top, patch[~enough], None if own is None else own[:len(todo)])
    stacked = vstack(pieces, format="csr")
    return stacked[np.argsort(np.concatenate(order), kind="stable")], lost


def _pairs(by_vertex: Ints, starts: Ints, vertices: Ints) -> tuple[Ints, Ints]:
    """Pairs that belong to vertices, and for each the position of its vertex in the list."""
    count = starts[vertices + 1] - starts[vertices]
    owner = np.repeat(np.arange(len(vertices)), count)
    step = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    return by_vertex[starts[vertices][owner] + step], owner


def _chunks(n: int, width: int) -> list[slice]:
    step = max(1, 6_000_000 // max(width, 1))
    return [slice(i, min(i + step, n)) for i in range(0, n, step)]


def _sample_columns(elements: Ints, first: Ints) -> Ints:
    """Samples (vertex, k) of the elements in patches (vertex, e), padded with -1."""
    each = int(np.diff(first).max())
    start = np.where(elements >= 0, first[elements], -1)
    stop = np.where(elements >= 0, first[elements + 1], -1)
    columns = start[..., None] + np.arange(each)
    live = (columns < stop[..., None]) & (start[..., None] >= 0)
    return np.where(live, columns, -1).reshape(len(elements), -1)


def _vertex_weights(x: Floats, columns: Ints, points: Floats,
                    terms: tuple[tuple[int, ...], ...]) -> tuple[Floats, NDArray[np.bool_], Floats]:
    """Weights (v, sample, term) of samples in the coefficients, terms lost (v, term), patch sizes (v,)."""
    live = columns >= 0
    d = np.where(live[..., None], points[columns] - x[:, None], 0.0)
    size = np.maximum(np.sqrt((d * d).sum(axis=2).max(axis=1)), 1e-300)
    a = monomials(d / size[:, None, None], terms) * live[..., None]
    weights, lost = fit(a, len(terms))
    return weights, lost, size
