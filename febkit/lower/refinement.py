"""<MeshAdaptor>: elements that are cut, and the model made anew on the finer mesh."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from febkit.model import Component, Domain, ElementSet, InputError, Mesh, Model, NodeSet, Surface
from febkit.model.sets import node_indices
from febkit.solver.fields import Layout
from febkit.solver.problem import Block, Problem, Step
from febkit.solver.refine import Refinement, hexes, tets
from febkit.solver.refine.split import Split
from febkit.solver.ties import LinearConstraint

from . import adaptors
from .context import Context

CUTS: dict[str, tuple[str, Any]] = {  # type -> elements that it takes, how it cuts them
    "hex_refine": ("hex8", hexes.eighths), "hex_refine2d": ("hex8", hexes.quarters),
    "tet_refine": ("tet4", tets.eighths), "test_refine": ("tet4", tets.same),
}  # fmt: skip
CHOOSE = ("hex_refine", "hex_refine2d")  # those that choose elements
USUAL = {"max_iters", "max_elements", "map_data", "nnc", "nsdim", "transfer_method"}
RULE = {"tet4": "TET4G4"}  # the integration rule that FEBio gives elements it has cut
PHYSICS = ("standard", "three-field", "biphasic")
LOADS = {
    "surface_load": {"pressure", "traction", "force", "normal_traction", "fluidflux"},
    "nodal_load": {"nodal_force", "nodal_load", "nodal fluidflux"},
    "body_load": {"const", "non-const", "body force", "centrifugal"},
}
CONDITIONS = {
    "zero displacement", "prescribed displacement", "zero fluid pressure", "prescribed fluid pressure", "fix",
    "prescribe", "prescribed deformation",
}  # fmt: skip
SECTIONS = ("boundary", "loads", "contact", "constraints", "rigid", "initial", "adaptors")


def refinement(ctx: Context, c: Component) -> Refinement:
    """<mesh_adaptor type="hex_refine">, "hex_refine2d", "tet_refine", "test_refine"."""
    kind = c.type or ""
    element, cut = CUTS[kind]
    ctx.check_tags(c, USUAL | ({"max_elem_refine", "max_value", "criterion"} if kind in CHOOSE else set()))
    if c.bool("map_data"):
        ctx.refuse(f'<map_data>1</map_data> of <{c.tag} type="{kind}"> (FEBio 4.11 ends with an error there)',
                   c.need("map_data").where)  # fmt: skip
    for b in ctx.model.mesh.blocks:
        if b.type != element:
            raise InputError(f'{c.what} takes {element} elements; part "{b.name}" has {b.type}', b.where)
    rounds, limit, own = c.int("max_iters", -1), c.int("max_elements", -1), adaptors.among(ctx, c)
    if kind not in CHOOSE and rounds <= 0 and (limit <= 0 or kind == "test_refine"):
        known = "<max_iters>" if kind == "test_refine" else "<max_iters> or <max_elements>"
        raise InputError(f"{c.what} would go on for ever: give {known}", c.where)
    return Refinement(
        cut, partial(renewed, ctx), adaptors.criterion(ctx, c.need("criterion"), own) if kind in CHOOSE else None,
        c.float("max_value", 0.0), rounds, limit, c.int("max_elem_refine", 0), own, dict(ctx.model.mesh.hanging),
    )  # fmt: skip


def check(ctx: Context, blocks: list[Block], common: Step, steps: list[Step]) -> None:
    """Refuse, by name and place, what does not go over to another mesh."""
    model = ctx.model
    specs = [(s, c) for s in (model.common, *model.steps) for c in s.adaptors]
    refining = [c for _, c in specs if c.type in CUTS]
    if not refining:
        return
    with_ = f'with <mesh_adaptor type="{refining[0].type}">'
    for c in (c for _, c in specs if c is not refining[0]):
        ctx.refuse(f'<{c.tag} type="{c.type}"> {with_}', c.where)
    for m in (m for m in model.materials if m.name in ctx.rigid):
        ctx.refuse(f'a rigid body ("{m.name}") {with_}', m.where)
    for what, where in _others(model):
        ctx.refuse(f"{what} {with_}", where)
    for b in blocks:
        domain = next(d for d in model.domains if d.block == b.name)
        if b.physics.name not in PHYSICS:
            ctx.refuse(f'the {b.physics.name} elements of part "{b.name}" {with_}', domain.where)
        if b.rule and b.rule != RULE.get(b.element, "")[4:]:
            ctx.refuse(f'the rule {b.rule} of part "{b.name}" {with_}', domain.where)
    for s, spec in zip((common, *steps), (model.common, *model.steps)):
        where = spec.control.where if spec.control else None
        if s.explicit is not None:
            ctx.refuse(f'<solver type="explicit-solid"> {with_}', where)
        if s.newton.arc_length:
            ctx.refuse(f"<arc_length> {with_}", where)


def _others(model: Model) -> Iterator[tuple[str, Any]]:
    """What a model has that stays on its mesh: what it is, and where."""
    for d in model.mesh_data:
        yield f'the map "{d.name}"', d.where
    for k in (k for k in model.controllers if k.type == "PID"):
        yield f'load controller type="{k.type}"', k.where
    for c in model.discrete:
        yield f"<{c.tag}> of <Discrete>", c.where
    for s in (model.common, *model.steps):
        for c in (*s.contact, *s.constraints, *s.rigid):
            yield f'<{c.tag} type="{c.type}">', c.where
        for c in s.boundary:
            if c.type not in CONDITIONS:
                yield f'<{c.tag} type="{c.type}">', c.where
        for c in s.loads:
            if c.type not in LOADS.get(c.tag, CONDITIONS):
                yield f'<{c.tag} type="{c.type}">', c.where
    for c in _named(model):
        if c.attrs["node_set"].startswith("@part_list:"):
            yield f'node_set="{c.attrs["node_set"]}"', c.where


def hanging(mesh: Mesh, layout: Layout) -> list[LinearConstraint]:
    """Every unknown of a node that hangs is the mean of those of its corners."""
    out = []
    for node, corners in mesh.hanging.items():
        n = len(corners)
        for column in range(layout.width):
            out.append(LinearConstraint(node, column, np.array(corners), np.full(n, column), (1 / n,) * n))
    return out


def renewed(ctx: Context, split: Split) -> Problem:
    """The model's problem on the mesh that ``split`` makes of its own."""
    rule = RULE.get(split.of.element)
    domains = tuple(_by_rule(d, rule) for d in ctx.model.domains) if rule else ctx.model.domains
    return ctx.lower(replace(ctx.model, mesh=refined(ctx.model, split), domains=domains))


