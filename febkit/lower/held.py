"""Constraints that hold the normal displacements of a surface, the volume it encloses, or two nodes' distance."""

from __future__ import annotations

import numpy as np

from febkit.model import Component, InputError
from febkit.model.sets import surface
from febkit.solver.elements import nodal
from febkit.solver.loads.enclosed_volume import EnclosedVolume
from febkit.solver.loads.held_normals import HeldNormals
from febkit.solver.loads.node_distance import NodeDistance
from febkit.solver.problem import Step

from . import loads, rigid
from .context import Context
from .ties import AUGMENTED, augmented


def constraint(ctx: Context, out: Step, c: Component) -> None:
    """Any of these constraints."""
    {"volume": _volume, "node distance": _distance}.get(c.type or "", _normals)(ctx, out, c)


def _normals(ctx: Context, out: Step, c: Component) -> None:
    """<constraint type="fixed normal displacement">, or "symmetry plane": then of both faces of shells."""
    plane = c.type == "symmetry plane"
    ctx.check_tags(c, AUGMENTED if plane else AUGMENTED | {"shell_bottom"})
    facets = surface(ctx.model.mesh, c.attrs.get("surface", ""), c.where).facets
    conns = tuple(f for f in facets.values() if len(f))
    at = np.unique(np.concatenate([np.zeros(0, np.int64), *(f.ravel() for f in conns)]))
    at = at[~np.isin(at, rigid.carried(ctx, out))]
    back = ctx.back[at]
    nodes = back if c.bool("shell_bottom") else at
    if (nodes < 0).any():
        raise InputError(f"{c.what}: <shell_bottom>, but a facet of its surface is no shell", c.where)
    if plane:
        nodes, at = np.concatenate([at, back[back >= 0]]), np.concatenate([at, at[back >= 0]])
    out.loads.append(HeldNormals.of(conns, at, nodes, ctx.layout.displacement, **augmented(ctx, c)))


def _volume(ctx: Context, out: Step, c: Component) -> None:
    """<constraint type="volume">: what a surface encloses, by nodal integration as in FEBio."""
    ctx.check_tags(c, {"laugon", "augtol", "penalty"})
    for kind in set(surface(ctx.model.mesh, c.attrs.get("surface", ""), c.where).facets) - set(nodal.WEIGHTS):
        ctx.refuse(f'<constraint type="volume"> on {kind} facets', c.where)
        return
    on, eps = loads.facets(ctx, c, nodal.RULE), ctx.value(c.child("penalty"), 0.0)
    laugon, tolerance = c.bool("laugon"), c.float("augtol", 0.0)
    out.loads.append(EnclosedVolume(on, penalty=eps, laugon=laugon, tolerance=tolerance))


def _distance(ctx: Context, out: Step, c: Component) -> None:
    """<constraint type="node distance">."""
    ctx.check_tags(c, {"laugon", "augtol", "penalty", "node", "minaug", "maxaug", "target", "relative"})
    leaf = c.need("node")
    ids = np.array(leaf.as_floats(2))
    known = ctx.model.mesh.node_ids
    if not np.isin(ids, known).all():
        raise InputError(f"there is no node {ids[~np.isin(ids, known)][0]:g}", leaf.where)
    nodes = np.array([np.flatnonzero(known == i)[0] for i in ids])
    relative = c.bool("relative") if c.child("relative") is not None else True
    out.loads.append(NodeDistance(
        nodes, ctx.value(c.child("penalty"), 0.0), ctx.value(c.child("target"), 0.0), relative,
        c.bool("laugon"), c.float("augtol", 0.01), c.int("minaug", 0), c.int("maxaug", 10),
    ))  # fmt: skip
