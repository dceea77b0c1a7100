"""One spelling for what FEBio's formats can say in several ways, so that models compare by meaning."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from febkit.model import Component, MeshData, Model, Step

from . import dofs
from .edit import is_true, same_text
from .v30 import DEFAULT_TYPES, QN_DEFAULT

BODIES = ("rb", "body_a", "body_b", "rbA", "rbB")
QUIET = (("relative", "0"), ("relative", "false"), ("load_type", "0"), ("load_type", "LOAD"))
INTERPOLATION = {"interpolate": "LINEAR", "extend": "CONSTANT"}


def canonical(model: Model) -> Model:
    """The same model, spelled in one way."""
    materials = {str(m.id): m.name or "" for m in model.materials if m.id is not None}
    thickness = _thickness(model)
    domains = tuple(replace(d, type=_domain_type(d.type), spec=_domain(d.spec, d.block in thickness))
                    for d in model.domains)
    maps = tuple(m for m in model.mesh_data if m.name != "shell thickness") + tuple(
        thickness[k] for k in sorted(thickness))
    controllers = tuple(replace(c, spec=_curve(c.spec)) for c in model.controllers)
    maps = tuple(replace(m, spec=_map(m.spec)) for m in maps)
    return replace(
        model, domains=domains, mesh_data=maps, controllers=controllers,
        materials=tuple(replace(m, id=None) for m in model.materials),
        common=_stage(model.common, materials, model.module),
        steps=tuple(replace(_stage(s, materials, model.module), name=None) for s in model.steps),
        discrete=tuple(replace(d, id=None) for d in model.discrete))


def _map(spec: Component) -> Component:
    """Without its set and name, which the record holds."""
    rest = {k: v for k, v in spec.attrs.items() if k not in ("node_set", "elem_set", "surface")}
    return replace(spec, name=None, attrs=rest)


def _domain_type(kind: str | None) -> str | None:
    return None if kind in DEFAULT_TYPES else kind


def _thickness(model: Model) -> dict[str, MeshData]:
    """Effective thickness of each shell domain at each node of each element."""
    out: dict[str, MeshData] = {}
    spec = Component("ElementData", "shell thickness")
    blocks = {b.name: b for b in model.mesh.blocks}
    for d in model.domains:
        block = blocks.get(d.block)
        if d.kind != "shell" or block is None or d.spec is None:
            continue
        h = d.spec.child("shell_thickness")
        first = h.as_float() if h is not None and not h.type and h.text else 0.0
        values = np.full(block.conn.shape, first)
        given = first != 0.0
        for m in model.mesh_data:
            if m.name != "shell thickness" or m.set != d.block or m.items is None or m.values is None:
                continue
            if m.values.shape[1:] == values.shape[1:] and m.items.max(initial=0) <= len(values):
                values[m.items - 1] = m.values
                given = True
        if given:
            items = np.arange(1, len(values) + 1)
            out[d.block] = MeshData("element", "shell thickness", d.block, spec, items, values)
    for m in model.mesh_data:
        if m.name == "shell thickness" and m.set not in out:
            out[m.set] = m
    return out


def _domain(spec: Component | None, thick: bool) -> Component | None:
    """Without the thickness, and without normals at nodes, which is the default."""
    if spec is None:
        return None
    rest = tuple(c for c in spec.children if not (
        c.tag == "shell_thickness" or (c.tag == "shell_normal_nodal" and is_true(c.text))))
    return replace(spec, children=rest)


def _curve(spec: Component) -> Component:
    """Without points, which the controller holds, and with its defaults said."""
    rest = {c.tag: replace(c, text=c.text.upper()) for c in spec.children if c.tag in INTERPOLATION}
    others = tuple(c for c in spec.children if c.tag not in INTERPOLATION and c.tag != "points")
    if spec.type != "loadcurve":
        return replace(spec, id=None, name=None)
    said = tuple(rest.get(k) or Component(k, text=v) for k, v in INTERPOLATION.items())
    return replace(spec, id=None, name=None, children=said + others)


def _stage(s: Step, materials: dict[str, str], module: str) -> Step:
    return replace(
        s,
        control=_control(s.control, module) if s.control is not None else None,
        boundary=_nameless(x for c in s.boundary for x in _fixed(_bodies(c, materials))),
        loads=_nameless(x for c in s.loads for x in _load(c)),
        contact=_nameless(s.contact),
        constraints=_nameless(_bodies(c, materials) for c in s.constraints),
        rigid=tuple(sorted(_nameless(x for c in s.rigid for x in _rigid(_bodies(c, materials))),
                           key=_rigid_key)),
        initial=_nameless(s.initial))


def _nameless(cs: object) -> tuple[Component, ...]:
    return tuple(replace(c, name=None, id=None) for c in cs)  # type: ignore[attr-defined]


def _bodies(c: Component, materials: dict[str, str]) -> Component:
    """Rigid bodies by name."""
    children = tuple(replace(x, text=materials.get(x.text, x.text)) if x.tag in BODIES else x
                     for x in c.children)
    return replace(c, children=children)


def _fixed(c: Component) -> list[Component]:
    """A fixed condition as one <dofs>; none where nothing is fixed."""
    group = dofs.BY_FIXED.get(c.type or "")
    if group is None:
        return [_relative(c)]
    if not group.named:
        own = list(group.dofs)
    elif group.flag(group.dofs[0]) == "c_dof":
        own = c.str("c_dof").replace(",", " ").split()
    else:
        own = [d for d in group.dofs if c.bool(f"{d}_dof")]
    rest = tuple(x for x in c.children if not x.tag.endswith("_dof"))
    return [replace(c, children=(Component("dofs", text=",".join(own)), *rest))] if own else []


def _relative(c: Component) -> Component:
    """Without <relative>0, which is the default."""
    return replace(c, children=tuple(x for x in c.children if (x.tag, x.text) not in QUIET))


def _load(c: Component) -> list[Component]:
    """A constant nodal force as a load on each dof."""
    value = c.child("value")
    if c.type == "nodal_force" and value is not None and value.type in (None, "vector", "const"):
        rest = tuple(x for x in _relative(c).children if x.tag not in ("value", "shell_bottom"))
        return [replace(c, type="nodal_load", children=(
            Component("dof", text=d), Component("scale", text=v, attrs=value.attrs), *rest))
            for d, v in zip("xyz", value.text.replace(",", " ").split()) if not same_text(v, "0")]
    if c.tag == "body_load" and c.type == "const":
        return [_constant(c)]
    return [_relative(c)]


def _constant(c: Component) -> Component:
    """x, y, z under at most one load curve as one vector."""
    parts = [c.child(d) for d in "xyz"]
    curves = {p.lc for p in parts if p is not None and p.text not in ("0", "0.0")}
    if len(curves) > 1 or any(p is not None and (p.children or p.type) for p in parts):
        return c
    lc = curves.pop() if curves else None
    force = Component("force", text=",".join(p.text if p is not None else "0" for p in parts),
                      attrs={} if lc is None else {"lc": str(lc)})
    rest = tuple(x for x in c.children if x.tag not in ("x", "y", "z"))
    return replace(c, type="body force", children=(force, *rest))


def _rigid(c: Component) -> list[Component]:
    """Fixed rigid conditions one dof each."""
    if c.tag == "rigid_bc" and c.type == "rigid_fixed":
        rb = c.child("rb")
        own = [x.tag for x in c.children if x.tag.endswith("_dof") and x.as_bool()]
        return [replace(c, children=(*((rb,) if rb else ()), Component("dof", text=d))) for d in own]
    return [_relative(c)]


def _rigid_key(c: Component) -> tuple[str, ...]:
    return c.tag, c.type or "", c.str("rb"), c.str("dof"), c.str("value")


def _control(c: Component, module: str) -> Component:
    """Full Newton is BFGS without updates; the module's own quasi-Newton method is said."""
    out = []
    default = Component("qn_method", QN_DEFAULT.get(module, "Broyden"))
    if c.child("solver") is None:
        out.append(Component("solver", children=(default,)))
    for x in c.children:
        if x.tag == "solver":
            kept = tuple(_qn(y) if y.tag == "qn_method" else y for y in x.children)
            said = () if x.child("qn_method") is not None else (default,)
            out.append(replace(x, type=None, children=kept + said))
        elif x.tag == "time_stepper" and x.type == "default":
            out.append(replace(x, type=None))
        elif x.tag in ("analysis", "plot_level", "output_level"):
            out.append(replace(x, text=x.text.upper()))
        else:
            out.append(x)
    return replace(c, children=tuple(out))


def _qn(c: Component) -> Component:
    if c.type != "full Newton":
        return c
    return replace(c, type="BFGS", children=(Component("max_ups", text="0"),))
