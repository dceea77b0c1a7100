"""Constraints of single nodes: to another node, to the element they lie in, to their angle about the z axis."""

from __future__ import annotations

import numpy as np

from febkit.model import Component, InputError
from febkit.model.sets import node_indices
from febkit.solver.loads.azimuth import Azimuth
from febkit.solver.loads.springs import ConstraintSet
from febkit.solver.problem import Step
from febkit.solver.ties import LinearConstraint

from .context import METHODS, Context

HEX = np.array([(r, s, t) for t in (-1, 1) for r, s in ((-1, -1), (1, -1), (1, 1), (-1, 1))], float)
INSIDE, MOST = 1.0001, 50  # of natural coordinates, as FEBio; steps that look for them


def constraint(ctx: Context, out: Step, c: Component) -> None:
    """Any of these constraints."""
    {"node-on-node": _on_node, "point": _in_element}.get(c.type or "", _azimuth)(ctx, out, c)


def _azimuth(ctx: Context, out: Step, c: Component) -> None:
    ctx.check_tags(c, {"laugon", "augtol", "penalty", "minaug", "maxaug"})
    nodes = node_indices(ctx.model.mesh, c.attrs.get("node_set", ""), c.where)
    on = np.flatnonzero(~ctx.X[nodes, :2].any(axis=1))
    if len(on):
        raise InputError(f"{c.what}: node {ctx.model.mesh.node_ids[nodes[on[0]]]} is on the z axis", c.where)
    method = c.choice("laugon", METHODS, 0)
    if method == 2:
        ctx.refuse(f"<laugon>LAGMULT</laugon> of {c.what}", c.need("laugon").where)
    out.loads.append(Azimuth(
        nodes, c.float("penalty", 0.0), method == 1, c.float("augtol", 0.1), c.int("minaug", 0), c.int("maxaug", 0),
    ))  # fmt: skip


def _place(ctx: Context, c: Component, tag: str) -> int:
    """The node of a place among the nodes, from 1, which is what FEBio takes the number for."""
    leaf = c.need(tag)
    k = leaf.as_int()
    if not 0 < k <= len(ctx.model.mesh.X):
        raise InputError(f"<{tag}>: there are {len(ctx.model.mesh.X)} nodes, numbered from 1", leaf.where)
    return k - 1


def _on_node(ctx: Context, out: Step, c: Component) -> None:
    """<constraint type="node-on-node">: node a is where node b is."""
    ctx.check_tags(c, {"a", "b"})
    a, b = _place(ctx, c, "a"), _place(ctx, c, "b")
    apart = ctx.X[b] - ctx.X[a]
    for k, column in enumerate(ctx.layout.displacement.tolist()):
        one = np.array([b]), np.array([column])
        out.constraints.append(LinearConstraint(a, column, *one, (1.0,), float(apart[k])))


def _in_element(ctx: Context, out: Step, c: Component) -> None:
    """<constraint type="point">: a node stays at its place within the first hexahedron that it lies in."""
    ctx.check_tags(c, {"penalty", "node"})
    node, penalty = _place(ctx, c, "node"), c.float("penalty", 0.0)
    found = _hexahedron(ctx, node)
    if found is None:
        raise InputError(f"{c.what}: node {ctx.model.mesh.node_ids[node]} lies in no hexahedron (hex8)", c.where)
    conn, weights = found
    nodes = np.tile(np.append(node, conn), (3, 1))
    columns = np.broadcast_to(ctx.layout.displacement[:, None], nodes.shape)
    coefficients = np.tile(np.append(1.0, -weights), (3, 1))
    out.loads.append(ConstraintSet(nodes, columns, coefficients, penalty=penalty, laugon=0))


def _hexahedron(ctx: Context, node: int) -> tuple[np.ndarray, np.ndarray] | None:
    """Nodes of the first hexahedron around a node, and their shape functions there."""
    for d in ctx.model.domains:
        mesh = ctx.blocks.get(d.block)
        if mesh is None or d.kind != "solid" or mesh.type != "hex8":
            continue
        for conn in mesh.conn:
            X, x = ctx.X[conn], ctx.X[node]
            if ((x < X.min(axis=0) - 1e-6 * np.ptp(X)) | (x > X.max(axis=0) + 1e-6 * np.ptp(X))).any():
                continue
            q = np.zeros(3)
            for _ in range(MOST):
                one = 1.0 + HEX * q
                H = 0.125 * one.prod(axis=1)
                dH = 0.125 * HEX * one[:, [1, 2, 0]] * one[:, [2, 0, 1]]
                step = np.linalg.solve(X.T @ dH, x - H @ X)
                q = q + step
                if np.abs(step).max() < 1e-12:
                    break
            if np.abs(q).max() <= INSIDE:
                return np.asarray(conn), 0.125 * (1.0 + HEX * q).prod(axis=1)
    return None
