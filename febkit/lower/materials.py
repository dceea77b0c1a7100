"""Material trees to solver records."""

from __future__ import annotations

import dataclasses
from typing import Any

from febkit.model import Component, Domain, InputError, Where, ranges, values
from febkit.model.sets import missing
from febkit.solver import momentum_supplies, permeabilities, physics, supplies
from febkit.solver.problem import Block
from febkit.solver.solids import registry
from febkit.solver.solids.base import Property

from . import element_types, shells
from .context import Context
from .curves import curve, of_one
from .functions import compiled
from .laws import law

# elements FEBio gives the three-field formulation where the material is uncoupled
THREE_FIELD = {"hex8", "penta6", "pyra5"}
OPTIONS = frozenset({"laugon", "atol", "minaug", "maxaug", "elem_type", "three_field", "but4", "secant_stress", "secant_tangent"})  # noqa: E501
MIXTURES = ("biphasic-solute", "triphasic", "multiphasic")  # read by mixtures, which is imported where one is there
# written by FEBio Studio, of no meaning to a solver
IGNORED = frozenset({"name", "mat_axis", "print_derivs"})


def _axes() -> Any:
    """Generators of axes and directions, imported where a model has any."""
    from . import axes

    return axes


def blocks(ctx: Context) -> list[Block]:
    """One solver block per domain."""
    out = []
    named = {m.name: m for m in ctx.model.materials}
    if not ctx.model.domains:
        raise InputError("the model has no <MeshDomains>: no element has a material", Where(ctx.model.file))
    for d in ctx.model.domains:
        if d.kind not in ("solid", "shell", "beam"):
            ctx.refuse(f'a {d.kind} domain (part "{d.block}")', d.where)
            continue
        if d.block not in ctx.blocks:
            raise missing("element block", d.block, ctx.blocks, d.where)
        if d.material not in named:
            raise missing("material", d.material, [n or "" for n in named], d.where)
        if not len(ctx.blocks[d.block].conn):
            continue
        if d.material in ctx.rigid:  # its nodes are led; its elements do nothing
            continue
        b = (_lines if d.kind == "beam" else _block)(ctx, d, named[d.material])
        if b is not None:
            out.append(b)
    return out


def _lines(ctx: Context, d: Domain, spec: Component) -> Block | None:
    from . import beams

    return beams.block(ctx, d, spec, record)


def _block(ctx: Context, d: Domain, spec: Component) -> Block | None:
    from febkit.solver import elements

    mesh = ctx.blocks[d.block]
    if d.kind == "shell" and not shells.check(ctx, d, spec.type or ""):
        return None
    if d.kind == "solid" and mesh.type not in elements.VOLUMES:
        ctx.refuse(f"element type {mesh.type}", mesh.where)
        return None
    mixture, top = None, spec
    if spec.type == "biphasic":
        mixture = _biphasic(ctx, spec, d.block)
        spec = spec.need("solid")
    elif spec.type in MIXTURES:
        from . import mixtures

        mixture = mixtures.multiphasic(ctx, spec, d.block)
        if mixture is None:
            return None
        spec = spec.need("solid")
    solid = record(ctx, spec, "solid", d.block)
    if solid is None:
        return None
    if mixture is not None and top.type in MIXTURES:
        mixtures.attach(ctx, top, mixture.mixture, solid)
    elif any(hasattr(node, "sbm") for node in solid.walk()):
        raise InputError(f"{spec.what} goes by a solid-bound molecule: it is for multiphasic materials", spec.where)
    if mixture is not None:
        for node in solid.walk():
            if hasattr(node, "phi0"):  # porous solids take the porosity of the mixture
                node.phi0 = mixture.phi0 if top.type == "biphasic" else mixture.mixture.phi0
    block = Block(d.block, mesh.type, mesh.conn, mesh.ids, solid, mixture or physics.default())
    if ctx.model.mesh_data:
        block.axes = _axes().element_axes(ctx, d.block)
    own = top.child("mat_axis")
    if mixture is not None and own is not None:
        _turn(mixture, solid, _axes().mat_axis(ctx, own, d.block))
    if d.kind == "solid":
        _formulation(ctx, d, block, mixture is not None)
    elif mixture is None and not shells.assumed(ctx, d, block) and solid.uncoupled and shells.three_field(d, mesh.type):
        block.physics = physics.load("three-field")(_augment(d.spec))
    return block


