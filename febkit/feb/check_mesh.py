"""Elements turned inside out or doubled, nodes that nothing uses."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from febkit.model import ElementBlock, Model, Where
from febkit.model.elements import ELEMENTS
from febkit.model.mesh import Floats, Ints

from .document import Document, Tag
from .findings import Finding

_G = 1.0 / np.sqrt(3.0)
_HEX = np.array([[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1],
                 [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]], dtype=float)
# corner nodes of the shapes whose volume is looked at, and whether the shape is its corners alone
CORNERS = {
    n: (e.shape, e.corners, e.nodes <= e.corners + 1) for n, e in ELEMENTS.items() if e.dim == 3 and e.shape != "pyra"
}


def _hex_gradients() -> Floats:
    """dN/dr (point, node, 3) at the 2x2x2 Gauss points."""
    r = _HEX * _G
    out = np.empty((8, 8, 3))
    for a in range(3):
        b, c = (a + 1) % 3, (a + 2) % 3
        other = (1 + r[:, b, None] * _HEX[:, b]) * (1 + r[:, c, None] * _HEX[:, c])
        out[:, :, a] = 0.125 * _HEX[:, a] * other
    return out


def _penta_gradients() -> Floats:
    """dN/dr (point, node, 3) at three points of the triangle times two of the axis."""
    out = []
    for t in (-_G, _G):
        for r, s in ((1 / 6, 1 / 6), (2 / 3, 1 / 6), (1 / 6, 2 / 3)):
            low, high, third = (1 - t) / 2, (1 + t) / 2, 1 - r - s
            out.append([[-low, -low, -third / 2], [low, 0, -r / 2], [0, low, -s / 2],
                        [-high, -high, third / 2], [high, 0, r / 2], [0, high, s / 2]])
    return np.array(out)


_TET = np.array([[[-1, -1, -1], [1, 0, 0], [0, 1, 0], [0, 0, 1]]], dtype=float)
GRADIENTS = {"hex": _hex_gradients(), "penta": _penta_gradients(), "tet": _TET}


def jacobians(block: ElementBlock, X: Floats) -> Floats | None:
    """Least det(dX/dr) of each element over its Gauss points; None for shapes not looked at."""
    found = CORNERS.get(block.type)
    if found is None:
        return None
    shape, n, _ = found
    if not len(block.conn):
        return np.zeros(0)
    out = np.full(len(block.conn), np.inf)
    corners = np.ascontiguousarray(X[block.conn[:, :n]].transpose(0, 2, 1))  # (element, 3, node)
    for g in GRADIENTS[shape]:
        (a, b, c), (d, e, f), (p, q, r) = (corners @ g).transpose(1, 2, 0)
        with np.errstate(over="ignore", invalid="ignore"):  # of coordinates near 1e308
            np.minimum(out, a * (e * r - f * q) - b * (d * r - f * p) + c * (d * q - e * p), out=out)
    return out


def indices(model: Model) -> Iterator[Finding]:
    """Nodes that there are not, and positions that are no numbers: of a model made in memory; reading refuses them."""
    mesh, n = model.mesh, len(model.mesh.X)
    if len(mesh.node_ids) != n or not np.isfinite(mesh.X).all():
        yield Finding("error", "nodes must have an id and a finite position each", Where(model.file))
    named: list[tuple[str, Ints, Where]] = [(f'part "{b.name}"', b.conn, b.where) for b in mesh.blocks]
    named += [(f'node set "{s.name}"', s.nodes, s.where) for s in mesh.node_sets.values()]
    named += [(f'surface "{s.name}"', c, s.where) for s in mesh.surfaces.values() for c in s.facets.values()]
    named += [(f'edge "{e.name}"', e.lines, e.where) for e in mesh.edges.values()]
    named += [(f'discrete set "{d.name}"', d.pairs, d.where) for d in mesh.discrete_sets.values()]
    for name, nodes, where in named:
        if np.size(nodes) and (np.min(nodes) < 0 or np.max(nodes) >= n):
            bad = int(np.min(nodes)) if np.min(nodes) < 0 else int(np.max(nodes))
            yield Finding("error", f"{name} refers to node index {bad}; the mesh has {n} nodes, from 0", where)
    for b in mesh.blocks:
        if len(b.ids) != len(b.conn) or b.conn.ndim != 2:
            yield Finding("error", f'part "{b.name}" has {len(b.ids)} ids for {len(b.conn)} elements', b.where)


def check(model: Model) -> Iterator[Finding]:
    mesh = model.mesh
    for b in mesh.blocks:
        if not len(b.conn):
            yield Finding("warning", f'part "{b.name}" has no elements', b.where)
    for b in mesh.blocks:
        det = jacobians(b, mesh.X)
        if det is None:
            continue
        bad = np.flatnonzero(~((det > 0) & (det < np.inf)))
        if len(bad):
            severity = "error" if CORNERS[b.type][2] else "warning"
            message = (f'part "{b.name}": {len(bad)} of {len(det)} elements are turned inside out or flat, '
                       f"first element {b.ids[bad[0]]}")
            yield Finding(severity, message, row_place(model, b, int(bad[0])))
    yield from duplicates(model)
    yield from unused(model)


def row_place(model: Model, block: ElementBlock, row: int) -> Where:
    """File and line of one element of a block."""
    doc = model.document
    if not isinstance(doc, Document) or block.where.line == 0 or doc.file != block.where.file:
        return block.where
    for tag in _elements(doc.root):
        if tag.line == block.where.line and tag.table is not None and row < len(tag.table.labels):
            t = tag.table
            at = t.start
            for _ in range(row + 1):
                at = doc.data.find(b"</", at) + 2
            return Where(block.where.file, tag.line + doc.data.count(b"\n", t.start, at))
    return block.where


def _elements(root: Tag) -> list[Tag]:
    return [e for s in root for e in s if s.name in ("Mesh", "Geometry") and e.name == "Elements"]


def _odd(k: int) -> int:
    """The k-th odd number of 63 bits of a fixed random sequence (splitmix64); numpy.random takes 8 ms to import."""
    z = (k + 1) * 0x9E3779B97F4A7C15 % 2**64
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9 % 2**64
    z = (z ^ z >> 27) * 0x94D049BB133111EB % 2**64
    return (z ^ z >> 31) >> 1 | 1


def _mixed(rows: Ints) -> Ints:
    """One number for each row, alike for equal rows and unlike (but for one chance in 2^40) for others."""
    odd = np.array([_odd(k) for k in range(rows.shape[1])], np.int64)
    with np.errstate(over="ignore"):
        mixed: Ints = (rows + 1) @ odd
    return mixed


def duplicates(model: Model) -> Iterator[Finding]:
    """Ids of elements that are used twice: FEBio goes on, and takes the last where a set names one."""
    blocks = model.mesh.blocks
    ids = np.concatenate([b.ids for b in blocks]) if blocks else np.zeros(0, np.int64)
    values, counts = np.unique(ids, return_counts=True)
    if (counts > 1).any():
        twice = values[counts > 1]
        later = next(b for b in reversed(blocks) if twice[0] in b.ids)
        said = f"element id {twice[0]} is used {int(counts.max())} times"
        named = [s for s in model.mesh.element_sets.values() if np.isin(s.elements, twice).any()]
        if named:
            yield Finding("error", f'{said}: element set "{named[0].name}" does not say which it means', later.where)
        else:
            yield Finding("warning", f"{said}: what names it by its id means the last, as in FEBio", later.where)
    for b in blocks:
        rows = np.sort(b.conn, axis=1)
        _, index, count = np.unique(_mixed(rows), return_index=True, return_counts=True)
        if (count > 1).any():
            first = int(index[count > 1][0])
            yield Finding("warning", f'part "{b.name}": {int((count - 1).sum())} elements have the nodes of '
                          f"another one, first element {b.ids[first]}", row_place(model, b, first))
        repeated = (np.diff(rows, axis=1) == 0).any(axis=1)
        if repeated.any() and b.type in ("tet4", "tri3", "line2"):
            first = int(np.argmax(repeated))
            yield Finding("error", f'part "{b.name}": element {b.ids[first]} names a node twice',
                          row_place(model, b, first))


def unused(model: Model) -> Iterator[Finding]:
    mesh = model.mesh
    used = np.zeros(len(mesh.node_ids), bool)
    for b in mesh.blocks:
        used[b.conn] = True
    for d in mesh.discrete_sets.values():
        used[d.pairs] = True
    if not used.all():
        first = mesh.node_ids[np.argmin(used)]
        yield Finding("warning", f"{int((~used).sum())} nodes belong to no element, first node {first}",
                      Where(model.file))
