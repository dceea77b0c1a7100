"""Data that the file has made rather than given: by a formula at nodes, vectors of elements between surfaces."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from febkit.model import ElementBlock, InputError, MeshData
from febkit.model.mesh import Mesh
from febkit.model.sets import element_ids, node_indices, surface
from febkit.solver import elements
from febkit.solver.values import Within

if TYPE_CHECKING:
    from .context import Context

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def formula(ctx: Context, d: MeshData) -> Floats:
    """What <math> of X, Y and Z gives at the nodes of a set (node,); the first part of a list, as in FEBio."""
    from febkit.model.math import compile as compiled

    ctx.check_tags(d.spec, {"math"})
    leaf = d.spec.need("math")
    f = compiled(leaf.text.partition(",")[0], ("X", "Y", "Z"), dict(ctx.model.variables), leaf.where)
    X = ctx.X[node_indices(ctx.model.mesh, d.set, d.where)]
    return np.array(np.broadcast_to(f.at(dict(zip("XYZ", X.T, strict=True))), len(X)), float)


def surface_to_surface(mesh: Mesh, d: MeshData) -> Floats:
    """Unit vectors (element, 3) along the gradient of the harmonic field that is 0 on ``surface1``, 1 on ``surface2``.

    ``cross``: its cross product with ``normal`` instead; then turned by ``out_angle`` about the cross product with the
    normal, and by ``in_angle`` about the normal (degrees). FEBio user manual, "Surface-to-surface vector".
    """
    spec, ids = d.spec, element_ids(mesh, d.set, d.where)
    blocks = [b for b in mesh.blocks if np.isin(b.ids, ids).any()]
    shapes = [_gradients(mesh, b, d) for b in blocks]
    field = _harmonic(mesh, d, [b.conn for b in blocks], shapes)
    mean: dict[int, Floats] = {}
    for b, (grad, _) in zip(blocks, shapes, strict=True):
        mean.update(zip(b.ids.tolist(), np.einsum("egai,ea->ei", grad, field[b.conn]), strict=True))
    v = _unit(np.array([mean[int(i)] for i in ids]))
    normal = spec.child("normal")
    n = _unit(np.array([(0.0, 0.0, 1.0) if normal is None else normal.as_floats(3)]))
    if spec.bool("cross"):
        v = _unit(np.cross(v, n))
    v = _turned(v, _unit(np.cross(v, n)), np.radians(spec.float("out_angle", 0.0)))
    return _turned(v, n, np.radians(spec.float("in_angle", 0.0)))


def between(ctx: Context, d: MeshData, block: ElementBlock) -> Within:
    """A function of where a node lies between two surfaces, 0 on the first and 1 on the second, within the elements.

    w = L1 / (L1 + L2), L the distances from <bottom_surface> and <top_surface>. FEBio user manual,
    "surface-to-surface map".
    """
    from .curves import curve
    from .nearest import distances

    mesh, nodes = ctx.model.mesh, np.unique(block.conn)
    _covers(mesh, d, block)
    ctx.check_tags(d.spec, {"function", "bottom_surface", "top_surface"})
    sides = [d.spec.need(tag) for tag in ("bottom_surface", "top_surface")]
    low, high = (distances(mesh.X, surface(mesh, s.text.strip(), s.where), mesh.X[nodes]) for s in sides)
    apart = low + high
    f = curve(ctx, d.spec.need("function"))
    value = np.zeros(len(mesh.X))
    value[nodes] = 0.0 if f is None else f(low / np.where(apart > 0.0, apart, 1.0))
    return Within(elements.get(block.type), mesh.X[block.conn], value[block.conn])


def _covers(mesh: Mesh, d: MeshData, block: ElementBlock) -> None:
    """Raise InputError where a map does not hold all elements of a part, or these are no solids."""
    bare = ~np.isin(block.ids, element_ids(mesh, d.set, d.where))
    if bare.any():
        e = block.ids[int(np.argmax(bare))]
        raise InputError(f'the map "{d.name}" says nothing of element {e} of "{block.name}"', d.where)
    if block.type not in elements.VOLUMES:
        raise InputError(f'element data "{d.name}" needs solid elements; "{block.name}" has {block.type}', d.where)


def _gradients(mesh: Mesh, b: ElementBlock, d: MeshData) -> tuple[Floats, Floats]:
    """Gradients (m, g, n, 3) of the shape functions of a part's elements, and weights (m, g) of its points."""
    if b.type not in elements.VOLUMES:
        raise InputError(f'element data "{d.name}" needs solid elements; part "{b.name}" has {b.type}', d.where)
    e = elements.get(b.type)
    jacobian = np.einsum("gar,eai->egir", e.dN, mesh.X[b.conn])
    return np.einsum("gar,egri->egai", e.dN, np.linalg.inv(jacobian)), np.linalg.det(jacobian) * e.weights


def _harmonic(mesh: Mesh, d: MeshData, conns: list[Ints], shapes: list[tuple[Floats, Floats]]) -> Floats:
    """The field (node,) over the parts, which conduct equally."""
    from scipy.sparse import coo_array
    from scipy.sparse.linalg import spsolve

    n, rows, columns, entries = len(mesh.X), [], [], []
    for conn, (grad, weights) in zip(conns, shapes, strict=True):
        k = np.einsum("egai,egbi,eg->eab", grad, grad, weights)
        rows.append(np.repeat(conn, conn.shape[1], axis=1).ravel())
        columns.append(np.tile(conn, (1, conn.shape[1])).ravel())
        entries.append(k.ravel())
    K = coo_array((np.concatenate(entries), (np.concatenate(rows), np.concatenate(columns))), shape=(n, n)).tocsr()
    field, given = np.zeros(n), np.zeros(n, bool)
    for tag, value in (("surface1", 0.0), ("surface2", 1.0)):
        leaf = d.spec.need(tag)
        for facets in surface(mesh, leaf.text.strip(), leaf.where).facets.values():
            field[facets], given[facets] = value, True
    free = np.zeros(n, bool)
    free[np.concatenate(rows)] = True
    free &= ~given
    if free.any():
        field[free] = spsolve(K[free][:, free].tocsc(), -(K[free] @ field))
    return field


def _unit(v: Floats) -> Floats:
    """Vectors (n, 3) by their lengths; zero where they are."""
    length = np.linalg.norm(v, axis=1, keepdims=True)
    return np.asarray(v / np.where(length > 0.0, length, 1.0))


def _turned(v: Floats, axis: Floats, angle: float) -> Floats:
    """Vectors (n, 3) turned about unit axes (1|n, 3) (Rodrigues)."""
    along = (v * axis).sum(axis=1, keepdims=True) * axis
    return np.asarray(np.cos(angle) * v + np.sin(angle) * np.cross(axis, v) + (1.0 - np.cos(angle)) * along)


#: what makes element data of a type, and the tags that it reads
GENERATORS = {
    "surface-to-surface vector": (
        surface_to_surface, {"surface1", "surface2", "normal", "cross", "in_angle", "out_angle", "smooth_iters"},
    ),
}  # fmt: skip