def _turn(mixture: Any, solid: Any, outer: Any) -> None:
    """Hand the axes of a mixture down to its laws."""
    solid.mat_axis = outer
    made = getattr(mixture, "mixture", mixture)  # of several species, or biphasic
    diffusivities = (q.diffusivity for q in getattr(made, "solutes", ()))
    for own in (made.permeability, getattr(made, "active", None), *diffusivities):
        if own is not None:
            inner = own.mat_axis
            own.mat_axis = outer if inner is None else lambda pts, inner=inner: outer(pts) @ inner(pts)


def _formulation(ctx: Context, d: Domain, block: Block, mixture: bool) -> None:
    """FEBio's rule for which formulation an element gets, and the options of <SolidDomain>."""
    options = d.spec
    if d.type == "ut4-solid":
        from . import tets

        tets.nodal(ctx, d, block, mixture)
        return
    if d.type in ("udg-hex", "sri-solid", "rigid-solid"):
        ctx.refuse(f'<SolidDomain type="{d.type}">', d.where)
    if options is not None:
        ctx.check_tags(options, OPTIONS)
        block.rule = element_types.rule(ctx, d, block.element)
    can = block.element in THREE_FIELD and block.solid.uncoupled and not mixture
    three = d.type == "three-field-solid" or (can and d.type in (None, ""))
    if three and block.solid.uncoupled and not mixture:
        block.physics = physics.load("three-field")(_augment(options))


def _augment(options: Component | None) -> Any:
    """How the element pressures of a three-field domain are augmented, where they are."""
    if options is None or not options.bool("laugon"):
        return None
    from febkit.solver.physics.three_field import Augment

    return Augment(options.float("atol", 0.01), options.int("minaug", 0), options.int("maxaug", 0))


def _biphasic(ctx: Context, spec: Component, part: str) -> Any:
    ctx.check_tags(spec, {"phi0", "fluid_density", "tau", "solid", "permeability", "solvent_supply", "active_supply", "density", "mat_axis"})  # noqa: E501
    if spec.float("tau", 0.0):
        ctx.refuse("<tau> (flux relaxation) of a biphasic material", spec.need("tau").where)
    perm = law(ctx, spec.need("permeability"), permeabilities, part)
    supply, active = spec.child("solvent_supply"), spec.child("active_supply")
    return physics.load("biphasic")(
        perm,
        ctx.value(spec.child("phi0"), 0.0, part),
        ctx.value(spec.child("fluid_density"), 0.0, part),
        None if supply is None else law(ctx, supply, supplies, part),
        None if active is None else law(ctx, active, momentum_supplies, part),
    )


def _defaults(cls: Any) -> dict[str, Any]:
    return {f.name: f.default for f in dataclasses.fields(cls) if f.default is not dataclasses.MISSING}


def record(ctx: Context, spec: Component, table: str, part: str) -> Any:
    """The record of a material or of a property of one; None where it is refused."""
    kind = spec.type or spec.tag  # a child without a type is of the one its tag names
    if not registry.known(table, kind):
        ctx.refuse(f'<{spec.tag} type="{kind}">', spec.where)
        return None
    cls = registry.load(table, kind)
    refusals = len(ctx.refused)
    fields: dict[str, Any] = {}
    for c in spec:
        _field(ctx, cls, c, part, fields, spec)
    _complete(ctx, cls, fields, spec, part)
    if len(ctx.refused) > refusals:
        return None
    try:
        return cls(**fields)
    except InputError:
        raise
    except (TypeError, ValueError) as e:
        raise InputError(f"{spec.what}: {e}", spec.where) from None


def _complete(ctx: Context, cls: Any, fields: dict[str, Any], spec: Component, part: str) -> None:
    """Required parameters must be there; properties take their default type, constants those of <Globals>."""
    defaults = _defaults(cls)
    for name in getattr(cls, "constants", ()):
        fields[name] = ctx.model.constants.get(name, 0.0)
        if fields[name] <= 0:
            raise InputError(
                f'<{spec.tag} type="{spec.type}"> needs a positive <{name}> in <Globals><Constants>', spec.where
            )
    for name in cls.parameters:
        if name not in fields and not _has_default(spec, name, defaults):
            raise InputError(f"{spec.what} lacks <{registry.tag_name(name)}>", spec.where)
    if ctx.model.mesh_data and "fiber" in cls.properties and cls.properties["fiber"].table == "direction":
        over = _axes().element_fibers(ctx, spec, part)
        if over is not None:
            fields["fiber"] = [over]
    for name, prop in cls.properties.items():
        if name in fields:
            fields[name] = tuple(fields[name]) if prop.many else fields[name][-1]
        elif prop.default is not None and prop.table != "direction":
            fields[name] = _child(ctx, Component(name, prop.default, where=spec.where), prop, part)
        elif not prop.optional and not prop.many and prop.table != "direction":
            raise InputError(f'<{spec.tag} type="{spec.type}"> lacks <{name}>', spec.where)


