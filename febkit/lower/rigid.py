"""Rigid materials, <Rigid> and <bc type="rigid"> to rigid bodies, their conditions and loads."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import field
from math import radians
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from febkit.model import Component, InputError, values
from febkit.model import Step as ModelStep
from febkit.model.sets import node_indices
from febkit.record import variable_record
from febkit.solver import elements, loads
from febkit.solver.problem import Attached, Block, Fixed, Initial, Prescribed, Step
from febkit.solver.values import Constant, Value

from . import shells
from .context import Context

if TYPE_CHECKING:
    from febkit.solver.rigid.body import RigidBody

Floats = NDArray[np.float64]
TYPE = "rigid body"
DOFS = ("Rx", "Ry", "Rz", "Ru", "Rv", "Rw")
SHIFT = {"x": 0, "y": 1, "z": 2, "Rx": 0, "Ry": 1, "Rz": 2}
TURN = {"Ru": 3, "Rv": 4, "Rw": 5, "U": 3, "V": 4, "W": 5}
LOAD_TYPES = {"load": "LOAD", "follow": "FOLLOW", "target": "TARGET", "0": "LOAD", "1": "FOLLOW", "2": "TARGET"}
MATERIAL = frozenset({"name", "density", "E", "v", "center_of_mass", "override_com"})
FIXED = frozenset({"rb", *(f"{r}_dof" for r in DOFS)})
GIVEN = frozenset({"rb", "dof", "value", "relative"})


@variable_record
class Body:
    """A body to be: its first material, whose centre counts, and its index."""

    spec: Component
    index: int
    blocks: list[tuple[str, str]] = field(default_factory=list)  # (part, material)


def bodies(ctx: Context) -> dict[str, Body]:
    """Rigid bodies by the names of their materials; those whose parts share a node are one."""
    model = ctx.model
    rigid = [m for m in model.materials if m.type == TYPE]
    for m in rigid:
        ctx.check_tags(m, MATERIAL)
    first = {m.name or "": k for k, m in enumerate(rigid)}
    seen: dict[int, str] = {}
    parts = []
    for d in model.domains:
        if d.material in first and d.block in ctx.blocks:
            if d.kind not in ("solid", "shell"):
                ctx.refuse(f'a rigid {d.kind} (part "{d.block}")', d.where)
                continue
            parts.append((d.block, d.material))
            for n in np.unique(ctx.blocks[d.block].conn).tolist():
                a, b = first[d.material], first[seen.setdefault(n, d.material)]
                if a != b:
                    first = {name: min(a, b) if k in (a, b) else k for name, k in first.items()}
    order = {k: i for i, k in enumerate(sorted(set(first.values())))}
    made = {k: Body(rigid[k], i) for k, i in order.items()}
    for block, material in parts:
        made[first[material]].blocks.append((block, material))
    return {name: made[k] for name, k in first.items()}


def make(ctx: Context) -> list[RigidBody]:
    """The bodies, with mass and centre; ``ctx.X`` must be complete."""
    if not ctx.rigid:
        return []
    from febkit.solver.rigid.body import Part, RigidBody
    from febkit.solver.solids.inert import Inert

    named = {m.name: m for m in ctx.model.materials}
    domains = {d.block: d for d in ctx.model.domains}
    out = []
    for body in {b.index: b for b in ctx.rigid.values()}.values():
        parts, extra = [], []
        for name, material in body.blocks:
            mesh = ctx.blocks[name]
            shell = domains[name].kind == "shell"
            if mesh.type not in (elements.FACETS if shell else elements.VOLUMES):
                ctx.refuse(f"element type {mesh.type}", mesh.where)
                continue
            law = Inert(density_=ctx.value(named[material].child("density"), 1.0, name))
            block = Block(name, mesh.type, mesh.conn, mesh.ids, law)
            parts.append(Part(block, ctx.X, shells.thickness(ctx, domains[name], needed=False) if shell else None))
            back = ctx.back[np.unique(mesh.conn)]
            extra.append(back[back >= 0])
        out.append(RigidBody(body.spec.name or "", parts, _centre(body.spec), extra))
    ctx.centres = [b.centre for b in out]
    return out


def _centre(spec: Component) -> Floats | None:
    given, override = spec.child("center_of_mass"), spec.child("override_com")
    if given is None or (override is not None and not override.as_bool()):
        return None
    return np.array(given.as_floats(3))


def body(ctx: Context, c: Component, tag: str = "rb") -> int:
    """Index of the body that a tag names by its material, or by the material's number."""
    ref = c.need(tag).text.strip()
    if ref in ctx.rigid:
        return ctx.rigid[ref].index
    for k, m in enumerate(ctx.model.materials):
        if m.type == TYPE and ref == str(m.id or k + 1):
            return ctx.rigid[m.name or ""].index
    where = c.need(tag).where
    raise InputError(f'<{tag}>: there is no rigid body material "{ref}"{values.near(ref, ctx.rigid)}', where)


