"""<constraint type="rigid_wall">: a plane that the nodes of a surface may not pass."""

from __future__ import annotations

from febkit.model import Component, InputError
from febkit.solver.elements import nodal
from febkit.solver.loads.rigid_wall import RigidWall
from febkit.solver.problem import Step
from febkit.solver.values import Constant

from .context import Context
from .loads import facets

METHODS = {"penalty": 0, "auglag": 1, "0": 0, "1": 1}


def constraint(ctx: Context, out: Step, c: Component) -> None:
    """The wall n . x = d of <plane>nx,ny,nz,d</plane>, moved along n by <offset>."""
    ctx.check_tags(c, {"laugon", "tolerance", "penalty", "offset", "plane"})
    plane = c.need("plane")
    a, b, e, d = ctx.components(plane, 4)
    if all(isinstance(v, Constant) and v.number == 0.0 for v in (a, b, e)):
        raise InputError("<plane> has no normal: its first three numbers are 0", plane.where)
    on = facets(ctx, c)
    for kind in {p.element.name for p in on} - set(nodal.WEIGHTS):
        ctx.refuse(f'<constraint type="rigid_wall"> on {kind} facets', c.where)
    out.loads.append(RigidWall(
        on, (a, b, e, d), ctx.value(c.child("penalty"), 0.0), ctx.value(c.child("offset"), 0.0),
        c.float("tolerance", 0.0), c.choice("laugon", METHODS, 0),
    ))  # fmt: skip
