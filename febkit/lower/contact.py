"""<Contact> to the solver's contacts."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from febkit.model import Component, InputError
from febkit.model.elements import corners
from febkit.model.sets import missing, surface
from febkit.model.species import find, solutes
from febkit.solver import contact as records
from febkit.solver import elements
from febkit.solver.elements import nodal
from febkit.solver.fields import concentration
from febkit.solver.problem import Step

from . import shells
from .context import METHODS, Context

Reader = Callable[[Context, Component], Any]


def _laugon(ctx: Context, leaf: Component) -> bool:
    return leaf.as_choice(METHODS) == 1


RULES = {"default": False, "higher-order": True, "0": False, "1": True}
NUMBER: Reader = lambda ctx, leaf: leaf.as_float()  # noqa: E731
WHOLE: Reader = lambda ctx, leaf: leaf.as_int()  # noqa: E731
FLAG: Reader = lambda ctx, leaf: leaf.as_bool()  # noqa: E731
CURVE: Reader = lambda ctx, leaf: ctx.value(leaf)  # noqa: E731

COMMON: dict[str, Reader] = {
    "laugon": _laugon, "tolerance": NUMBER, "penalty": CURVE, "minaug": WHOLE, "maxaug": WHOLE,
}  # fmt: skip
NORMAL: dict[str, Reader] = {
    **COMMON, "gaptol": NUMBER, "auto_penalty": FLAG, "two_pass": FLAG, "knmult": NUMBER, "search_tol": NUMBER,
    "search_radius": NUMBER,
}  # fmt: skip
SLIDING: dict[str, Reader] = {**NORMAL, "knmult": WHOLE, "seg_up": WHOLE, "smooth_aug": FLAG}
FLUID: dict[str, Reader] = {"ptol": NUMBER, "pressure_penalty": NUMBER}
FLUX: dict[str, Reader] = {**FLUID, "ctol": NUMBER, "concentration_penalty": NUMBER}
OF_MIXTURES = ("tied-multiphasic", "sliding-biphasic-solute", "sliding-multiphasic")
PARAMETERS: dict[str, dict[str, Reader]] = {
    "tied-node-on-facet": {**COMMON, "search_tolerance": NUMBER, "max_distance": NUMBER, "special": FLAG},
    "sticky": {
        **COMMON, "search_tolerance": NUMBER, "max_traction": NUMBER, "snap_tol": NUMBER, "gap_offset": NUMBER,
    },
    "contact potential": {
        "kc": CURVE, "p": NUMBER, "R_in": NUMBER, "R_out": NUMBER, "R0_min": NUMBER, "w_tol": NUMBER,
    },
    "tied-facet-on-facet": {**COMMON, "search_tolerance": NUMBER, "gap_offset": FLAG},
    "tied-elastic": {**NORMAL, "symmetric_stiffness": FLAG},
    "tied-biphasic": {**NORMAL, "symmetric_stiffness": FLAG, **FLUID},
    "tied-multiphasic": {**NORMAL, "symmetric_stiffness": FLAG, **FLUX},
    "sliding-elastic": {**SLIDING, "tension": FLAG, "offset": NUMBER},
    "sliding-biphasic": {**SLIDING, **FLUID},
    "sliding-biphasic-solute": {**SLIDING, **FLUX},
    "sliding-multiphasic": {**SLIDING, **FLUX},
    "sliding-node-on-facet": {**NORMAL, "seg_up": WHOLE},
    "sliding-facet-on-facet": {**NORMAL, "seg_up": WHOLE},
}
# what counts with friction alone
WETS: dict[str, Reader] = {"contact_frac": NUMBER, "smooth_fls": FLAG}
BESIDES = {"sliding-node-on-facet": {"fric_penalty": NUMBER}, "sliding-biphasic": WETS, "sliding-multiphasic": WETS}
# materials whose fluid and solutes do not pass a contact in FEBio, and the contact that lets them pass
DENSE: dict[str, tuple[frozenset[str], str]] = {
    "tied-biphasic": (frozenset({"biphasic-solute", "triphasic", "multiphasic"}), "tied-multiphasic"),
    "sliding-biphasic": (frozenset({"biphasic-solute", "triphasic", "multiphasic"}), "sliding-multiphasic"),
    "sliding-biphasic-solute": (frozenset({"triphasic", "multiphasic"}), "sliding-multiphasic"),
}
# parameters that change nothing where they are 0, and are refused where they are not
UNUSED = frozenset({"node_reloc", "smooth_aug", "check_intersections"})
# what is read elsewhere, or has no effect: penalties of bodies at rest need no update, and without friction its
# parameters say nothing
READ = frozenset({
    "update_penalty", "flip_primary", "flip_secondary", "shell_bottom_primary", "shell_bottom_secondary",
    "offset_shells", "symmetric_stiffness", "fric_penalty", "ktmult", "contact_frac", "smooth_fls",
})  # fmt: skip


def contacts(ctx: Context, out: Step, specs: tuple[Component, ...]) -> None:
    """Contacts of a step, in file order."""
    for c in specs:
        if c.tag != "contact" or c.type not in PARAMETERS or not records.known(c.type):
            ctx.refuse(f'<{c.tag} type="{c.type}">', c.where)
            continue
        if ("biphasic" in c.type or c.type in OF_MIXTURES) and not ctx.layout.has("p"):
            ctx.refuse(f'<{c.tag} type="{c.type}"> in a model without fluid', c.where)
            continue
        made = _contact(ctx, c)
        if c.type == "contact potential" or c.choice("laugon", METHODS, 0) != 2:
            out.contacts.append(made)
        elif c.type == "tied-node-on-facet" and not c.bool("offset_shells"):
            ctx.bonded.append((out, c, made))
        else:  # FEBio has no other contact by multipliers
            ctx.refuse(f'<laugon>LAGMULT</laugon> of <contact type="{c.type}">', c.need("laugon").where)


def _contact(ctx: Context, c: Component) -> Any:
    table = PARAMETERS[c.type or ""]
    slides = c.type in ("sliding-biphasic-solute", "sliding-multiphasic")
    ambient = {"ambient_pressure", "ambient_concentration"} if slides else set()
    known = set(table) | UNUSED | READ | {"fric_coeff"} | ambient
    if c.type == "contact potential":
        known |= {"laugon", "integration_rule"}  # the first has no effect in FEBio either
    ctx.check_tags(c, known)
    kw: dict[str, Any] = {}
    for leaf in c:
        if leaf.tag in UNUSED and leaf.tag not in table and leaf.as_bool():
            ctx.refuse(f'<{leaf.tag}> of <contact type="{c.type}">', leaf.where)
        if leaf.tag in table:
            kw[leaf.tag] = table[leaf.tag](ctx, leaf)
    friction = _friction(ctx, c)
    if friction:
        kw["fric_coeff"] = friction
        kw |= {tag: read(ctx, c.need(tag)) for tag, read in BESIDES.get(c.type or "", {}).items() if c.child(tag)}
    offset = c.bool("offset_shells") or c.type == "sliding-node-on-facet"
    first, second = _pair(ctx, c)
    needs = any(kw.get(tag) for tag in ("auto_penalty", "smooth_aug")) or "biphasic" in (c.type or "")
    needs = needs or c.type in OF_MIXTURES
    if c.type in OF_MIXTURES:
        kw["RT"] = ctx.model.constants.get("R", 0.0) * ctx.model.constants.get("T", 0.0)
        if c.type != "sliding-biphasic-solute" and kw.get("auto_penalty") and c.bool("update_penalty"):
            # FEBio's penalties of mixtures follow their state where they are updated
            ctx.refuse(f'<update_penalty> of <contact type="{c.type}">', c.need("update_penalty").where)
    if slides:
        kw["ambient_concentration"] = _ambient(ctx, c)
        kw["ambient_pressure"] = ctx.value(c.child("ambient_pressure"), 0.0)
    kw["names"] = first, second
    kw["primary"] = _facets(ctx, c, first, "primary", needs, offset)
    kw["secondary"] = _facets(ctx, c, second, "secondary", needs, offset)
    _check_owners(ctx, c, (kw["primary"], kw["secondary"]))
    return records.load(c.type or "", bool(friction))(**kw)


def _ambient(ctx: Context, c: Component) -> dict[str, Any]:
    """Concentrations around surfaces that touch nothing, by nodal field: one for all solutes, or by name."""
    every = solutes(ctx.model)
    out: dict[str, Any] = {}
    for leaf in c.all("ambient_concentration"):
        given = [find(every, leaf.attrs["sol"], "solute", leaf.where)] if leaf.attrs.get("sol") else every
        out |= {concentration(s.index + 1).name: ctx.value(leaf) for s in given}
    return out


def _check_owners(ctx: Context, c: Component, sides: tuple[Any, Any]) -> None:
    """Refuse materials that FEBio would take for impermeable here."""
    if c.type not in DENSE or ctx.refused:
        return
    dense, other = DENSE[c.type]
    types = {m.name: m.type for m in ctx.model.materials}
    behind = {int(b) for side in sides for owner in side.owner.values() for b in owner[:, 0]}
    for d in ctx.model.domains:
        if ctx.numbers.get(d.block) in behind and types.get(d.material) in dense:
            name = types[d.material]
            ctx.refuse(f'<contact type="{c.type}"> on a {name} material ("{other}" takes these)', c.where)
            return


def _friction(ctx: Context, c: Component) -> float:
    """Coefficient of friction, refused where the solver has none or together with tension."""
    leaf = c.child("fric_coeff")
    nodal = c.type == "sliding-node-on-facet"  # where FEBio has friction only if it has a penalty, too
    if leaf is None or leaf.as_float() == 0.0 or (nodal and c.float("fric_penalty", 0.0) == 0.0):
        return 0.0
    if nodal and c.float("ktmult", 0.0) != 0.0:
        ctx.refuse(f'<ktmult> of <contact type="{c.type}">', c.need("ktmult").where)
    if c.type not in records.FRICTION:
        ctx.refuse(f'<fric_coeff> of <contact type="{c.type}">', leaf.where)
        return 0.0
    if c.bool("tension"):
        raise InputError("<tension> and <fric_coeff> exclude each other", leaf.where)
    return leaf.as_float()


def _pair(ctx: Context, c: Component) -> tuple[str, str]:
    name = c.attrs.get("surface_pair", "")
    pairs = ctx.model.mesh.surface_pairs
    if name not in pairs:
        raise missing("surface pair", name, pairs, c.where)
    pair = pairs[name]
    for s in (pair.primary, pair.secondary):
        if not sum(map(len, surface(ctx.model.mesh, s, pair.where).facets.values())):
            raise InputError(f'{c.what}: the surface "{s}" has no facets', c.where)
    return pair.primary, pair.secondary


def _facets(ctx: Context, c: Component, name: str, which: str, penalty: bool, offset: bool) -> Any:
    from febkit.solver.contact.surface import INVERTED, Facets

    conn = dict(ctx.model.mesh.surfaces[name].facets)
    at_nodes = "node-on-facet" in (c.type or "") or c.type == "sticky"
    for kind in conn:
        if kind not in INVERTED or (at_nodes and kind not in nodal.WEIGHTS):
            ctx.refuse(f'<contact type="{c.type}"> on {kind} facets', c.where)
    out = Facets(conn)
    if c.choice("integration_rule", RULES, False) and c.type == "contact potential":
        out.rules = {"quad4": "G16", "tri3": "G7"}
        for kind in conn.keys() - out.rules.keys():
            ctx.refuse(f"<integration_rule>higher-order</integration_rule> on {kind} facets", c.where)
    if ctx.refused:
        return out
    if penalty:
        find_owners(ctx, out)
    if offset:
        out.offset = _half_thickness(ctx)
    if c.bool(f"shell_bottom_{which}"):
        out.conn = {k: ctx.back[v] for k, v in conn.items()}
        if any((v < 0).any() for v in out.conn.values()):
            raise InputError(f'<shell_bottom_{which}>: a facet of "{name}" is no shell', c.where)
        out = out.inverted()
    return out.inverted() if c.bool(f"flip_{which}") else out


def _half_thickness(ctx: Context) -> np.ndarray:
    """Half the thickness of shells at the nodes (node,), the last element of a node counting."""
    out = np.zeros(len(ctx.X))
    for d in ctx.model.domains:
        if d.kind == "shell" and d.block in ctx.blocks:
            conn = ctx.blocks[d.block].conn
            out[conn.ravel()] = 0.5 * shells.thickness(ctx, d).ravel()
    return out


# ---- elements behind facets ---------------------------------------------------------------------------
def behind(ctx: Context, c: Component, conns: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Block and element (f, 2) behind each facet of a surface, by facet type. Raises InputError where there is none."""
    from febkit.solver.contact.surface import Facets

    out = Facets(conns)
    find_owners(ctx, out)
    for kind, owner in out.owner.items():
        if not ctx.refused and (owner < 0).any():
            name, row = c.attrs.get("surface", ""), int(np.argmax((owner < 0).any(axis=1)))
            raise InputError(f'{c.what}: no element is behind facet {row + 1} ({kind}) of "{name}"', c.where)
    return out.owner


