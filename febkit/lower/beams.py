"""<BeamDomain> to solver blocks: trusses and beams."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from febkit.model import Component, Domain, InputError
from febkit.model.elements import ALIASES
from febkit.solver import physics
from febkit.solver.problem import DYNAMIC, Block, Step
from febkit.solver.solids.inert import Inert

from .context import Context

Solids = Callable[[Context, Component, str, str], Any]
#: type of <BeamDomain> -> element types it takes, and parameters of its own
KINDS = {
    "linear-truss": (("line2",), ("cross_sectional_area",)),
    "elastic-truss": (("line2",), ("cross_sectional_area", "v")),
    "linear-beam": (("line2", "line3"), ()),
}
MATERIALS = {"linear-truss": "linear truss", "linear-beam": "linear-beam"}
SECTION = ("A", "A1", "A2", "I1", "I2", "density")


def block(ctx: Context, d: Domain, material: Component, solid_of: Solids) -> Block | None:
    """The block of a domain; None where something is refused. ``solid_of`` makes the record of a solid."""
    mesh = ctx.blocks[d.block]
    element = ALIASES.get(mesh.type, mesh.type)
    kind = d.type or ("linear-truss" if element == "line2" and material.type == "linear truss" else "")
    if kind not in KINDS or ctx.model.module != "solid":
        what = f'<BeamDomain type="{kind}">' if kind else f'a beam domain of "{material.type}" without a type'
        module = "" if ctx.model.module == "solid" else f' in a model of module "{ctx.model.module}"'
        ctx.refuse(what + module, d.where)
        return None
    types, own = KINDS[kind]
    if element not in types:
        raise InputError(f'<BeamDomain type="{kind}"> takes {" and ".join(types)}, not {mesh.type}', d.where)
    wanted = MATERIALS.get(kind)
    if wanted is not None and material.type != wanted:
        what = f'<BeamDomain type="{kind}"> takes a material of type "{wanted}", not "{material.type}"'
        raise InputError(what, d.where)
    if d.spec is not None:
        ctx.check_tags(d.spec, set(own))
    refusals = len(ctx.refused)
    record, solid = _physics(ctx, d, kind, material, solid_of)
    if len(ctx.refused) > refusals:
        return None
    return Block(d.block, element, mesh.conn, mesh.ids, solid, record, rule="G2")


def _physics(ctx: Context, d: Domain, kind: str, material: Component, solid_of: Solids) -> tuple[Any, Any]:
    """The physics of a domain, and a solid that has its mass or its stress."""
    if kind == "linear-beam":
        ctx.check_tags(material, {"E", "G", *SECTION})
        numbers = {n: _number(ctx, material, n, 1.0 if n == "density" else 0.0) for n in SECTION}
        moduli = {n: ctx.value(material.child(n), 0.0) for n in ("E", "G")}
        return physics.load("beam")(**numbers, **moduli), Inert(density_=numbers["density"])
    area = _number(ctx, d.spec, "cross_sectional_area", 0.0)
    if area <= 0:
        raise InputError(f'part "{d.block}": a truss needs a positive <cross_sectional_area>', d.where)
    if kind == "elastic-truss":
        solid = solid_of(ctx, material, "solid", d.block)
        if solid is not None and any(q.history for q in solid.walk()):
            ctx.refuse(f'a truss of <material type="{material.type}">, which has a memory,', d.where)
        return physics.load("elastic truss")(area, _number(ctx, d.spec, "v", 0.5)), solid
    ctx.check_tags(material, {"E", "v", "density"})
    E, v, density = (ctx.value(material.child(n), x) for n, x in (("E", 0.0), ("v", 0.5), ("density", 1.0)))
    return physics.load("linear truss")(area, E, v), Inert(density_=density)


def check(ctx: Context, blocks: list[Block], common: Step, steps: list[Step]) -> None:
    """Refuse what FEBio has no forces for: inertia and body loads of elastic trusses, velocities in beams."""
    for b in blocks:
        name = b.physics.name
        domain = next(d for d in ctx.model.domains if d.block == b.name)
        on = [q for s in (common, *steps) for q in s.body_loads if q.blocks is None or b.name in q.blocks]
        if name == "elastic truss" and (on or any(s.analysis == DYNAMIC for s in steps)):
            what = "a body load on" if on else "a dynamic analysis of"
            ctx.refuse(f'{what} <BeamDomain type="elastic-truss">, whose mass FEBio leaves out,', domain.where)
        elif name == "beam" and any(q.moves for q in on):
            ctx.refuse(f'a body load that follows the motion, on the beams of part "{b.name}",', domain.where)


def _number(ctx: Context, spec: Component | None, tag: str, default: float) -> float:
    """A parameter of the cross-section, which does not change in time."""
    leaf = None if spec is None else spec.child(tag)
    if leaf is None:
        return default
    if leaf.lc is not None:
        ctx.refuse(f"a load curve of <{tag}>", leaf.where)
    return leaf.as_float()
