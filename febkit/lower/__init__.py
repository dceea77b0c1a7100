"""The seam: a :class:`febkit.model.Model` becomes a :class:`febkit.solver.problem.Problem`.

What the solver lacks is refused here, by name and place, before anything is solved.
"""

from __future__ import annotations

from importlib import import_module

from febkit.model import InputError, Model, UnsupportedError, Where, as_record
from febkit.model import Step as ModelStep
from febkit.model.source import together
from febkit.model.species import solutes
from febkit.solver.elements import LINES
from febkit.solver.fields import DISPLACEMENT, PRESSURE, Layout, concentration
from febkit.solver.problem import DYNAMIC, Block, Problem, Step

from . import conditions, control, loads, materials, rigid, shells
from .context import Context

SOLUTES = ("solute", "multiphasic")  # modules with concentrations
MODULES = ("solid", "biphasic", *SOLUTES)
CONSTRAINTS = {  # type -> module here that reads it
    "linear constraint": "ties",
    "rigid_wall": "walls",
    "fixed normal displacement": "held",
    "symmetry plane": "held",
    "volume": "held",
    "node distance": "held",
    "prestrain": "prestrain",
    "in-situ stretch": "prestrain",
    "azimuth constraint": "points",
    "node-on-node": "points",
    "point": "points",
    "tied-line": "lines",
    "slide-line": "lines",
}
ADAPTORS = {  # type -> module here and function that reads it
    "erosion": ("adaptors", "erosion"),
    **dict.fromkeys(("hex_refine", "hex_refine2d", "tet_refine", "test_refine"), ("refinement", "refinement")),
}


def lower(model: Model) -> Problem:
    """The problem that ``model`` poses.

    Raises UnsupportedError, naming every feature febkit does not solve, and InputError for bad input.
    """
    record = as_record(model)
    try:
        problem, refused = _lower(record)
        if refused:
            raise together(refused)
    except InputError as e:
        raise e if e.where is not None and e.where.file else type(e)(e.message, Where(record.file)) from None
    assert problem is not None
    return problem


def unsupported(model: Model) -> list[UnsupportedError]:
    """The features of a model that febkit does not solve, each with its place; empty where it can."""
    try:
        return _lower(as_record(model))[1]
    except UnsupportedError as e:
        return [e]


def _lower(model: Model) -> tuple[Problem | None, list[UnsupportedError]]:
    ctx = Context(model)
    ctx.lower = lower
    _whole_sections(ctx)
    if model.module not in MODULES:
        return None, ctx.refused
    ctx.rigid = rigid.bodies(ctx)
    blocks = materials.blocks(ctx)
    ctx.layout = _layout(model, blocks)
    domains = {d.block: d for d in model.domains if d.kind == "shell"}
    if domains and not ctx.refused:
        ctx.X, ctx.back = shells.thick(ctx, blocks, domains)
    bodies = rigid.make(ctx)
    ctx.numbers, ctx.made = {b.name: k for k, b in enumerate(blocks)}, blocks
    ctx.common = common = Step()
    _fill(ctx, common, model.common)
    if model.mesh.hanging:
        from .refinement import hanging

        common.constraints += hanging(model.mesh, ctx.layout)
    if model.discrete:
        from . import ties

        ties.discrete(ctx, common)
    if any(m.child("membrane_reaction") for m in model.materials) and not ctx.refused:
        from . import membranes

        common.loads += membranes.fluxes(ctx, blocks, domains)
    steps = [_step(ctx, s) for s in model.steps]
    common.loads[:0] = ctx.feedback
    rigid.check(ctx, [(common, s) for s in steps])
    if ctx.bonded:
        from . import bonds

        bonds.settle(ctx, common, steps)
    if any(s.constraints for s in (common, *steps)):
        from . import ties

        ties.check(ctx, [(common, s) for s in steps])
    if any(d.kind == "beam" for d in model.domains):
        from . import beams

        beams.check(ctx, blocks, common, steps)
    if any(s.adaptors for s in (common, *steps)) and not ctx.refused:
        from . import adaptors, refinement

        adaptors.owners(ctx, [common, *steps])
        refinement.check(ctx, blocks, common, steps)
    if any(s.explicit for s in steps):
        _explicit(ctx, blocks, common, steps)
    if any(s.newton.descent for s in steps):
        _conjugate(ctx, blocks, common, steps)
    _midpoint(ctx, blocks, steps)
    _end(ctx, steps)
    if not steps:
        raise InputError("the model has no <Control> and no <Step>: there is nothing to solve", Where(model.file))
    if not blocks and not bodies and not ctx.refused:
        raise InputError("the model has no elements to solve for", Where(model.file))
    if ctx.refused:
        return None, ctx.refused
    return Problem(ctx.X, blocks, steps, common, model.mesh.node_ids, bodies, ctx.layout, model), []


