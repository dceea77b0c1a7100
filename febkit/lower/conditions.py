"""<Boundary> and <Initial> to solver conditions."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import numpy as np

from febkit.model import Component, InputError, species
from febkit.model.sets import node_indices, surface
from febkit.solver.problem import Fixed, Initial, Prescribed
from febkit.solver.values import Map

from . import deformations
from .context import FACETS, Context

if TYPE_CHECKING:
    from febkit.solver.loads.base import Patch

#: the scalar degrees of freedom of the back faces of shells, and the same of the front
FRONT = {"q": "p", **{f"d{k}": f"c{k}" for k in range(1, 9)}}


def conditions(ctx: Context, specs: tuple[Component, ...]) -> list[Fixed | Prescribed]:
    """Boundary conditions in file order."""
    out: list[Fixed | Prescribed] = []
    for c in specs:
        if c.type in ("rigid", "linear constraint"):  # read by rigid.fill and ties.condition
            continue
        make = READERS.get(c.type or "") or OLD.get(c.type or "")
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


def _zero_rotation(ctx: Context, c: Component) -> list[Fixed | Prescribed]:
    ctx.check_tags(c, {"u_dof", "v_dof", "w_dof"})
    nodes = _nodes(ctx, c)
    return [Fixed(ctx.column(q, c), nodes) for q in "uvw" if c.bool(f"{q}_dof")] if ctx.layout.turns else []


def _prescribed_rotation(ctx: Context, c: Component) -> list[Fixed | Prescribed]:
    dof = c.need("dof").as_choice({q: q for q in "uvw"})
    return _prescribed(ctx, c, ctx.column(dof, c)) if ctx.layout.turns else []


def _zero_pressure(ctx: Context, c: Component) -> list[Fixed | Prescribed]:
    ctx.check_tags(c, set())
    return [Fixed(ctx.column("p", c), _nodes(ctx, c))] if ctx.layout.has("p") else []


def _prescribed(ctx: Context, c: Component, column: int, back: bool = False) -> list[Fixed | Prescribed]:
    """``back``: the degree of freedom is one of the back faces of shells."""
    ctx.check_tags(c, {"dof", "value", "relative"})
    value = ctx.value(c.child("value"), 0.0, "" if back else c.attrs.get("node_set", ""))
    return [Prescribed(column, (_back if back else _nodes)(ctx, c), value, c.bool("relative"))]


def _back(ctx: Context, c: Component) -> np.ndarray:
    """Back nodes of a condition on the back faces of shells."""
    back = ctx.back[_nodes(ctx, c)]
    return np.asarray(back[back >= 0])


def _zero_shell(ctx: Context, c: Component) -> list[Fixed | Prescribed]:
    ctx.check_tags(c, {"sx_dof", "sy_dof", "sz_dof"})
    nodes = _back(ctx, c)
    return [Fixed(ctx.column(axis, c), nodes) for axis in "xyz" if c.bool(f"s{axis}_dof")]


def _prescribed_shell(ctx: Context, c: Component) -> list[Fixed | Prescribed]:
    column = ctx.column(c.need("dof").as_choice({f"s{axis}": axis for axis in "xyz"}), c)
    return _prescribed(ctx, c, column, back=True)


def _prescribed_shell_pressure(ctx: Context, c: Component) -> list[Fixed | Prescribed]:
    return _prescribed(ctx, c, ctx.column("p", c), back=True)


def _prescribed_displacement(ctx: Context, c: Component) -> list[Fixed | Prescribed]:
    return _prescribed(ctx, c, ctx.column(c.need("dof").as_choice({axis: axis for axis in "xyz"}), c))


def _prescribed_pressure(ctx: Context, c: Component) -> list[Fixed | Prescribed]:
    return _prescribed(ctx, c, ctx.column("p", c))


def _concentration(ctx: Context, c: Component, leaf: Component, back: bool = False) -> int:
    """Column of a concentration by FEBio's name of it, "c1" (at the back of shells: "d1"), or by that of its solute."""
    dof = leaf.text.strip()
    dof = FRONT.get(dof, dof) if back else dof
    return ctx.column(dof if ctx.layout.has(dof) else species.dof(ctx.model, dof), c)


