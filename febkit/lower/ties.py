"""Springs of <Discrete>, <bc type="linear constraint"> and <constraint type="linear constraint">."""

from __future__ import annotations

from typing import Any

import numpy as np

from febkit.model import Component, InputError, Where
from febkit.model.sets import missing
from febkit.solver.loads import springs
from febkit.solver.problem import Step
from febkit.solver.ties import LinearConstraint

from .context import METHODS, Context
from .curves import curve

#: law of a discrete material -> class, and tags of numbers
LAWS: dict[str, tuple[Any, tuple[str, ...]]] = {
    "linear spring": (springs.LinearSprings, ("E",)),
    "tension-only linear spring": (springs.LinearSprings, ("E",)),
    "nonlinear spring": (springs.NonlinearSprings, ("scale",)),
    "experimental spring": (springs.ExperimentalSprings, ("E", "sM", "sm")),
    "torsion spring": (springs.TorsionSprings, ("r",)),
    "Hill": (springs.HillMuscles, ("Vmax", "ac", "Fmax", "Ksh", "Lmax")),
}
AUGMENTED = frozenset({"laugon", "tol", "penalty", "rhs", "minaug", "maxaug"})
MEASURES = {k: k for k in ("elongation", "strain", "stretch")} | {"0": "elongation", "1": "strain", "2": "stretch"}


def discrete(ctx: Context, out: Step) -> None:
    """Springs act in every step."""
    materials: dict[str, Component] = {}
    for c in ctx.model.discrete:
        if c.tag == "discrete_material":
            materials[str(c.id or len(materials) + 1)] = c
    for c in ctx.model.discrete:
        if c.tag == "discrete":
            _springs(ctx, out, c, materials)
        elif c.tag != "discrete_material":
            ctx.refuse(f"<{c.tag}> of <Discrete>", c.where)


def _springs(ctx: Context, out: Step, c: Component, materials: dict[str, Component]) -> None:
    name, number = c.attrs.get("discrete_set", ""), c.attrs.get("dmat", "")
    if name not in ctx.model.mesh.discrete_sets:
        raise missing("discrete set", name, ctx.model.mesh.discrete_sets, c.where)
    if number not in materials:
        raise missing("discrete material", number, materials, c.where)
    m = materials[number]
    pairs = np.asarray(ctx.model.mesh.discrete_sets[name].pairs, np.int64)
    made = _law(ctx, m, pairs, name)
    if made is not None:
        out.loads.append(made)


def _law(ctx: Context, m: Component, pairs: np.ndarray, name: str) -> springs.Springs | None:
    """Springs of a discrete material between pairs of nodes; None where it is refused."""
    x = ctx.X[pairs]
    lengths = np.linalg.norm(x[:, 1] - x[:, 0], axis=1)
    if m.type == "discrete composite":
        ctx.check_tags(m, {"name", "mat"})
        parts = [_law(ctx, q, pairs, name) for q in m.all("mat")]
        return springs.CompositeSprings(pairs, lengths, parts=tuple(p for p in parts if p is not None))
    if m.type not in LAWS:
        ctx.refuse(f'<{m.tag} type="{m.type}">', m.where)
        return None
    cls, numbers = LAWS[m.type]
    kw: dict[str, Any] = {t: ctx.value(m.child(t)) for t in numbers if m.child(t) is not None}
    known: set[str] = {"name", *numbers}
    if m.type == "tension-only linear spring":
        kw["tension_only"] = True
    if cls is springs.NonlinearSprings:
        known |= {"measure", "force"}
        kw["measure"] = m.choice("measure", MEASURES, "elongation")
        kw["force"] = curve(ctx, m.need("force"))
    elif cls is springs.HillMuscles:
        known |= {"L0", "Sv", "Ftl", "Fvl"}
        kw["L0"] = m.float("L0", 0.0)
        kw |= {t: curve(ctx, m.need(t)) for t in ("Sv", "Ftl", "Fvl") if m.child(t) is not None}
    ctx.check_tags(m, known)
    if (kw.get("measure") in ("strain", "stretch") or cls is springs.TorsionSprings) and not (lengths > 0).all():
        a, b = ctx.model.mesh.node_ids[pairs[int(np.argmin(lengths))]]
        what = kw.get("measure", "direction")
        raise InputError(f'{m.what}: nodes {a} and {b} of "{name}" are in one place: no {what}', m.where)
    return cls(pairs, lengths, **kw)  # type: ignore[no-any-return]