def _layout(model: Model, blocks: list[Block]) -> Layout:
    """The nodal fields of a model's module, and of its materials."""
    own = [DISPLACEMENT] if model.module == "solid" else [DISPLACEMENT, PRESSURE]
    if model.module in SOLUTES:
        own += [concentration(s.index + 1) for s in solutes(model)]
    return Layout.of(own, *(b.physics.fields for b in blocks))


def _explicit(ctx: Context, blocks: list[Block], common: Step, steps: list[Step]) -> None:
    """Refuse what central differences do not follow here: all but solids and trusses under loads that stay."""
    n = len(ctx.model.mesh.X)  # rows of rigid bodies follow
    for s, spec in zip(steps, ctx.model.steps):
        if s.explicit is None:
            continue
        both, by_rows = (common, s), s.explicit.by_rows
        lines = {"linear truss"} if by_rows else set()
        other = [b.name for b in blocks if b.physics.name not in {"standard", *lines} or b.element.startswith("shell_")]
        found = {
            "rigid connectors": any(q.connectors for q in both),
            "constraints": any(q.constraints for q in both), "adaptors": any(q.adaptors for q in both),
            "an initial velocity (which FEBio passes over)": any(
                i.velocity and min(i.nodes, default=n) < n for q in both for i in q.initial
            ),
            "a body load that follows the motion": any(b.moves for q in both for b in q.body_loads),
            f"the elements of part {other[0] if other else ''!r}": bool(other),
        }  # fmt: skip
        for what in (k for k, there in found.items() if there):
            where = spec.control.where if spec.control else None
            ctx.refuse(f'{what} with <solver type="explicit-solid">', where)


def _conjugate(ctx: Context, blocks: list[Block], common: Step, steps: list[Step]) -> None:
    """Refuse what conjugate gradients were not tried on beside FEBio's: all but solids under loads."""
    solids = ("standard", "three-field")
    other = [b.name for b in blocks if b.physics.name not in solids or b.element.startswith("shell_")]
    for s, spec in zip(steps, ctx.model.steps):
        both = (common, s)
        found = {
            "rigid bodies": bool(ctx.rigid), "contact": any(q.contacts for q in both),
            "constraints": any(q.constraints or q.connectors for q in both), "adaptors": any(q.adaptors for q in both),
            f"the elements of part {other[0] if other else ''!r}": bool(other),
        }  # fmt: skip
        for what in (k for k, there in found.items() if there and s.newton.descent):
            ctx.refuse(f'{what} with <solver type="CG-solid">', spec.control.where if spec.control else None)