def _has_default(spec: Component, name: str, defaults: dict[str, Any]) -> bool:
    """False for a parameter that must be given: its default, where there is one, is none that FEBio admits."""
    if name not in defaults:
        return False
    if name == "phiw0" and spec.child("phis0") is not None:  # one is the other's complement
        return True
    r = ranges.of(spec.type or spec.tag).get(registry.tag_name(name))
    v = defaults[name]
    return r is None or all(r.holds(x) for x in (v if isinstance(v, tuple) else (v,)))


def _field(ctx: Context, cls: Any, c: Component, part: str, fields: dict[str, Any], spec: Component) -> None:
    name = registry.field_name(c.tag)
    if c.tag == "mat_axis" and hasattr(cls, "mat_axis"):
        fields["mat_axis"] = _axes().mat_axis(ctx, c, part)
    elif name in cls.properties:
        fields.setdefault(name, []).append(_child(ctx, c, cls.properties[name], part))
    elif name in cls.parameters:
        default = _defaults(cls).get(name)
        fields[name] = ctx.components(c, len(default), part) if isinstance(default, tuple) else ctx.value(c, maps=part)
    elif c.tag == "sbm" and hasattr(cls, "sbm"):
        fields["sbm"] = c.text.strip()  # its place is found where the mixture is known
    elif name in cls.options:
        fields[name] = _option(c, spec.type or spec.tag)
    elif c.tag == "density" and hasattr(cls, "density_"):
        fields["density_"] = ctx.value(c, maps=part)
    elif c.tag == "k" and getattr(cls, "uncoupled", False):
        fields["k"] = ctx.value(c, maps=part)
    elif c.tag == "pressure_model" and getattr(cls, "uncoupled", False):
        fields["pressure_model"] = _option(c, spec.type or spec.tag)
    elif c.tag not in IGNORED and c.tag not in getattr(cls, "beside", ()):
        ctx.refuse(f'<{c.tag}> of <{spec.tag} type="{spec.type}">', c.where)


MOST = 100_000  # of an option: steps over a circle, terms of a series


def _option(c: Component, type_: str) -> int:
    """A flag, a whole number, or the word that stands for one."""
    words = ranges.WORDS.get(c.tag, ())
    if words and not values.spells_number(c.text):
        return c.as_choice({w: k for k, w in enumerate(words)})
    flag = c.tag not in ranges.of(type_) and c.text.strip().lower() in values.TRUE | values.FALSE
    n = int(c.as_bool()) if flag else c.as_int()
    if n > MOST:
        raise InputError(f"<{c.tag}> must be at most {MOST}, not {n}", c.where)
    return n


def _child(ctx: Context, c: Component, prop: Property, part: str) -> Any:
    if prop.table == "direction":
        return _axes().direction(ctx, c, part)
    if prop.table == "curve":
        return curve(ctx, c)
    if prop.table in INVARIANTS:
        return _energy(ctx, c, INVARIANTS[prop.table])
    if prop.table == "rve":
        from . import volumes

        return volumes.volume(ctx, c)
    if prop.table == "formula":
        return of_one(ctx, c)
    return record(ctx, c, prop.table, part)


# what a formula of the energy may use
INVARIANTS = {"energy": ("I1", "I2", "J", "X", "Y", "Z"), "fiber energy": ("I1", "I2", "I4", "I5", "J")}


def _energy(ctx: Context, c: Component, invariants: tuple[str, ...]) -> Any:
    """A strain energy: a formula of the invariants after any number of definitions, ``name = formula;``."""
    *given, last = [s.strip() for s in (c.child("math") or c).text.split(";") if s.strip()] or [""]
    constants, names, steps = ctx.variables, list(invariants), []
    for text in given:
        name, equals, body = (s.strip() for s in text.partition("="))
        if not equals or not name.isidentifier():
            raise InputError(f"<{c.tag}>: {text!r} must read name = formula", c.where)
        steps.append((name, compiled(body, names, constants, c.where)))
        names.append(name)
    energy = compiled(last, names, constants, c.where)

    def value(at: dict[str, Any]) -> Any:
        env = dict(at)
        for name, f in steps:
            env[name] = f.at(env)
        return energy.at(env)

    return value
