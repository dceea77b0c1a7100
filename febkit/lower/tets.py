"""<SolidDomain type="ut4-solid">: tetrahedra integrated at their nodes."""

from __future__ import annotations

from febkit.model import Domain, InputError
from febkit.solver import physics
from febkit.solver.problem import Block

from .context import Context


def nodal(ctx: Context, d: Domain, block: Block, mixture: bool) -> None:
    """Give a block of tet4 the physics of ut4-solid; refuse what a node between elements does not have."""
    what = f'<SolidDomain type="{d.type}">'
    if block.element != "tet4":
        raise InputError(f"{what} takes tet4, not {block.element}", d.where)
    if mixture:
        ctx.refuse(f"{what} of a mixture", d.where)
    if any(q.history for q in block.solid.walk()):
        ctx.refuse(f"{what} of a material with a memory", d.where)
    if block.axes is not None:
        ctx.refuse(f"{what} with local axes", d.where)
    alpha, isochoric = 0.05, False
    if d.spec is not None:
        ctx.check_tags(d.spec, {"alpha", "iso_stab"})
        alpha, isochoric = d.spec.float("alpha", alpha), d.spec.bool("iso_stab")
    block.physics = physics.load("ut4")(alpha, isochoric)
