"""<Loads> to solver loads."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from febkit.model import Component, InputError, Surface
from febkit.model.sets import element_ids, node_indices, surface
from febkit.model.species import find, solutes
from febkit.solver import elements
from febkit.solver import loads as records
from febkit.solver.loads.base import Patch, patches

from .context import FACETS, Context

# tags of each surface load: numbers, vectors, flags
SURFACE: dict[str, tuple[tuple[str, ...], tuple[str, ...], tuple[str, ...]]] = {
    "pressure": (("pressure",), (), ("linear", "symmetric_stiffness")),
    "traction": (("scale",), ("traction",), ("linear",)),
    "force": (("scale",), ("force",), ()),
    "bearing load": (("scale",), ("force",), ("profile", "linear", "symmetric_stiffness")),
    "ideal gas pressure": (("P0",), (), ("symmetric_stiffness",)),
    "pressure Robin BC": (("spring_eps", "dashpot_eps"), (), ()),
    "traction Robin BC": (("spring_eps", "dashpot_eps"), (), ()),
    "normal_traction": (("traction",), (), ("linear", "effective", "symmetric_stiffness")),
    "fluidflux": (("flux",), (), ("linear", "mixture")),
    "soluteflux": (("flux",), (), ("linear",)),
    "solute natural flux": ((), (), ("update",)),
}
OF_A_SOLUTE = ("soluteflux", "solute natural flux")
PROFILE = {"sinusoidal": 0, "parabolic": 1, "0": 0, "1": 1}
FRAME = {"fixed": False, "moving": True, "0": False, "1": True}
NODAL = ("nodal_force", "nodal_load", "nodal fluidflux", "nodal_target_force")
BODY: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "const": (("x", "y", "z"), ()),
    "non-const": (("x", "y", "z"), ()),
    "body force": ((), ("force",)),
    "centrifugal": (("angular_speed",), ("rotation_axis", "rotation_center")),
    "axial force": (("scale", "p"), ("c", "axis")),
    "radial force": (("p", "sx", "sy", "sz"), ("c",)),
    "mass damping": (("C",), ()),
    "moving frame": (("wx", "wy", "wz", "ax", "ay", "az"), ()),
}


def loads(ctx: Context, specs: tuple[Component, ...]) -> tuple[list[Any], list[Any]]:
    """(surface and nodal loads, body loads)."""
    out: list[Any] = []
    body: list[Any] = []
    for c in specs:
        read = {"surface_load": _surface, "nodal_load": _nodal, "body_load": _body}.get(c.tag)
        if read is None or c.type is None or not records.known(c.type) or _unread(c):
            ctx.refuse(f'<{c.tag} type="{c.type}">', c.where)
            continue
        made = read(ctx, c)
        if made is not None:
            (body if c.tag == "body_load" else out).append(made)
    return out, body


def _unread(c: Component) -> bool:
    return c.type not in {"surface_load": SURFACE, "nodal_load": NODAL, "body_load": BODY}[c.tag]


def facets(ctx: Context, c: Component, rule: str | None = None) -> tuple[Patch, ...]:
    """The facets a load is on, with an integration rule or that of their kind."""
    name = c.attrs.get("surface", "")
    on = surface(ctx.model.mesh, name, c.where)
    conns = dict(on.facets)
    for kind in set(conns) - set(elements.FACETS):
        ctx.refuse(f"{c.what} on {kind} facets", c.where)
        del conns[kind]
    if c.bool("shell_bottom"):
        conns = ctx.bottoms(c, conns)
    return patches(conns, ctx.X, _order(on), dict.fromkeys(conns, rule) if rule else None)


def _order(on: Surface) -> dict[str, np.ndarray] | None:
    """Rows of the facets of each type in the file's order, where there are several types."""
    if len(on.facets) < 2 or any(len(on.ids.get(k, ())) != len(f) for k, f in on.facets.items()):
        return None
    rank = np.argsort(np.argsort(np.concatenate([on.ids[k] for k in on.facets]), kind="stable"))
    ends = np.cumsum([len(f) for f in on.facets.values()])
    return dict(zip(on.facets, np.split(rank, ends[:-1]), strict=True))


def _surface(ctx: Context, c: Component) -> Any:
    cls = records.load(c.type or "")
    numbers, vectors, flags = SURFACE[c.type or ""]
    solute = {"solute_id"} if c.type in OF_A_SOLUTE else set()
    ctx.check_tags(c, {*numbers, *vectors, *flags, *solute, "shell_bottom"})
    kw: dict[str, Any] = {}
    for n in numbers:
        leaf = c.child(n)
        if leaf is not None:
            kw[n] = ctx.value(leaf, maps=FACETS + c.attrs.get("surface", ""))
    for n in vectors:
        leaf = c.child(n)
        if leaf is not None:
            kw[n] = ctx.vector(leaf)
    for n in flags:
        leaf = c.child(n)
        if leaf is not None:
            kw[n] = leaf.as_choice(PROFILE) if n == "profile" else leaf.as_bool()
    if solute:
        leaf = c.need("solute_id")
        kw["solute"] = find(solutes(ctx.model), leaf.text.strip(), "solute", leaf.where).index + 1
    if c.type == "solute natural flux":
        kw["owner"] = _solute_owners(ctx, c, kw["solute"])
        if c.bool("update") or c.bool("shell_bottom"):
            tag = "update" if c.bool("update") else "shell_bottom"
            ctx.refuse(f'<{tag}> of <surface_load type="{c.type}">', c.need(tag).where)
    fields = cls.__dataclass_fields__
    kw["shell_bottom"] = c.bool("shell_bottom")
    return cls(facets(ctx, c), **{k: v for k, v in kw.items() if k in fields})