def _by_rule(d: Domain, rule: str) -> Domain:
    spec = d.spec or Component("SolidDomain", where=d.where)
    return replace(d, spec=replace(spec, attrs={**spec.attrs, "elem_type": rule}))


def refined(model: Model, split: Split) -> Mesh:
    """The mesh that ``split`` makes of a model's.

    Elements keep their labels by their places in a part, as in FEBio; new ones follow the largest.
    """
    mesh = model.mesh
    order = [d.block for d in model.domains if len(mesh.block(d.block).conn)]
    sizes = [len(mesh.block(name).conn) for name in order]
    of = np.repeat(np.arange(len(order)), sizes)[split.parent]
    last = max(int(b.ids.max(initial=0)) for b in mesh.blocks)
    made, parents = {}, {}
    for k, name in enumerate(order):
        b, rows = mesh.block(name), of == k
        new = np.arange(rows.sum() - len(b.ids)) + last + 1
        last += len(new)
        made[name] = replace(b, conn=split.conn[rows], ids=np.concatenate([b.ids, new]))
        parents[name] = b.ids[split.parent[rows] - sum(sizes[:k])]
    blocks = tuple(made.get(b.name, b) for b in mesh.blocks)
    sets = {**mesh.node_sets, **{n: NodeSet(n, nodes) for n, nodes in _implied(model).items()}}
    last = int(mesh.node_ids.max())
    return replace(
        mesh, X=split.means(mesh.X), blocks=blocks,
        node_ids=np.concatenate([mesh.node_ids, last + 1 + np.arange(len(split.masters))]),
        node_sets={n: replace(s, nodes=split.among(s.nodes)) for n, s in sets.items()},
        node_blocks={n: split.among(nodes) for n, nodes in mesh.node_blocks.items()},
        surfaces={n: _surface(s, split) for n, s in mesh.surfaces.items()},
        element_sets={n: _set(s, made, parents) for n, s in mesh.element_sets.items()}, hanging=split.hanging,
    )  # fmt: skip


def _named(model: Model) -> Iterator[Component]:
    """What names a node set."""
    ahead = [c for s in (model.common, *model.steps) for section in SECTIONS for c in getattr(s, section)]
    while ahead:
        c = ahead.pop(0)
        ahead.extend(c)
        if "node_set" in c.attrs:
            yield c


def _implied(model: Model) -> dict[str, np.ndarray]:
    """Node sets that conditions make of surfaces, edges and parts; from then on they are sets of these names."""
    out = {}
    for c in _named(model):
        prefix, colon, name = c.attrs["node_set"].partition(":")
        if colon and prefix.startswith("@") and name not in model.mesh.node_sets:
            out[name] = node_indices(model.mesh, c.attrs["node_set"], c.where)
    return out


def _surface(s: Surface, split: Split) -> Surface:
    facets = {kind: split.facets(kind, np.asarray(f, np.int64))[0] for kind, f in s.facets.items()}
    return replace(s, facets=facets, ids={})


def _set(s: ElementSet, made: dict[str, Any], parents: dict[str, np.ndarray]) -> ElementSet:
    """The children of a set's elements."""
    own = [made[name].ids[np.isin(of, s.elements)] for name, of in parents.items()]
    return replace(s, elements=np.concatenate([s.elements[:0], *own]))