def find_owners(ctx: Context, out: Any) -> None:
    """Find the element behind each facet: a shell where there is one, else the first in the order of <MeshDomains>."""
    wanted: dict[tuple[str, tuple[int, ...]], list[int]] = {}
    for kind, conn in out.conn.items():
        out.owner[kind] = np.full((len(conn), 2), -1)
        out.modulus[kind] = np.zeros(len(conn))
        for row, nodes in enumerate(conn[:, : corners(kind)].tolist()):
            wanted.setdefault((kind, tuple(sorted(nodes))), []).append(row)
    nodes = np.unique(np.concatenate([c.ravel() for c in out.conn.values()]))
    on = np.zeros(len(ctx.X), bool)
    on[nodes] = True
    rigid = {m.name: m for m in ctx.model.materials if m.type == "rigid body"}
    for d in sorted(ctx.model.domains, key=lambda d: d.kind != "shell"):
        block = ctx.blocks.get(d.block)
        if block is None:
            continue
        for kind, local in _faces(block.type, d.kind):
            face = block.conn[:, list(local[: corners(kind)])]
            for row in np.flatnonzero(on[face].all(axis=1)).tolist():
                for k in wanted.pop((kind, tuple(sorted(face[row].tolist()))), ()):
                    if d.material in rigid:
                        out.modulus[kind][k] = _rigid(ctx, rigid[d.material], block, row, kind, out.conn[kind][k])
                    else:
                        out.owner[kind][k] = ctx.numbers.get(d.block, -1), row


def _faces(element: str, kind: str) -> list[tuple[str, tuple[int, ...]]]:
    """Facets of an element type: type and local nodes."""
    if kind == "shell":
        return [(element, tuple(range(elements.shape(element).corners)))]
    return list(elements.shape(element).facets)


def _rigid(ctx: Context, spec: Component, block: Any, row: int, kind: str, facet: np.ndarray) -> float:
    """E / (1 - nu^2) A / V of an element of a rigid body."""
    X, nu = ctx.model.mesh.X, spec.float("v", 0.0)
    e, f = elements.get(block.type), elements.get(kind)
    if e.dim != 3:
        return 0.0
    J = np.linalg.det(np.einsum("gai,aj->gij", e.dN, X[block.conn[row]]))
    t = np.einsum("gaj,ai->gji", f.dN, X[facet])
    A = (np.linalg.norm(np.cross(t[:, 0], t[:, 1]), axis=1) * f.weights).sum()
    return float(spec.float("E", 0.0) / (1.0 - nu * nu) * A / (J * e.weights).sum())