def _solute_owners(ctx: Context, c: Component, solute: int) -> tuple[np.ndarray, ...]:
    """The elements behind the facets of a load, which must be solids that hold a solute."""
    from .contact import behind

    found = behind(ctx, c, dict(surface(ctx.model.mesh, c.attrs.get("surface", ""), c.where).facets))
    if ctx.refused:
        return ()
    dof = f"c{solute}"
    for owner in found.values():
        for number in np.unique(owner[:, 0]).tolist():
            b = ctx.made[number]
            if not any(dof in f.components for f in b.physics.fields) or b.element.startswith("shell_"):
                raise InputError(f'{c.what}: part "{b.name}" behind its surface is no solid with this solute', c.where)
    return tuple(owner for owner in found.values() if len(owner))


def _nodal(ctx: Context, c: Component) -> Any:
    ref = c.attrs.get("node_set", "")
    nodes = node_indices(ctx.model.mesh, ref, c.where)
    if c.bool("shell_bottom"):
        nodes = _backs(ctx, c, nodes)
    X = ctx.X[nodes]
    cls = records.load(c.type or "")
    relative = c.bool("relative")
    readers: dict[str, Callable[[], Any]] = {
        "nodal_force": lambda: cls(nodes, X, relative=relative, value=ctx.vector(c.need("value"))),
        "nodal_load": lambda: _dof_load(ctx, c, nodes, X, relative),
        "nodal fluidflux": lambda: cls(nodes, X, value=ctx.value(c.need("value"), maps=ref)),
        "nodal_target_force": lambda: cls(
            nodes, X, force=ctx.vector(c.need("force")), scale=ctx.value(c.child("scale"), 1.0)
        ),
    }
    ctx.check_tags(c, {"value", "relative", "dof", "scale", "force", "shell_bottom"})
    return readers[c.type or ""]()


def _backs(ctx: Context, c: Component, nodes: np.ndarray) -> np.ndarray:
    """Back nodes of a load on the back faces of shells."""
    back = ctx.back[nodes]
    if (back < 0).any():
        node = ctx.model.mesh.node_ids[nodes[int(np.argmax(back < 0))]]
        raise InputError(f"{c.what} is on the back of shells; node {node} is in none", c.where)
    return np.asarray(back)


def _dof_load(ctx: Context, c: Component, nodes: np.ndarray, X: np.ndarray, relative: bool) -> Any:
    dof = c.need("dof").text.strip()
    leaf, ref = c.child("scale") or c.need("value"), c.attrs.get("node_set", "")
    if dof in ("sx", "sy", "sz", "q") or (dof[:1] == "d" and ctx.layout.has("c" + dof[1:])):
        nodes, dof = _backs(ctx, c, nodes), "c" + dof[1:] if dof[0] == "d" else dof[1:] or "p"
        X = ctx.X[nodes]
    if dof == "p":  # FEBio multiplies loads on the pressure by the step size
        return records.load("nodal fluidflux")(nodes, X, value=ctx.value(leaf, maps=ref))
    rate = {}
    if ctx.layout.has(dof) and ctx.layout.column(dof) in ctx.layout.concentrations:
        rate = {"rate": dof == "c1"}
    elif dof not in ("x", "y", "z") and not (dof in ("u", "v", "w") and ctx.layout.turns):
        ctx.refuse(f"a nodal load on {dof}", c.where)
        dof = "x"
    cls = records.load("nodal_load")
    return cls(nodes, X, relative=relative, dof=dof, scale=ctx.value(leaf, maps=ref), **rate)


def _body(ctx: Context, c: Component) -> Any:
    cls = records.load(c.type or "")
    numbers, vectors = BODY[c.type or ""]
    ctx.check_tags(c, {*numbers, *vectors, *({"frame"} if c.type == "moving frame" else ())})
    kw: dict[str, Any] = {n: ctx.value(c.need(n)) for n in numbers if c.child(n) is not None}
    if c.type == "moving frame":
        kw["moving"] = c.choice("frame", FRAME, False)
    for n in vectors:
        leaf = c.child(n)
        if leaf is not None:
            kw["given" if n == "force" else n] = ctx.vector(leaf)
    where = c.attrs.get("elem_set") or ""
    if where:
        ids = element_ids(ctx.model.mesh, where, c.where)
        named = {d.block for d in ctx.model.domains if d.kind in ("solid", "beam")}
        rows = {n: np.flatnonzero(np.isin(ctx.blocks[n].ids, ids)) for n in named if n in ctx.blocks}
        rows = {n: r for n, r in rows.items() if len(r)}
        kw["blocks"], kw["elements"] = tuple(rows), rows
    return cls(**kw)