def _of_shells(ctx: Context, c: Component, dof: str) -> int:
    """Column of a degree of freedom of the back faces of shells, q or d1, d2, ..."""
    if dof not in FRONT:
        raise InputError(f'{c.what} knows the degrees of freedom {", ".join(FRONT)}, not "{dof}"', c.where)
    return ctx.column(FRONT[dof], c)


def _fix(ctx: Context, c: Component) -> list[Fixed | Prescribed]:
    """Versions before 4.0 fix q and d by this type; it stays, for 4.0 has none for them."""
    ctx.check_tags(c, {"dofs"})
    words = c.need("dofs").text.replace(",", " ").split()
    unknown = next((w for w in words if not re.fullmatch(r"s?[xyz]|[uvwpqT]|[cd]\d+|[wg][xyz]|ef", w)), None)
    if unknown is not None:  # FEBio 4.11 takes what is before it, and says nothing
        raise InputError(f'{c.what}: there is no degree of freedom "{unknown}"; leave it out', c.where)
    return [Fixed(_of_shells(ctx, c, d), _back(ctx, c)) for d in words]


def _prescribe(ctx: Context, c: Component) -> list[Fixed | Prescribed]:
    """Versions before 4.0 prescribe d by this type, ``scale`` being its value; it stays, for 4.0 has none for it."""
    ctx.check_tags(c, {"dof", "scale", "relative"})
    value = ctx.value(c.child("scale"), 1.0)
    return [Prescribed(_of_shells(ctx, c, c.need("dof").text.strip()), _back(ctx, c), value, c.bool("relative"))]


def _zero_concentration(ctx: Context, c: Component) -> list[Fixed | Prescribed]:
    ctx.check_tags(c, {"c_dof"})
    return [Fixed(_concentration(ctx, c, c.need("c_dof")), _nodes(ctx, c))]


def _prescribed_concentration(ctx: Context, c: Component) -> list[Fixed | Prescribed]:
    return _prescribed(ctx, c, _concentration(ctx, c, c.need("dof")))


def _following(ctx: Context, c: Component) -> tuple[np.ndarray, tuple[tuple[Patch, np.ndarray], ...]]:
    """Nodes of a surface, and its facets with the elements behind them."""
    from febkit.solver.loads.base import patches

    from .contact import behind

    conns = {k: v for k, v in surface(ctx.model.mesh, c.attrs.get("surface", ""), c.where).facets.items() if len(v)}
    owners = behind(ctx, c, conns)
    if c.bool("shell_bottom"):
        conns = ctx.bottoms(c, conns)
    nodes = np.unique(np.concatenate([v.ravel() for v in conns.values()]))
    return nodes, tuple(zip(patches(conns, ctx.X), (owners[k] for k in conns), strict=True))


def _actual_pressure(ctx: Context, c: Component) -> list[Fixed | Prescribed]:
    ctx.check_tags(c, {"pressure", "shell_bottom"})
    from febkit.solver.following import ActualPressure, ElementPressure

    value = ctx.value(c.child("pressure"), 0.0, FACETS + c.attrs.get("surface", ""))
    nodes, facets = _following(ctx, c)
    if c.type == "actual fluid pressure":
        return [ActualPressure(ctx.column("p", c), nodes, value, surface=facets)]
    R, T = (ctx.model.constants.get(k, 0.0) for k in "RT")
    share = int(R) * int(T) / (R * T) if R * T else 0.0
    return [ElementPressure(ctx.column("p", c), nodes, value, surface=facets, share=share)]


def _matching_osmotic(ctx: Context, c: Component) -> list[Fixed | Prescribed]:
    ctx.check_tags(c, {"ambient_pressure", "ambient_osmolarity", "shell_bottom"})
    from febkit.solver.following import MatchingOsmotic

    p, o = (ctx.value(c.child(f"ambient_{n}"), 0.0) for n in ("pressure", "osmolarity"))
    nodes, facets = _following(ctx, c)
    return [MatchingOsmotic(ctx.column("p", c), nodes, p, osmolarity=o, surface=facets)]


