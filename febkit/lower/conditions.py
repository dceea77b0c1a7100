"""<Boundary> and <Initial> to solver conditions."""

from __future__ import annotations

import numpy as np

from febkit.model import Component, InputError, species
from febkit.model.sets import node_indices, surface
from febkit.solver.following import ActualPressure, MatchingOsmotic
from febkit.solver.loads.base import Patch, patches
from febkit.solver.problem import Fixed, Initial, Prescribed

from . import deformations
from .context import FACETS, Context


def conditions(ctx: Context, specs: tuple[Component, ...]) -> list[Fixed | Prescribed]:
    """Boundary conditions in file order."""
    out: list[Fixed | Prescribed] = []
    for c in specs:
        if c.type in ("rigid", "linear constraint"):  # read by rigid.fill and ties.condition
            continue
        make = READERS.get(c.type or "")
        if make is None:
            ctx.refuse(f'<{c.tag} type="{c.type}">', c.where)
        else:
            out += make(ctx, c)
    return out


def _nodes(ctx: Context, c: Component) -> np.ndarray:
    ref = c.attrs.get("node_set") or c.attrs.get("surface")
    if not ref:
        raise InputError(f'<{c.tag} type="{c.type}"> names no node_set', c.where)
    return np.unique(node_indices(ctx.model.mesh, ref, c.where)) if "surface" in c.attrs else node_indices(
        ctx.model.mesh, ref, c.where
    )


def _zero_displacement(ctx: Context, c: Component) -> list[Fixed | Prescribed]:
    ctx.check_tags(c, {"x_dof", "y_dof", "z_dof"})
    nodes = _nodes(ctx, c)
    return [Fixed(ctx.column(axis, c), nodes) for axis in "xyz" if c.bool(f"{axis}_dof")]


def _zero_pressure(ctx: Context, c: Component) -> list[Fixed | Prescribed]:
    ctx.check_tags(c, set())
    return [Fixed(ctx.column("p", c), _nodes(ctx, c))] if ctx.layout.has("p") else []


def _prescribed(ctx: Context, c: Component, column: int) -> list[Fixed | Prescribed]:
    ctx.check_tags(c, {"dof", "value", "relative"})
    nodes = _nodes(ctx, c)
    value = ctx.value(c.child("value"), 0.0, c.attrs.get("node_set", ""))
    return [Prescribed(column, nodes, value, c.bool("relative"))]


def _back(ctx: Context, c: Component) -> np.ndarray:
    """Back nodes of a condition on shell displacements."""
    back = ctx.back[_nodes(ctx, c)]
    return np.asarray(back[back >= 0])


def _zero_shell(ctx: Context, c: Component) -> list[Fixed | Prescribed]:
    ctx.check_tags(c, {"sx_dof", "sy_dof", "sz_dof"})
    nodes = _back(ctx, c)
    return [Fixed(ctx.column(axis, c), nodes) for axis in "xyz" if c.bool(f"s{axis}_dof")]


def _prescribed_shell(ctx: Context, c: Component) -> list[Fixed | Prescribed]:
    ctx.check_tags(c, {"dof", "value", "relative"})
    column = ctx.column(c.need("dof").as_choice({f"s{axis}": axis for axis in "xyz"}), c)
    nodes = _back(ctx, c)
    return [Prescribed(column, nodes, ctx.value(c.child("value"), 0.0), c.bool("relative"))]


def _prescribed_displacement(ctx: Context, c: Component) -> list[Fixed | Prescribed]:
    return _prescribed(ctx, c, ctx.column(c.need("dof").as_choice({axis: axis for axis in "xyz"}), c))


def _prescribed_pressure(ctx: Context, c: Component) -> list[Fixed | Prescribed]:
    return _prescribed(ctx, c, ctx.column("p", c))


def _concentration(ctx: Context, c: Component, leaf: Component) -> int:
    """Column of a concentration by FEBio's name of it, "c1", or by the name of its solute."""
    dof = leaf.text.strip()
    return ctx.column(dof if ctx.layout.has(dof) else species.dof(ctx.model, dof), c)