def _place(ctx: Context, node: int, dof: str, where: Where) -> tuple[int, int]:
    """Node and column of an unknown named by the node's id."""
    found = np.flatnonzero(ctx.model.mesh.node_ids == node)
    if not len(found):
        raise InputError(f"there is no node {node}", where)
    n, dof = int(found[0]), dof.strip()
    if dof in ("sx", "sy", "sz"):
        n, dof = int(ctx.back[n]), dof[1]
        if n < 0:
            raise InputError(f"node {node} belongs to no shell", where)
    if not ctx.layout.has(dof):
        raise InputError(f"a linear constraint cannot act on {dof!r}", where)
    return n, ctx.layout.column(dof)


def _end(ctx: Context, c: Component) -> tuple[int, int]:
    """The unknown that <node> and <dof> name."""
    return _place(ctx, c.need("node").as_id(), c.need("dof").text, c.need("node").where)


def condition(ctx: Context, out: Step, c: Component) -> None:
    """<bc type="linear constraint">: an unknown that is a sum of others."""
    ctx.check_tags(c, {"node", "dof", "offset", "child_dof"})
    node, column = _end(ctx, c)
    places, values = [], []
    for q in c:
        if q.tag == "child_dof":
            ctx.check_tags(q, {"node", "dof", "value"})
            places.append(_end(ctx, q))
            values.append(ctx.value(q.child("value"), 1.0))
    if not places:
        raise InputError(f'<{c.tag} type="{c.type}"> has no <child_dof>', c.where)
    nodes, columns = np.array(places).T
    out.constraints.append(LinearConstraint(node, column, nodes, columns, tuple(values), c.float("offset", 0.0)))


def check(ctx: Context, steps: list[tuple[Step, Step]]) -> None:
    """No unknown that depends on others may have others depend on it; nor may it be a rigid body's."""
    moved = ctx.layout.displacement.tolist()
    for common, step in steps:
        records = [*common.constraints, *step.constraints]
        tied = {(r.node, r.column) for r in records}
        carried = {(int(n), k) for s in (common, step) for a in s.attached for n in a.nodes for k in moved}
        for r in records:
            ends = set(zip(r.nodes.tolist(), r.columns.tolist()))
            if ends & tied or {*ends, (r.node, r.column)} & carried:
                label = ctx.model.mesh.node_ids[r.node] if r.node < len(ctx.model.mesh.X) else "at the back of a shell"
                ctx.refuse(f"a linear constraint (of node {label}) of unknowns that depend on others themselves")


def _term(ctx: Context, c: Component) -> tuple[int, int, float]:
    """Node, column and factor of one term of a sum."""
    if c.id is None:
        raise InputError('<node> of <linear_constraint> lacks the attribute id="..."', c.where)
    return (*_place(ctx, c.id, c.attrs.get("bc", ""), c.where), c.as_float())


def augmented(ctx: Context, c: Component) -> dict[str, Any]:
    """Options of a set of linear constraints."""
    method = c.choice("laugon", METHODS, 1)
    if method == 2:
        ctx.refuse(f'<laugon>LAGMULT</laugon> of <{c.tag} type="{c.type}">', c.need("laugon").where)
    return {
        "penalty": ctx.value(c.child("penalty"), 1.0), "tolerance": c.float("tol", 0.1), "rhs": c.float("rhs", 0.0),
        "minaug": c.int("minaug", 0), "maxaug": c.int("maxaug", 50), "laugon": method,
    }  # fmt: skip


def constraint(ctx: Context, out: Step, c: Component) -> None:
    """<constraint type="linear constraint">: sums of unknowns that vanish, by penalty or augmented Lagrangian."""
    ctx.check_tags(c, AUGMENTED | {"linear_constraint"})
    rows = [[_term(ctx, n) for n in q.all("node")] for q in c.all("linear_constraint")]
    width = max(map(len, rows), default=0)
    nodes, columns = (np.full((len(rows), width), k, np.int64) for k in (-1, 0))
    a = np.zeros((len(rows), width))
    for i, row in enumerate(rows):
        for j, (n, k, v) in enumerate(row):
            nodes[i, j], columns[i, j], a[i, j] = n, k, v
    out.loads.append(springs.ConstraintSet(nodes, columns, a, **augmented(ctx, c)))
