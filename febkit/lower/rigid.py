"""Rigid bodies that are led: every degree of freedom held or prescribed, so that their nodes move as told.

A body with a free degree of freedom (a force or a joint may act on it) is refused by name.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from febkit.model import Component, InputError
from febkit.model.sets import node_indices
from febkit.solver import elements
from febkit.solver.problem import UX, UY, UZ, Prescribed
from febkit.solver.values import Constant, Value

from .context import Context

Floats = NDArray[np.float64]
TYPE = "rigid body"
SHIFT = {"x": 0, "y": 1, "z": 2, "Rx": 0, "Ry": 1, "Rz": 2}
TURN = {"Ru": 0, "Rv": 1, "Rw": 2, "U": 0, "V": 1, "W": 2}
MATERIAL = frozenset({"density", "E", "v", "center_of_mass", "override_com"})
FIXED = frozenset({"rb", *(f"{r}_dof" for r in ("Rx", "Ry", "Rz", "Ru", "Rv", "Rw"))})
GIVEN = frozenset({"rb", "dof", "value", "relative"})
ZERO = Constant(0.0)


@dataclass(eq=False)
class Body:
    """A led body: displacement of its centre, and the angle about one axis (None where it does not turn)."""

    spec: Component
    centre: Floats
    shift: list[Value | None] = field(default_factory=lambda: [None] * 3)
    turn: list[Value | None] = field(default_factory=lambda: [None] * 3)
    nodes: list[NDArray[np.int64]] = field(default_factory=list)

    @property
    def free(self) -> list[str]:
        names = ("x", "y", "z", "Ru", "Rv", "Rw")
        return [n for n, v in zip(names, [*self.shift, *self.turn], strict=True) if v is None]

    @property
    def axis(self) -> int | None:
        turning = [k for k, v in enumerate(self.turn) if v is not ZERO]
        return turning[0] if turning else None


@dataclass(eq=False)
class Motion:
    """One component of u = t + (R - I)(X - c), R the rotation about an axis of the body."""

    body: Body
    column: int
    constant: bool = False
    steady: bool = False

    def __call__(self, t: float, X: Floats, e: NDArray[np.int64] | None = None) -> Floats:
        b, k = self.body, self.column
        shift, axis = b.shift[k], b.axis
        assert shift is not None
        u: Floats = np.broadcast_to(shift(t, b.centre[None]), (len(X),)).copy()
        if axis is None or k == axis:
            return u
        turn = b.turn[axis]
        assert turn is not None
        angle = float(turn(t, b.centre[None])[0])
        other = 3 - axis - k
        sign = 1.0 if (k - axis) % 3 == 2 else -1.0  # axis x component: e_axis x e_other = sign e_k
        r = X - b.centre
        turned: Floats = u + (np.cos(angle) - 1.0) * r[:, k] + sign * np.sin(angle) * r[:, other]
        return turned


def bodies(ctx: Context) -> dict[str, Body]:
    """Rigid bodies of the model by the name of their material, led as <Rigid> says."""
    model = ctx.model
    out: dict[str, Body] = {}
    for m in model.materials:
        if m.type == TYPE:
            ctx.check_tags(m, MATERIAL | {"name"})
            out[m.name or ""] = Body(m, np.zeros(3))
    for d in model.domains:
        if d.material in out:
            if d.kind != "solid":
                ctx.refuse(f'a rigid {d.kind} (part "{d.block}")', d.where)
            elif d.block in ctx.blocks:
                out[d.material].nodes.append(np.unique(ctx.blocks[d.block].conn))
    for name, body in out.items():
        body.centre = _centre(ctx, body.spec, name)
    for step in (model.common, *model.steps):
        for c in step.rigid:
            _condition(ctx, out, c)
    if len(model.steps) > 1 and out:
        late = [c for s in model.steps for c in (*s.rigid, *(q for q in s.boundary if q.type == "rigid"))]
        for c in late:
            ctx.refuse(f'<{c.tag} type="{c.type}"> in one of several steps', c.where)
    for name, body in out.items():
        if body.free:
            ctx.refuse(f'rigid body "{name}" with free degrees of freedom ({", ".join(body.free)})', body.spec.where)
        elif sum(v is not ZERO for v in body.turn) > 1:
            ctx.refuse(f'rigid body "{name}" that turns about several axes', body.spec.where)
    return out


def _centre(ctx: Context, spec: Component, name: str) -> Floats:
    """Given centre of mass, or that of the body's elements."""
    given = spec.child("center_of_mass")
    override = spec.child("override_com")
    if given is not None and (override is None or override.as_bool()):
        return np.array(given.as_floats(3))
    mass, moment = 0.0, np.zeros(3)
    for d in ctx.model.domains:
        if d.material != name or d.block not in ctx.blocks:
            continue
        mesh = ctx.blocks[d.block]
        if mesh.type not in elements.VOLUMES:
            continue
        e, x = elements.get(mesh.type), ctx.model.mesh.X[mesh.conn]
        J = np.linalg.det(np.einsum("gai,eaj->egij", e.dN, x)) * e.weights
        mass += float(J.sum())
        moment += np.einsum("eg,ga,eai->i", J, e.N, x)
    return moment / mass if mass else moment


def _body(out: dict[str, Body], ctx: Context, c: Component) -> Body:
    ref = c.need("rb").text.strip()
    if ref in out:
        return out[ref]
    for k, m in enumerate(ctx.model.materials):
        if m.type == TYPE and ref == str(m.id or k + 1):
            return out[m.name or ""]
    raise InputError(f'there is no rigid body "{ref}"', c.where)


def _condition(ctx: Context, out: dict[str, Body], c: Component) -> None:
    if c.type == "rigid_fixed":
        ctx.check_tags(c, FIXED)
        body = _body(out, ctx, c)
        for name, k in SHIFT.items():
            if c.bool(f"{name}_dof"):
                body.shift[k] = ZERO
        for name, k in TURN.items():
            if c.bool(f"{name}_dof"):
                body.turn[k] = ZERO
        return
    table = {"rigid_displacement": SHIFT, "rigid_rotation": TURN}.get(c.type or "")
    if table is None:
        ctx.refuse(f'<{c.tag} type="{c.type}">', c.where)
        return
    ctx.check_tags(c, GIVEN)
    dof = c.need("dof").text.strip()
    if dof not in table:
        raise InputError(f"<dof> must be one of {', '.join(table)}, not {dof!r}", c.where)
    body = _body(out, ctx, c)
    (body.shift if c.type == "rigid_displacement" else body.turn)[table[dof]] = ctx.value(c.child("value"), 0.0)


def attach(ctx: Context, c: Component) -> None:
    """<bc type="rigid">: the nodes of a set belong to a body, those of shells with their back faces."""
    ctx.check_tags(c, {"rb", "clamp_shells"})
    body = _body(ctx.rigid, ctx, c)
    nodes = node_indices(ctx.model.mesh, c.attrs.get("node_set", ""), c.where)
    body.nodes.append(nodes)
    clamp = c.child("clamp_shells")
    if clamp is None or clamp.as_bool():
        back = ctx.back[nodes]
        body.nodes.append(back[back >= 0])


def conditions(ctx: Context) -> list[Prescribed]:
    """The motions of all led bodies' nodes."""
    out = []
    for body in ctx.rigid.values():
        if body.nodes and not body.free:
            nodes = np.unique(np.concatenate(body.nodes))
            out += [Prescribed(k, nodes, Motion(body, k), rigid=True) for k in (UX, UY, UZ)]
    return out