def _zero_concentration(ctx: Context, c: Component) -> list[Fixed | Prescribed]:
    ctx.check_tags(c, {"c_dof"})
    return [Fixed(_concentration(ctx, c, c.need("c_dof")), _nodes(ctx, c))]


def _prescribed_concentration(ctx: Context, c: Component) -> list[Fixed | Prescribed]:
    return _prescribed(ctx, c, _concentration(ctx, c, c.need("dof")))


def _following(ctx: Context, c: Component) -> tuple[np.ndarray, tuple[tuple[Patch, np.ndarray], ...]]:
    """Nodes of a surface, and its facets with the elements behind them."""
    from .contact import behind

    if c.bool("shell_bottom"):
        ctx.refuse(f'<shell_bottom> of <{c.tag} type="{c.type}">', c.need("shell_bottom").where)
    conns = {k: v for k, v in surface(ctx.model.mesh, c.attrs.get("surface", ""), c.where).facets.items() if len(v)}
    owners = behind(ctx, c, conns)
    nodes = np.unique(np.concatenate([v.ravel() for v in conns.values()]))
    return nodes, tuple(zip(patches(conns, ctx.X), (owners[k] for k in conns), strict=True))


def _actual_pressure(ctx: Context, c: Component) -> list[Fixed | Prescribed]:
    ctx.check_tags(c, {"pressure", "shell_bottom"})
    value = ctx.value(c.child("pressure"), 0.0, FACETS + c.attrs.get("surface", ""))
    nodes, facets = _following(ctx, c)
    return [ActualPressure(ctx.column("p", c), nodes, value, surface=facets)]


def _matching_osmotic(ctx: Context, c: Component) -> list[Fixed | Prescribed]:
    ctx.check_tags(c, {"ambient_pressure", "ambient_osmolarity", "shell_bottom"})
    p, o = (ctx.value(c.child(f"ambient_{n}"), 0.0) for n in ("pressure", "osmolarity"))
    nodes, facets = _following(ctx, c)
    return [MatchingOsmotic(ctx.column("p", c), nodes, p, osmolarity=o, surface=facets)]


READERS = {
    "actual fluid pressure": _actual_pressure,
    "matching_osm_coef": _matching_osmotic,
    "zero displacement": _zero_displacement,
    "prescribed displacement": _prescribed_displacement,
    "zero shell displacement": _zero_shell,
    "prescribed shell displacement": _prescribed_shell,
    "zero fluid pressure": _zero_pressure,
    "prescribed fluid pressure": _prescribed_pressure,
    "prescribed deformation": deformations.deformation,
    "prescribed deformation 2O": deformations.second_order,
    "normal displacement": deformations.normal,
    "rigid deformation": deformations.rigid,
    "zero concentration": _zero_concentration,
    "prescribed concentration": _prescribed_concentration,
}


def initial(ctx: Context, specs: tuple[Component, ...]) -> list[Initial]:
    """Initial conditions in file order."""
    out: list[Initial] = []
    for c in specs:
        kind = c.type or ""
        if kind in ("displacement", "velocity"):
            v = ctx.vector(c.need("value"))
            nodes, rate = _nodes(ctx, c), kind == "velocity"
            out += [Initial(ctx.column(axis, c), nodes, x, velocity=rate) for axis, x in zip("xyz", v)]
        elif kind in ("init_pressure", "initial fluid pressure", "effective fluid pressure"):
            out.append(Initial(ctx.column("p", c), _nodes(ctx, c), ctx.value(c.child("value"), 0.0)))
        elif kind == "initial concentration" or (kind == "init_dof" and c.need("dof").text.strip().startswith("c")):
            column = _concentration(ctx, c, c.need("dof"))
            out.append(Initial(column, _nodes(ctx, c), ctx.value(c.child("value"), 0.0)))
        elif kind == "init_dof":
            column = ctx.column(c.need("dof").as_choice({dof: dof for dof in "xyzp"}), c)
            out.append(Initial(column, _nodes(ctx, c), ctx.value(c.child("value"), 0.0)))
        else:
            ctx.refuse(f'<{c.tag} type="{c.type}">', c.where)
    return out
