"""Material trees to solver records."""

from __future__ import annotations

from typing import Any

import numpy as np

from febkit.model import Component, Domain, InputError
from febkit.solver import permeabilities, supplies
from febkit.solver.problem import Augment, Block, Mixture
from febkit.solver.solids import registry
from febkit.solver.solids.base import Property, Solid
from febkit.solver.values import Constant

from .axes import direction, element_axes, mat_axis
from .context import Context

# elements FEBio gives the three-field formulation where the material is uncoupled
THREE_FIELD = {"hex8", "penta6", "pyra5", "tet10", "tet15"}
OPTIONS = frozenset({"laugon", "atol", "minaug", "maxaug", "elem_type", "three_field", "but4", "secant_stress", "secant_tangent"})
# written by FEBio Studio, of no meaning to a solver
IGNORED = frozenset({"name", "mat_axis"})


def blocks(ctx: Context) -> list[Block]:
    """One solver block per solid domain."""
    out = []
    named = {m.name: m for m in ctx.model.materials}
    if not ctx.model.domains:
        raise InputError("the model has no <MeshDomains>: no element has a material", None)
    for d in ctx.model.domains:
        if d.kind != "solid":
            ctx.refuse(f"a {d.kind} domain (part \"{d.block}\")", d.where)
            continue
        if d.block not in ctx.blocks:
            raise InputError(f'there is no element block "{d.block}"', d.where)
        if d.material not in named:
            raise InputError(f'there is no material "{d.material}"', d.where)
        b = _block(ctx, d, named[d.material])
        if b is not None:
            out.append(b)
    return out


def _block(ctx: Context, d: Domain, spec: Component) -> Block | None:
    from febkit.solver import elements

    mesh = ctx.blocks[d.block]
    if mesh.type not in elements.VOLUMES:
        ctx.refuse(f"element type {mesh.type}", mesh.where)
        return None
    mixture = None
    top = spec
    if spec.type == "biphasic":
        mixture = _mixture(ctx, spec, d.block)
        spec = spec.need("solid")
    elif ctx.model.module not in ("solid", "biphasic"):
        return None
    solid = solid_record(ctx, spec, "solid", d.block)
    if solid is None:
        return None
    block = Block(d.block, mesh.type, mesh.conn, mesh.ids, solid, mixture)
    block.axes = element_axes(ctx, d.block)
    own = top.child("mat_axis")
    if mixture is not None and own is not None:
        solid.mat_axis = mat_axis(ctx, own, d.block)
    _formulation(ctx, d, block)
    return block


def _formulation(ctx: Context, d: Domain, block: Block) -> None:
    """FEBio's rule for which formulation an element gets, and the options of <SolidDomain>."""
    options = d.spec
    if d.type in ("ut4-solid", "remodeling-solid", "udg-hex", "sri-solid", "rigid-solid"):
        ctx.refuse(f'<SolidDomain type="{d.type}">', d.where)
    if options is not None:
        ctx.check_tags(options, OPTIONS)
        if options.child("elem_type") is not None and options.str("elem_type"):
            from febkit.solver import elements

            name, rule, _ = elements.from_spec(options.str("elem_type"))
            block.rule = rule
    can = block.element in THREE_FIELD and block.solid.uncoupled and block.mixture is None
    three = d.type == "three-field-solid" or (can and d.type in (None, ""))
    if three and block.solid.uncoupled and block.mixture is None:
        block.formulation = "three-field"
        if options is not None and options.bool("laugon"):
            block.augment = Augment(options.float("atol", 0.01), options.int("minaug", 0), options.int("maxaug", 0))


def _mixture(ctx: Context, spec: Component, part: str) -> Mixture:
    ctx.check_tags(spec, {"phi0", "fluid_density", "tau", "solid", "permeability", "solvent_supply", "density", "mat_axis"})
    if spec.float("tau", 0.0):
        ctx.refuse("<tau> (flux relaxation) of a biphasic material", spec.need("tau").where)
    perm = _law(ctx, spec.need("permeability"), permeabilities, part)
    supply = spec.child("solvent_supply")
    return Mixture(
        perm,
        ctx.value(spec.child("phi0"), 0.0, part),
        ctx.value(spec.child("fluid_density"), 0.0, part),
        None if supply is None else _law(ctx, supply, supplies, part),
    )


