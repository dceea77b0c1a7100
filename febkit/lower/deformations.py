"""Conditions that prescribe all displacements of a set: by a gradient, along normals, as a rigid motion."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from febkit.model import Component, InputError
from febkit.model.sets import node_indices, surface
from febkit.solver.problem import Fixed, Prescribed
from febkit.solver.values import Constant, Expression, Map, Scaled, Value

from .context import Context

Floats = NDArray[np.float64]
Conditions = list[Fixed | Prescribed]


def _scale(ctx: Context, c: Component, default: float) -> Callable[[float], float]:
    """The scale of a condition over time."""
    value, origin = ctx.value(c.child("scale"), default), np.zeros((1, 3))
    return lambda t: float(value(t, origin)[0])


def _prescribed(
    ctx: Context, c: Component, nodes: NDArray[np.int64], u: Floats, default: float, relative: bool = False
) -> Conditions:
    """Displacements ``u`` (node, 3) times the scale."""
    scale = _scale(ctx, c, default)
    values: list[Value] = [Scaled(Map(np.ascontiguousarray(column)), scale) for column in u.T]
    return [Prescribed(ctx.column(axis, c), nodes, v, relative) for axis, v in zip("xyz", values, strict=True)]


def _nodes(ctx: Context, c: Component) -> NDArray[np.int64]:
    return node_indices(ctx.model.mesh, c.attrs.get("node_set", ""), c.where)


def deformation(ctx: Context, c: Component) -> Conditions:
    """u = scale (F - 1) X (FEBio user manual, "prescribed deformation")."""
    ctx.check_tags(c, {"scale", "F"})
    nodes = _nodes(ctx, c)
    return _prescribed(ctx, c, nodes, ctx.model.mesh.X[nodes] @ (_gradient(c) - np.eye(3)).T, 1.0)


def second_order(ctx: Context, c: Component) -> Conditions:
    """u = scale [(F - 1) (X - X1) + 1/2 G : (X X - X1 X1)], X1 the place of the node numbered ``reference`` from 0.

    G is given by its 18 numbers G_i,xx xy xz yy yz zz (FEBioRVE, "prescribed deformation 2O").
    """
    ctx.check_tags(c, {"scale", "F", "G", "reference"})
    nodes, X = _nodes(ctx, c), ctx.model.mesh.X
    at = c.need("reference").as_int()
    if not 0 <= at < len(X):
        raise InputError(f"<reference> is the place of a node, 0 to {len(X) - 1}, not {at}", c.need("reference").where)
    G = np.array(c.need("G").as_floats(18) if c.child("G") is not None else (0.0,) * 18).reshape(3, 6)
    u = (X[nodes] - X[at]) @ (_gradient(c) - np.eye(3)).T
    u += 0.5 * (_dyads(X[nodes]) - _dyads(X[at][None])) @ G.T
    return _prescribed(ctx, c, nodes, u, 1.0)


def _gradient(c: Component) -> Floats:
    leaf = c.child("F")
    return np.eye(3) if leaf is None else np.array(leaf.as_floats(9)).reshape(3, 3)


def _dyads(X: Floats) -> Floats:
    """xx 2xy 2xz yy 2yz zz of places (n, 6)."""
    x, y, z = X.T
    return np.stack([x * x, 2 * x * y, 2 * x * z, y * y, 2 * y * z, z * z], axis=1)


def normal(ctx: Context, c: Component) -> Conditions:
    """u = scale n, n the mean normal of the facets at a node in the reference, weighed by their area.

    ``surface_hint`` 1: n points to the origin (FEBio user manual, "normal displacement").
    """
    ctx.check_tags(c, {"scale", "surface_hint", "relative"})
    X = ctx.model.mesh.X
    conns = surface(ctx.model.mesh, c.attrs.get("surface", ""), c.where).facets
    nodes = np.unique(np.concatenate([f.ravel() for f in conns.values()]))
    if c.int("surface_hint", 0):
        n = -X[nodes]
    else:
        total = np.zeros_like(X)
        for kind, f in conns.items():
            if kind not in ("tri3", "quad4", "tri6", "tri7"):
                ctx.refuse(f'<bc type="normal displacement"> on facets {kind}', c.where)
                return []
            _add_normals(X, f, total)
        n = total[nodes]
    length = np.linalg.norm(n, axis=1)
    n = n / np.where(length > 0, length, 1.0)[:, None]
    return _prescribed(ctx, c, nodes, n, 0.0, c.bool("relative"))


def _add_normals(X: Floats, facets: NDArray[np.int64], total: Floats) -> None:
    """Add the normals at the nodes of facets; those of edge nodes are means of their ends', as in FEBio."""
    corners = 4 if facets.shape[1] == 4 else 3
    at = []
    for k in range(corners):
        o = X[facets[:, k]]
        at.append(np.cross(X[facets[:, (k + 1) % corners]] - o, X[facets[:, (k - 1) % corners]] - o))
    if facets.shape[1] > corners:
        at += [0.5 * (at[k] + at[(k + 1) % 3]) for k in range(3)]
    if facets.shape[1] == 7:
        at.append((at[0] + at[1] + at[2]) / 3.0)
    for k, n in enumerate(at):
        np.add.at(total, facets[:, k], n)


def rigid(ctx: Context, c: Component) -> Conditions:
    """u = Q (X - r0) + r - X, Q the rotation of the vector ``rot``, r ``pos``, r0 ``pos`` at the start.

    FEBioMech, "rigid deformation".
    """
    ctx.check_tags(c, {"pos", "rot"})
    zero: tuple[Value, ...] = (Constant(0.0),) * 3
    pos, rot = (zero if c.child(n) is None else ctx.vector(c.need(n)) for n in ("pos", "rot"))
    nodes, origin = _nodes(ctx, c), np.zeros((1, 3))

    def at(v: tuple[Value, ...], t: float) -> Floats:
        return np.array([float(x(t, origin)[0]) for x in v])

    start = at(pos, 0.0)

    def component(axis: int) -> Value:
        def u(X: Floats, Y: Floats, Z: Floats, t: float) -> Floats:
            place = np.stack([X, Y, Z], axis=-1)
            moved = (place - start) @ _rotation(at(rot, t)).T + at(pos, t)
            return np.asarray(moved[:, axis] - place[:, axis])

        return Expression(u)

    return [Prescribed(ctx.column(axis, c), nodes, component(k)) for k, axis in enumerate("xyz")]


def _rotation(v: Floats) -> Floats:
    """Matrix of a rotation vector (Rodrigues)."""
    angle = float(np.linalg.norm(v))
    if angle == 0.0:
        return np.eye(3)
    x, y, z = v / angle
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * (K @ K))