def place(ctx: Context, index: int, dof: int) -> tuple[int, np.ndarray]:
    """Column and row of an unknown of a body: 0 to 2 its displacement, 3 to 5 its rotation."""
    return int(ctx.layout.displacement[dof % 3]), np.array([len(ctx.X) + 2 * index + dof // 3])


def carried(ctx: Context, out: Step) -> np.ndarray:
    """Nodes that rigid bodies lead in a step."""
    own = [ctx.blocks[name].conn.ravel() for b in ctx.rigid.values() for name, _ in b.blocks]
    attached = [a.nodes for a in (*ctx.common.attached, *out.attached)]
    return np.unique(np.concatenate([np.zeros(0, np.int64), *own, *attached]))


def fill(ctx: Context, out: Step, spec: ModelStep) -> None:
    """What a step says of rigid bodies."""
    for c in spec.boundary:
        if c.type == "rigid":
            out.attached.append(_attached(ctx, c))
    for c in spec.rigid:
        reader = READERS.get((c.tag, c.type or ""))
        if c.tag == "rigid_connector":  # read by connectors.read
            continue
        if reader is None:
            ctx.refuse(f'<{c.tag} type="{c.type}">', c.where)
        else:
            reader(ctx, out, c)


def _attached(ctx: Context, c: Component) -> Attached:
    """<bc type="rigid">: the nodes of a set, those of shells with their back faces."""
    ctx.check_tags(c, {"rb", "clamp_shells"})
    nodes = node_indices(ctx.model.mesh, c.attrs.get("node_set", ""), c.where)
    back = ctx.back[nodes]  # FEBio clamps them whatever <clamp_shells> says
    return Attached(body(ctx, c), np.concatenate([nodes, back[back >= 0]]))


def _fixed(ctx: Context, out: Step, c: Component) -> None:
    ctx.check_tags(c, FIXED)
    index = body(ctx, c)
    out.conditions += [Fixed(*place(ctx, index, k)) for k, name in enumerate(DOFS) if c.bool(f"{name}_dof")]


def _given(table: dict[str, int]) -> Callable[[Context, Step, Component], None]:
    lower = {name.lower(): dof for name, dof in table.items()}

    def read(ctx: Context, out: Step, c: Component) -> None:
        ctx.check_tags(c, GIVEN)
        column, row = place(ctx, body(ctx, c), c.need("dof").as_choice(lower))
        out.conditions.append(Prescribed(column, row, ctx.value(c.child("value"), 0.0), c.bool("relative")))

    return read


@variable_record
class Euler:
    """A component of the rotation vector of Euler angles in degrees, about x, then y, then z."""

    angles: tuple[Value, Value, Value]
    component: int
    constant: bool = False
    steady: bool = False

    def __call__(self, t: float, X: Floats, e: NDArray[np.int64] | None = None) -> Floats:
        from febkit.solver.rigid import rotation

        x, y, z = (radians(float(a(t, X)[0])) for a in self.angles)
        return rotation.vector(rotation.of_euler(x, y, z))[[self.component]]


def _rotation_vector(ctx: Context, out: Step, c: Component) -> None:
    ctx.check_tags(c, {"rb", "vx", "vy", "vz"})
    index = body(ctx, c)
    for k, tag in enumerate(("vx", "vy", "vz")):
        out.conditions.append(Prescribed(*place(ctx, index, 3 + k), ctx.value(c.child(tag), 0.0)))


def _euler(ctx: Context, out: Step, c: Component) -> None:
    ctx.check_tags(c, {"rb", "Ex", "Ey", "Ez", "convention"})
    index = body(ctx, c)
    x, y, z = (ctx.value(c.child(tag), 0.0) for tag in ("Ex", "Ey", "Ez"))
    out.conditions += [Prescribed(*place(ctx, index, 3 + k), Euler((x, y, z), k)) for k in range(3)]


def _velocity(turn: int) -> Callable[[Context, Step, Component], None]:
    def read(ctx: Context, out: Step, c: Component) -> None:
        ctx.check_tags(c, {"rb", "value"})
        index, v = body(ctx, c), c.need("value").as_floats(3)
        for k in range(3):
            out.initial.append(Initial(*place(ctx, index, 3 * turn + k), Constant(v[k]), velocity=True))

    return read


def check(ctx: Context, steps: list[tuple[Step, Step]]) -> None:
    """Refuse bodies that turn as told about some axes and freely about others, as FEBio does."""
    for b in {b.index: b for b in ctx.rigid.values()}.values():
        row = int(place(ctx, b.index, 3)[1][0])
        for common, step in steps:
            held = [q for s in (common, step) for q in s.conditions if row in q.nodes]
            given = {q.column for q in held if isinstance(q, Prescribed)}
            if given and len({q.column for q in held}) < 3:
                ctx.refuse(
                    f'rigid body "{b.spec.name}" that turns as prescribed about some axes and freely about others',
                    b.spec.where,
                )
                break


def _load(ctx: Context, c: Component, known: set[str], **fields: Any) -> Any:
    ctx.check_tags(c, {"rb", *known})
    index = body(ctx, c)
    return loads.load(c.type or "")(index, len(ctx.X) + 2 * index, **fields)


def _force(ctx: Context, out: Step, c: Component) -> None:
    """A force along, or a moment about, an axis; FEBio's TARGET, from the reaction, is not there."""
    table = {"rigid_force": {k: v for k, v in SHIFT.items() if k in DOFS}, "rigid_moment": TURN}[c.type or ""]
    axis = c.need("dof").as_choice({name.lower(): k % 3 for name, k in table.items()})
    kind = c.choice("load_type", LOAD_TYPES, "LOAD")
    if kind == "TARGET" or (kind == "FOLLOW" and c.type == "rigid_moment"):
        ctx.refuse(f'<load_type>{kind}</load_type> of <{c.tag} type="{c.type}">', c.need("load_type").where)
        return
    if c.bool("relative"):
        ctx.refuse(f'<relative> of <{c.tag} type="{c.type}">', c.need("relative").where)
    fields = {"axis": axis, "value": ctx.value(c.child("value"), 0.0)}
    if c.type == "rigid_force":
        fields["follow"] = kind == "FOLLOW"
    out.loads.append(_load(ctx, c, {"dof", "value", "load_type", "relative"}, **fields))


def _follower_force(ctx: Context, out: Step, c: Component) -> None:
    load = _load(ctx, c, {"insertion", "force", "relative"}, given=ctx.vector(c.need("force")))
    load.arm = _point(ctx, c.child("insertion"), load.body, c.bool("relative")) - ctx.centres[load.body]
    out.loads.append(load)


def _follower_moment(ctx: Context, out: Step, c: Component) -> None:
    out.loads.append(_load(ctx, c, {"moment"}, given=ctx.vector(c.need("moment"))))


def _axial(ctx: Context, out: Step, c: Component) -> None:
    """A force along the line between points of two bodies."""
    from febkit.solver.rigid.connectors import AxialForce

    ctx.check_tags(c, {"rbA", "rbB", "ra", "rb", "force", "relative"})
    a, b, relative = body(ctx, c, "rbA"), body(ctx, c, "rbB"), c.bool("relative")
    at, to = _point(ctx, c.child("ra"), a, relative), _point(ctx, c.child("rb"), b, relative)
    out.connectors.append(AxialForce(a, b, at, to, f0=ctx.value(c.child("force"), 0.0)))


def _point(ctx: Context, leaf: Component | None, body: int, relative: bool) -> Floats:
    """A point of a body in the reference, given from its centre where ``relative``."""
    given = np.zeros(3) if leaf is None else np.array(leaf.as_floats(3))
    return given + ctx.centres[body] if relative else given


def _cable(ctx: Context, out: Step, c: Component) -> None:
    """A force at the last of several bodies, and its pull between those before it."""
    from febkit.solver.rigid.connectors import Cable

    ctx.check_tags(c, {"force", "force_direction", "relative", "rigid_cable_point"})
    leaf, points = c.child("force_direction"), c.all("rigid_cable_point")
    if not points:
        raise InputError(f"{c.what} has no <rigid_cable_point>", c.where)
    direction = np.array([0.0, 0.0, -1.0] if leaf is None else leaf.as_floats(3))
    if not direction.any():
        raise InputError(f"{c.what}: <force_direction> is zero", c.where)
    relative, force = c.bool("relative", True), ctx.value(c.child("force"), 0.0)
    at = [body(ctx, q, "rigid_body_id") for q in points]
    where = [_point(ctx, q.child("position"), k, relative) for q, k in zip(points, at, strict=True)]
    for k in range(len(at) - 1):
        out.connectors.append(Cable(at[k], at[k + 1], where[k], where[k + 1], f0=force))
    last, row = at[-1], len(ctx.X) + 2 * at[-1]
    out.loads.append(loads.load("rigid_cable")(
        last, row, where[-1] - ctx.centres[last], direction / np.linalg.norm(direction), force,
    ))  # fmt: skip


def _fixed_old(ctx: Context, out: Step, c: Component) -> None:
    ctx.check_tags(c, {"rb", "dofs"})
    index, names = body(ctx, c), {name.lower(): k for k, name in enumerate(DOFS)}
    for said in c.need("dofs").text.replace(",", " ").split():
        if said.lower() not in names:
            raise InputError(f"<dofs> are {', '.join(DOFS)}, not {said!r}", c.need("dofs").where)
        out.conditions.append(Fixed(*place(ctx, index, names[said.lower()])))


READERS: dict[tuple[str, str], Callable[[Context, Step, Component], Any]] = {
    ("rigid_bc", "rigid_fixed"): _fixed,
    ("rigid_bc", "rigid_fixed_old"): _fixed_old,
    ("rigid_bc", "rigid_prescribed_old"): _given(SHIFT | TURN),
    ("rigid_bc", "rigid_displacement"): _given(SHIFT),
    ("rigid_bc", "rigid_rotation"): _given(TURN),
    ("rigid_bc", "rigid_rotation_vector"): _rotation_vector,
    ("rigid_bc", "rigid_euler_angles"): _euler,
    ("rigid_load", "rigid_force"): _force,
    ("rigid_load", "rigid_moment"): _force,
    ("rigid_load", "rigid_axial_force"): _axial,
    ("rigid_load", "rigid_cable"): _cable,
    ("rigid_load", "rigid_follower_force"): _follower_force,
    ("rigid_load", "rigid_follower_moment"): _follower_moment,
    ("rigid_ic", "initial_rigid_velocity"): _velocity(0),
    ("rigid_ic", "initial_rigid_angular_velocity"): _velocity(1),
}