def _law(ctx: Context, spec: Component, registry_: Any, part: str) -> Any:
    """A permeability or solvent supply."""
    if spec.type is None or not registry_.known(spec.type):
        ctx.refuse(f'<{spec.tag} type="{spec.type}">', spec.where)
        return None
    cls = registry_.load(spec.type)
    defaults = cls.defaults()
    fields: dict[str, Any] = {}
    for c in spec:
        if c.tag == "mat_axis":
            fields["mat_axis"] = mat_axis(ctx, c, part)
        elif c.tag not in cls.parameters:
            ctx.refuse(f'<{c.tag}> of <{spec.tag} type="{spec.type}">', c.where)
        elif c.tag in cls.vectors:
            fields[c.tag] = _numbers(ctx, c, cls.vectors[c.tag])
        else:
            fields[c.tag] = ctx.value(c, maps=part)
    for name in cls.parameters:
        if name not in fields and name not in defaults:
            raise InputError(f'<{spec.tag} type="{spec.type}"> lacks <{name}>', spec.where)
    return cls(**fields)


def _numbers(ctx: Context, leaf: Component, n: int) -> tuple[Any, ...]:
    from febkit.solver.values import Scaled

    numbers = leaf.as_floats(n)
    if leaf.lc is None:
        return tuple(Constant(x) for x in numbers)
    return tuple(Scaled(Constant(x), ctx.controller(leaf.lc, leaf.where)) for x in numbers)


def solid_record(ctx: Context, spec: Component, table: str, part: str) -> Solid | Any:
    """The record of a material or of a property of one; None where it is refused."""
    if spec.type is None or not registry.known(table, spec.type):
        ctx.refuse(f'<{spec.tag} type="{spec.type}">', spec.where)
        return None
    cls = registry.load(table, spec.type)
    fields: dict[str, Any] = {}
    defaults = cls.defaults()
    for c in spec:
        _field(ctx, cls, c, part, fields, spec)
    for name in cls.parameters:
        if name not in fields and name not in defaults:
            raise InputError(f'<{spec.tag} type="{spec.type}"> lacks <{registry.tag_name(name)}>', spec.where)
    for name, prop in cls.properties.items():
        if name in fields:
            fields[name] = tuple(fields[name]) if prop.many else fields[name][-1]
        elif prop.default is not None:
            fields[name] = _child(ctx, Component(name, prop.default, where=spec.where), prop, part)
        elif not prop.optional and not prop.many:
            raise InputError(f'<{spec.tag} type="{spec.type}"> lacks <{name}>', spec.where)
    if ctx.refused and any(v is None for v in fields.values()):
        return None
    try:
        return cls(**fields)
    except (TypeError, ValueError) as e:
        raise InputError(f'<{spec.tag} type="{spec.type}">: {e}', spec.where) from None


def _field(ctx: Context, cls: Any, c: Component, part: str, fields: dict[str, Any], spec: Component) -> None:
    name = registry.field_name(c.tag)
    properties = getattr(cls, "properties", {})
    if c.tag == "mat_axis":
        fields["mat_axis"] = mat_axis(ctx, c, part)
    elif name in properties:
        made = _child(ctx, c, properties[name], part)
        fields.setdefault(name, []).append(made)
    elif name in cls.parameters:
        fields[name] = ctx.value(c, maps=part)
    elif name in getattr(cls, "options", ()):
        fields[name] = int(c.as_float())
    elif c.tag in ("density", "k", "pressure_model") and hasattr(cls, "density_"):
        if c.tag == "density":
            fields["density_"] = ctx.value(c, maps=part)
        elif cls.uncoupled:
            fields[c.tag] = ctx.value(c, maps=part) if c.tag == "k" else _pressure_model(c)
        else:
            ctx.refuse(f'<{c.tag}> of <{spec.tag} type="{spec.type}">', c.where)
    elif c.tag not in IGNORED:
        ctx.refuse(f'<{c.tag}> of <{spec.tag} type="{spec.type}">', c.where)


def _pressure_model(leaf: Component) -> int:
    names = {"default": 0, "nike3d": 1, "abaqus": 2, "abaqus (goh)": 3}
    t = leaf.text.strip()
    return names.get(t.lower(), 0) if not t.isdigit() else int(t)


def _child(ctx: Context, c: Component, prop: Property, part: str) -> Any:
    if prop.table in ("direction", "vector"):
        return direction(ctx, c, part)
    return solid_record(ctx, c, prop.table, part)


def is_rigid(spec: Component) -> bool:
    return spec.type == "rigid body"


def unique_nodes(conn: np.ndarray) -> np.ndarray:
    return np.unique(conn)
