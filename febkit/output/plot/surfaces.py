"""Surfaces of the mesh: areas, enclosed volumes, reactions, and what the elements behind them say.

FEBio writes these for the surfaces that something acts on or that a <var surface="..."> names; here every surface has
them.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from febkit.solver import elements
from febkit.solver.elements.base import Element
from febkit.solver.fields import PRESSURE

from .base import FULL, Face, Floats, Part, kept, register
from .nodes import reactions

Facet = Callable[[Element, Floats], Floats]


def tangents(e: Element, x: Floats) -> Floats:
    """Tangents times natural lengths at the points of facets x (f, n, 3): (f, g, 2, 3)."""
    return np.einsum("gad,fai->fgdi", e.dN, x)


def areas(e: Element, x: Floats) -> Floats:
    """Normals (f, g, 3) whose lengths are the areas that the points stand for."""
    t = tangents(e, x)
    return np.cross(t[:, :, 0], t[:, :, 1]) * e.weights[:, None]


def size(e: Element, x: Floats) -> Floats:
    """Area of each facet (f,)."""
    return np.linalg.norm(areas(e, x), axis=-1).sum(axis=1)


def enclosed(e: Element, x: Floats) -> Floats:
    """x . n dA / 3 of each facet (f,)."""
    at = np.einsum("ga,fai->fgi", e.N, x)
    return (at * areas(e, x)).sum(axis=(1, 2)) / 3.0


def facets(face: Face, value: Facet, reference: bool = False) -> Floats:
    """A value of each facet (f, ...) at present positions, or at those of the reference."""
    x = face.state.X if reference else face.state.x
    parts = [value(elements.get(kind), x[c]) for kind, c in face.kinds]
    return np.concatenate(parts) if parts else np.zeros(0)


def reaction(face: Face) -> Floats:
    """Sum of the reactions of the nodes (3,)."""
    return reactions(face.view)[face.nodes].sum(axis=0)


def moment(face: Face) -> Floats:
    """Moment of the reactions about the origin (3,)."""
    return np.cross(face.state.x[face.nodes], reactions(face.view)[face.nodes]).sum(axis=0)


# ---- by the elements behind ---------------------------------------------------------------------------
def nodal(part: Part, name: str) -> Floats | None:
    """A field of the physics extrapolated to the nodes of each element (m, n, ...)."""

    def values() -> Floats | None:
        v = part.at_points(name)
        return None if v is None else np.einsum("ng,eg...->en...", part.g.element.extrapolation, v)

    return kept(part, ("nodal", name), values)


def tractions(face: Face) -> list[Floats]:
    """Traction sigma n at the points of facets, type by type (f, g, 3), by the stress of the solid elements behind.

    The stress is extrapolated to the nodes of the element; with that of node j goes the normal at point j, and the
    products are interpolated, as FEBio has it.
    """
    out = []
    for (kind, c), behind in zip(face.kinds, face.behind, strict=True):
        e = elements.get(kind)
        n = np.cross(*np.moveaxis(tangents(e, face.state.x[c]), 2, 0))
        n /= np.linalg.norm(n, axis=-1, keepdims=True)
        at = np.zeros((*c.shape, 3))
        for f, found in enumerate(behind):
            s = nodal(found[0], "stress") if found is not None and not found[0].shell else None
            if s is None or found is None:
                continue
            rows = [int(np.flatnonzero(found[0].g.conn[found[1]] == k)[0]) for k in c[f]]
            T = s[found[1], rows][:, FULL].reshape(-1, 3, 3)
            at[f] = np.einsum("nij,nj->ni", T, n[f, np.minimum(np.arange(c.shape[1]), e.npoints - 1)])
        out.append(np.einsum("ga,fai->fgi", e.N, at))
    return out


def traction(face: Face) -> Floats:
    """Its mean over each facet (f, 3)."""
    return np.concatenate([np.zeros((0, 3)), *(t.mean(axis=1) for t in tractions(face))])


def nodal_traction(face: Face) -> Floats:
    """Extrapolated to the nodes of each facet (f, n, 3)."""
    return to_nodes(face, tractions(face))


def to_nodes(face: Face, values: list[Floats]) -> Floats:
    """Values at the points of facets (f, g, ...), type by type, at the nodes of each (f, width, ...)."""
    out = []
    for (kind, _), v in zip(face.kinds, values, strict=True):
        at = np.einsum("ng,fg...->fn...", elements.get(kind).extrapolation, v)
        out.append(np.pad(at, ((0, 0), (0, face.width - at.shape[1]), *((0, 0),) * (at.ndim - 2))))
    return np.concatenate(out)


def flow(face: Face) -> Floats | None:
    """Fluid that leaves through a surface: the mean flux of the elements behind, along the present normal at the middle
    of natural coordinates, times the area of the reference, as FEBio has it (,)."""
    total, fluid = 0.0, False
    for (kind, c), behind in zip(face.kinds, face.behind, strict=True):
        e = elements.get(kind)
        t = np.einsum("ad,fai->fdi", e.gradient(np.zeros((1, 2)))[0], face.state.x[c])
        n = np.cross(t[:, 0], t[:, 1])
        n *= (size(e, face.state.X[c]) / np.linalg.norm(n, axis=1))[:, None]
        for f, found in enumerate(behind):
            w = found[0].at_points("fluid flux") if found is not None else None
            if w is not None and found is not None:
                fluid = True
                total += float(w[found[1]].mean(axis=0) @ n[f])
    return np.array(total) if fluid else None


def fluid_force(face: Face, pressure: Floats) -> Floats:
    """Integral of p n over a surface (3,), of pressures at the nodes (node,)."""
    out = np.zeros(3)
    for kind, c in face.kinds:
        e = elements.get(kind)
        out += np.einsum("fg,fgi->i", pressure[c] @ e.N.T, areas(e, face.state.x[c]))
    return out


def recovered_fluid_force(face: Face) -> Floats | None:
    """As above, the pressure at nodes being the mean of those of the elements around, of the part behind."""
    found = next((b for behind in face.behind for b in behind if b is not None), None)
    if found is None or PRESSURE.name not in found[0].g.fields:
        return None
    at, conn = found[0].at_points("fluid pressure"), found[0].g.conn
    assert at is not None
    count = np.bincount(conn.ravel(), minlength=len(face.state.X))
    total = np.bincount(conn.ravel(), np.repeat(at.mean(axis=1), conn.shape[1]), len(face.state.X))
    return fluid_force(face, total / np.maximum(count, 1))


register("facet area", lambda face: facets(face, size))
register("surface area", lambda face: facets(face, size).sum())
register("enclosed volume", lambda face: facets(face, enclosed).sum())
register("enclosed volume change", lambda face: facets(face, enclosed).sum() - facets(face, enclosed, True).sum())
register("surface reaction force", reaction)
register("surface reaction moment", moment)
register("surface traction", traction)
register("nodal surface traction", nodal_traction)
register("fluid flow rate", flow)
register("fluid force2", recovered_fluid_force)