READERS = {
    "actual fluid pressure": _actual_pressure,
    "fluid pressure": _actual_pressure,
    "matching_osm_coef": _matching_osmotic,
    "zero displacement": _zero_displacement,
    "prescribed displacement": _prescribed_displacement,
    "zero rotation": _zero_rotation,
    "prescribed rotation": _prescribed_rotation,
    "zero shell displacement": _zero_shell,
    "prescribed shell displacement": _prescribed_shell,
    "zero fluid pressure": _zero_pressure,
    "prescribed fluid pressure": _prescribed_pressure,
    "prescribed shell fluid pressure": _prescribed_shell_pressure,
    "prescribed deformation": deformations.deformation,
    "prescribed deformation 2O": deformations.second_order,
    "normal displacement": deformations.normal,
    "rigid deformation": deformations.rigid,
    "zero concentration": _zero_concentration,
    "prescribed concentration": _prescribed_concentration,
}
AS_LOADS = ("matching_osm_coef", "fluid pressure")  # conditions that are loads in version 3.0
OLD = {"fix": _fix, "prescribe": _prescribe}  # of which version 4.0 has no other


def initial(ctx: Context, specs: tuple[Component, ...]) -> list[Initial]:
    """Initial conditions in file order."""
    out: list[Initial] = []
    for c in specs:
        kind = c.type or ""
        if kind in ("displacement", "velocity"):
            v = ctx.vector(c.need("value"))
            nodes, rate = _nodes(ctx, c), kind == "velocity"
            out += [Initial(ctx.column(axis, c), nodes, x, velocity=rate) for axis, x in zip("xyz", v)]
        elif kind == "shell velocity":
            ctx.check_tags(c, {"value"})
            pairs = zip("xyz", ctx.vector(c.need("value")), strict=True)
            out += [Initial(ctx.column(axis, c), _back(ctx, c), x, velocity=True) for axis, x in pairs]
        elif kind == "rigid kinematics":
            out += _rigid_motion(ctx, c)
        elif kind in ("init_pressure", "initial fluid pressure", "effective fluid pressure"):
            out.append(Initial(ctx.column("p", c), _nodes(ctx, c), ctx.value(c.child("value"), 0.0)))
        elif kind == "initial shell fluid pressure":
            out.append(Initial(ctx.column("p", c), _back(ctx, c), ctx.value(c.child("value"), 0.0)))
        elif kind == "initial shell concentration":
            column = _concentration(ctx, c, c.need("dof"), back=True)
            out.append(Initial(column, _back(ctx, c), ctx.value(c.child("value"), 0.0)))
        elif kind == "initial concentration" or (kind == "init_dof" and c.need("dof").text.strip().startswith("c")):
            column = _concentration(ctx, c, c.need("dof"))
            out.append(Initial(column, _nodes(ctx, c), ctx.value(c.child("value"), 0.0)))
        elif kind == "init_dof":
            column = ctx.column(c.need("dof").as_choice({dof: dof for dof in "xyzp"}), c)
            out.append(Initial(column, _nodes(ctx, c), ctx.value(c.child("value"), 0.0)))
        else:
            ctx.refuse(f'<{c.tag} type="{c.type}">', c.where)
    return out


def _rigid_motion(ctx: Context, c: Component) -> list[Initial]:
    """Velocities v + w x (X - c) of the nodes of a set."""
    ctx.check_tags(c, {"velocity", "angular_velocity", "center_of_rotation"})
    given = (c.child(tag) for tag in ("velocity", "angular_velocity", "center_of_rotation"))
    v, w, centre = (np.zeros(3) if leaf is None else np.array(leaf.as_floats(3)) for leaf in given)
    nodes = _nodes(ctx, c)
    rates = v + np.cross(w, ctx.X[nodes] - centre)
    return [Initial(ctx.column(axis, c), nodes, Map(rates[:, k]), velocity=True) for k, axis in enumerate("xyz")]
