"""<laugon>LAGMULT</laugon> of tied contact: nodes that follow the facets they are tied to exactly.

FEBio solves for the multipliers; here the tied displacements depend on others, which gives the same answer.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from febkit.model import Component
from febkit.solver.problem import Fixed, Prescribed, Step
from febkit.solver.ties import LinearConstraint

from .context import Context

if TYPE_CHECKING:
    from febkit.solver.contact.tied_node import TiedNode


def settle(ctx: Context, common: Step, steps: list[Step]) -> None:
    """u of each tied node = sum of N u of its facet, less the gap at rest."""
    for out, c, tie in ctx.bonded:
        if out is not common and out is not steps[0]:
            ctx.refuse(f'<laugon>LAGMULT</laugon> of <contact type="{c.type}"> in a later step', c.where)
        elif not ctx.refused:
            _bond(ctx, out, c, tie, [common, *steps])


def _bond(ctx: Context, out: Step, c: Component, tie: TiedNode, every: list[Step]) -> None:
    conditions = [q for s in every for q in s.conditions if isinstance(q, (Fixed, Prescribed))]
    held = {(int(n), q.column) for q in conditions for n in q.nodes}
    for node, facet, N, gap in tie.bonds(ctx.X):
        for i, column in enumerate(ctx.layout.displacement.tolist()):
            if (node, column) in held:
                label = ctx.model.mesh.node_ids[node]
                what = f'<laugon>LAGMULT</laugon> of <contact type="{c.type}"> at node {label}, which is held besides,'
                ctx.refuse(what, c.where)
                return
            columns = facet * 0 + column
            out.constraints.append(LinearConstraint(node, column, facet, columns, tuple(N.tolist()), -float(gap[i])))