def _midpoint(ctx: Context, blocks: list[Block], steps: list[Step]) -> None:
    """The midpoint rule's energy-conserving stress is not there for element-mean pressures of solids, nor for laws
    without an energy."""
    three = any(b.physics.name == "three-field" and not b.element.startswith("shell_") for b in blocks)
    for s, spec in zip(steps, ctx.model.steps):
        late = [b for b in blocks if b.physics.name in ("ut4", "assumed strain")]
        if s.analysis == DYNAMIC and s.newton.between and late:
            where = spec.control.where if spec.control else None
            ctx.refuse(f"forces within the step (<rhoi>, <alpha>) of part {late[0].name!r}", where)
        if s.analysis == DYNAMIC and s.newton.rho_inf == 1 and three:
            ctx.refuse("<rhoi>1</rhoi> with three-field elements", spec.control.where if spec.control else None)
        elif s.analysis == DYNAMIC and s.newton.rho_inf == 1:
            for b in blocks:
                if b.element not in LINES and not _has_energy(b):
                    ctx.refuse(f"<rhoi>1</rhoi> with the material of part {b.name!r}, which gives no strain energy,",
                               spec.control.where if spec.control else None)  # fmt: skip


def _has_energy(b: Block) -> bool:
    """Do all laws of a block give a strain energy?"""
    from febkit.solver.solids.base import Solid
    from febkit.solver.solids.uncoupled import Uncoupled

    given = {Solid.energy, Uncoupled.dev_energy}  # that raise
    return not any(getattr(type(m), n, None) in given for m in b.solid.walk() for n in ("energy", "dev_energy"))


def _end(ctx: Context, steps: list[Step]) -> None:
    """Plotfiles keep times in 32 bits; what they cannot hold is no time to solve to."""
    end = sum(map(control.end_time, steps))
    if not end <= control.LAST:
        where = ctx.model.steps[-1].control.where if ctx.model.steps[-1].control else None
        raise InputError(f"the model ends at t = {end:g}; plotfiles hold times up to {control.LAST:g}", where)


def _whole_sections(ctx: Context) -> None:
    m = ctx.model
    if m.module not in MODULES:
        ctx.refuse(f'<Module type="{m.module}">', m.module_spec.where if m.module_spec else None)
    for step in (m.common, *m.steps):
        for c in step.adaptors:
            if c.type not in ADAPTORS:
                ctx.refuse(f'<{c.tag} type="{c.type}">', c.where)
        for c in step.constraints:
            if c.type not in CONSTRAINTS:
                ctx.refuse(f'<{c.tag} type="{c.type}">', c.where)
    for c in m.unknown:
        if c.tag == "Globals":
            ctx.check_tags(c, {"Solutes", "SolidBoundMolecules"})
        else:
            ctx.refuse(f"the section <{c.tag}>", c.where)


def _step(ctx: Context, spec: ModelStep) -> Step:
    out = Step(name=spec.name or "")
    if spec.control is None:
        raise InputError("a <step> has no <Control>", spec.where)
    control.step(ctx, spec.control, out)
    _fill(ctx, out, spec)
    if control.mixed(ctx, spec.control):
        from . import midnodes

        out.constraints += midnodes.constraints(ctx)
    return out


def _fill(ctx: Context, out: Step, spec: ModelStep) -> None:
    given = [c for c in spec.loads if c.type in conditions.AS_LOADS]  # version 3.0 has these conditions among loads
    out.conditions = conditions.conditions(ctx, (*spec.boundary, *given))
    out.initial = conditions.initial(ctx, spec.initial)
    out.loads, out.body_loads = loads.loads(ctx, tuple(c for c in spec.loads if c not in given))
    rigid.fill(ctx, out, spec)
    for c in spec.rigid:
        if c.tag == "rigid_connector":
            from . import connectors

            connectors.read(ctx, out, c)
    for c in spec.constraints:
        if c.type in CONSTRAINTS:
            import_module(f".{CONSTRAINTS[c.type]}", __name__).constraint(ctx, out, c)
    for c in spec.boundary:
        if c.type == "linear constraint":
            from . import ties

            ties.condition(ctx, out, c)
    for c in spec.adaptors:
        if c.type in ADAPTORS:
            module, read = ADAPTORS[c.type]
            out.adaptors.append(getattr(import_module(f".{module}", __name__), read)(ctx, c))
    if spec.contact:
        from .contact import contacts

        contacts(ctx, out, spec.contact)


__all__ = ["lower", "unsupported"]
