"""Version 2.5 to 3.0 and back.

Facts from FEBio 4.11's readers (FEBioXML): <Control> was flat; <Geometry> named materials; conditions were
tags of their own with ``bc="x,y"``; <LoadData> held <loadcurve>; every step was a <Step>.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from febkit.model import UnsupportedError

from . import dofs
from .document import Tag
from .edit import (
    clone,
    drop_empty,
    fresh,
    is_true,
    leaf,
    listed,
    materials,
    pop,
    rename,
    section,
    stages,
    take,
)
from .v30 import QN_DEFAULT

# parameters of <Control> itself in 3.0; every other one belongs to <solver>
STEP_PARAMETERS = ("analysis", "time_steps", "step_size", "final_time", "plot_zero_state", "plot_range",
                   "plot_level", "output_level", "plot_stride", "output_stride", "adaptor_re_solve",
                   "time_stepper")
THREE_FIELD = {"use_three_field_hex": ("hex8", "penta6", "pyra5"),
               "use_three_field_tet": ("tet4", "tet10", "tet15"),
               "use_three_field_shell": ("quad4", "tri3", "quad8", "tri6"),
               "use_three_field_quad": ("quad4",), "use_three_field_tri": ("tri3",)}
RULES = {("hex8", "GAUSS8"): "HEX8G8", ("hex8", "POINT6"): "HEX8G6", ("hex8", "UDG"): "HEX8G1",
         ("tet4", "GAUSS4"): "TET4G4", ("tet4", "UT4"): "ut4", ("tet10", "GAUSS4"): "TET10G4",
         ("tet10", "GAUSS8"): "TET10G8", ("tet10", "LOBATTO11"): "TET10GL11",
         ("tet15", "GAUSS8"): "TET15G8", ("tet15", "GAUSS11"): "TET15G11", ("tet15", "GAUSS15"): "TET15G15"}
ANALYSES = {"static": "STATIC", "dynamic": "DYNAMIC", "steady-state": "STEADY-STATE",
            "transient": "TRANSIENT"}
INTERPOLATIONS = {"step": "STEP", "linear": "LINEAR", "smooth": "SMOOTH", "cubic spline": "CUBIC SPLINE",
                  "control points": "CONTROL POINTS", "approximation": "APPROXIMATION",
                  "smooth step": "SMOOTH STEP", "C2-smooth": "C2-SMOOTH"}
EXTENDS = {"constant": "CONSTANT", "extrapolate": "EXTRAPOLATE", "repeat": "REPEAT",
           "repeat offset": "REPEAT OFFSET"}
ROWS = {"ElementData": ("elem", "e"), "NodeData": ("node", "node"), "SurfaceData": ("face", "face")}
OLD_BODIES = ("body_a", "body_b", "rb", "rbA", "rbB")
RIGID_OLD = {"x": "Rx", "y": "Ry", "z": "Rz", "Rx": "Ru", "Ry": "Rv", "Rz": "Rw"}
RIGID_LOAD_TYPES = {"": "0", "follow": "1", "ramp": "2"}
LOAD_TYPE_NAMES = {"LOAD": "0", "FOLLOW": "1", "TARGET": "2"}
SHELL_SHAPES = ("quad4", "quad8", "quad9", "tri3", "tri6", "q4eas", "q4ans", "q4s", "tri3s")


# -- up
def up(root: Tag) -> None:
    """Changes a 2.5 tree to 3.0 in place."""
    root.attrs["version"] = "3.0"
    names = materials(root)
    for s in root.all("Material"):
        for i, m in enumerate(s.all("material"), 1):
            m.attrs.setdefault("name", names[m.get("id", str(i)) or str(i)])
    module = root.child("Module")
    kind = (module.get("type") if module is not None else None) or "solid"
    asked: list[Formulation] = []
    for g in root.all("Geometry"):
        geometry_up(root, g, names)
    for stage in stages(root):
        for control in stage.all("Control"):
            asked += control_up(control, kind)
        stage_up(stage, names)
    formulations_up(root, asked)
    for s in root.all("LoadData"):
        for c in s:
            curve_up(c)
    for s in root.all("MeshData"):
        for d in list(s):
            if d.name not in ROWS:
                raise UnsupportedError(f"<{d.name}> maps have no counterpart in version 4.0", d.where)
            map_up(d)
    steps_up(root)


@dataclass(frozen=True, slots=True)
class Formulation:
    """What <Control> says of all elements of some shapes: attributes and parameters of their domains."""

    shapes: tuple[str, ...]
    attrs: dict[str, str] = field(default_factory=dict)
    children: tuple[Tag, ...] = ()


def formulations_up(root: Tag, asked: list[Formulation]) -> None:
    shapes = {e.get("name"): e.get("type") for m in root.all("Mesh") for e in m.all("Elements")}
    for s in root.all("MeshDomains"):
        for d in s:
            for f in asked:
                if shapes.get(d.get("name")) in f.shapes:
                    d.attrs = f.attrs | d.attrs
                    d.children += [clone(c) for c in f.children]


def geometry_up(root: Tag, g: Tag, names: dict[str, str]) -> None:
    """<Geometry> becomes <Mesh> and <MeshDomains>."""
    g.name = "Mesh"
    used = {e.get("name") or "" for e in g.all("Elements")}
    domains = Tag("MeshDomains", line=g.line, doc=g.doc)
    for c in list(g):
        if c.name in ("Part", "Instance", "NodeSetPair", "NodeSetSet"):
            message = f"<{c.name}> in <Geometry> is not read: export the model as one mesh"
            raise UnsupportedError(message, c.where)
        if c.name != "Elements":
            continue
        if not c.get("name"):
            c.attrs["name"] = fresh("Part", used)
        material = pop(c, "mat")
        pop(c, "active")
        shape = (c.get("type") or "").lower()
        attrs = {"name": c.need("name"), "mat": names.get(material, material)}
        if c.get("type") in ("q4eas", "q4ans", "ut4") or re.fullmatch(r"[A-Z]+\d+G.*", c.get("type") or ""):
            attrs["elem_type"] = c.need("type")
            c.attrs["type"] = _plain(c.need("type"))
        shell = shape in SHELL_SHAPES or shape.startswith(("quad", "tri"))
        domains.children.append(Tag("ShellDomain" if shell else "SolidDomain", attrs, line=c.line, doc=c.doc))
    if domains.children:
        root.children.insert(root.children.index(g) + 1, domains)
    _repeats(g)


def _repeats(g: Tag) -> None:
    """FEBio lets a set of nodes be given again; one that says the same counts once."""
    known: dict[str, list[str]] = {}
    for c in g.all("NodeSet"):
        if c.all("NodeSet"):  # sets of sets
            continue
        rows = listed(c) + [w for q in (c, *c.all("node_list")) for w in q.text.replace(",", " ").split()]
        name = c.get("name") or ""
        if known.get(name) == rows:
            g.children.remove(c)
        known.setdefault(name, rows)


def _plain(elem_type: str) -> str:
    t = elem_type.lower()
    if t in ("q4eas", "q4ans"):
        return "quad4"
    if t == "ut4":
        return "tet4"
    return t.split("g")[0]


def control_up(control: Tag, module: str) -> list[Formulation]:
    """Returns what the control says of domains."""
    asked: list[Formulation] = []
    own, solver = [], Tag("solver", line=control.line, doc=control.doc)
    for c in control:
        if c.name == "analysis":
            word = (c.get("type") or c.text).strip()
            own.append(leaf("analysis", ANALYSES.get(word.lower(), word)))
        elif c.name in THREE_FIELD:
            flag = "on" if is_true(c.text) else "off"
            asked.append(Formulation(THREE_FIELD[c.name], {"three_field": flag}))
        elif c.name == "integration":
            asked += _rules(c)
        elif c.name == "shell_normal_nodal":
            asked.append(Formulation(SHELL_SHAPES, {}, (c,)))
        elif c.name in STEP_PARAMETERS or c.name == "shell_formulation":
            own.append(c)
        elif c.name not in ("print_level", "title"):
            solver.children.append(c)
    other = QN_DEFAULT.get(module, "Broyden") != "BFGS" or solver.child("max_ups") is not None
    if solver.child("qnmethod") is None and other:
        solver.children.append(leaf("qnmethod", "BFGS"))  # the older formats' default in every module
    control.children = [*own, solver] if solver.children else own
    return asked


def _rules(integration: Tag) -> list[Formulation]:
    out = []
    for rule in integration.all("rule"):
        shape, word = rule.need("elem"), (rule.get("type") or rule.text).strip()
        if shape.startswith("tri") or (shape, word) in (("tet4", "GAUSS1"), ("tet10", "GAUSS1")):
            continue
        if (shape, word) not in RULES:
            raise UnsupportedError(f'integration rule "{word}" of {shape} has no counterpart', rule.where)
        out.append(Formulation((shape,), {"elem_type": RULES[shape, word]}, tuple(rule.children)))
    return out


def stage_up(stage: Tag, names: dict[str, str]) -> None:
    rigid: list[Tag] = []
    for s in stage.all("Boundary"):
        s.children = [new for c in s for new in boundary_up(c, names, rigid)]
    for s in stage.all("Initial"):
        for c in list(s):
            if c.name == "init":
                c.name = "ic"
                c.children.insert(0, leaf("dof", pop(c, "bc")))
                c.attrs["type"] = "init_dof"
            elif c.name == "rigid_body":
                s.children.remove(c)
                rigid += rigid_body_up(c, names)
    for s in stage.all("Loads"):
        for c in s:
            load_up(c)
    for s in stage.all("Constraints"):
        for c in list(s):
            if c.name == "rigid_body":
                s.children.remove(c)
                rigid += rigid_body_up(c, names)
            elif (c.get("type") or "").startswith(("rigid ", "generic rigid")):
                s.children.remove(c)
                c.name = "rigid_connector"
                rigid.append(c)
    if rigid:
        section(stage, "Rigid", ("Boundary", "Initial", "Control")).children += rigid
    drop_empty(stage, ("Boundary", "Initial", "Constraints"))


def boundary_up(c: Tag, names: dict[str, str], rigid: list[Tag]) -> list[Tag]:
    name = c.name
    if name == "fix":
        c.children = [leaf("dofs", pop(c, "bc"))]
    elif name == "prescribe":
        value = c.child("value")
        if value is not None:
            valued(c, value)
        c.children.insert(0, leaf("dof", pop(c, "bc")))
    elif name == "rigid":
        c.children.insert(0, leaf("rb", names.get(c.get("rb") or "", pop(c, "rb"))))
        pop(c, "rb")
    elif name == "rigid_body":
        rigid += rigid_body_up(c, names)
        return []
    elif name == "linear_constraint":
        return linear_constraint_up(c)
    elif name != "bc":
        raise UnsupportedError(f"<{name}> in <Boundary> has no counterpart in version 4.0", c.where)
    if name != "bc":
        c.name = "bc"
        c.attrs["type"] = name
    return [c]


def linear_constraint_up(c: Tag) -> list[Tag]:
    """sum of children's values minus the parent's = 0, one condition for each dof."""
    out = []
    for d in dofs.parse(c.need("bc")) or []:
        rows = [leaf("node", c.need("node")), leaf("dof", d)]
        for n in c:
            child = [leaf("node", n.need("id")), leaf("dof", n.get("bc") or d), leaf("value", n.text.strip())]
            rows.append(Tag("child_dof", children=child))
        out.append(Tag("bc", {"type": "linear constraint"}, children=rows, line=c.line, doc=c.doc))
    return out


def rigid_body_up(c: Tag, names: dict[str, str]) -> list[Tag]:
    rb = names.get(c.need("mat"), c.need("mat"))
    out = []
    for r in c:
        kind = {"prescribed": "prescribe", "force": "force", "fixed": "fix",
                "initial_velocity": "initial_rigid_velocity",
                "initial_angular_velocity": "initial_rigid_angular_velocity"}.get(r.name)
        if kind is None:
            raise UnsupportedError(f"<{r.name}> does not belong in <rigid_body>", r.where)
        new = Tag("rigid_constraint", {"type": kind}, children=[leaf("rb", rb)], line=r.line, doc=r.doc)
        if kind in ("fix", "prescribe", "force"):
            bc = r.need("bc")
            if bc not in RIGID_OLD:
                raise UnsupportedError(f'<{r.name} bc="{bc}"> is no rigid degree of freedom', r.where)
            new.children.append(leaf("dofs" if kind == "fix" else "dof", RIGID_OLD[bc]))
        if kind != "fix":
            value = leaf("value", r.text.strip())
            if r.get("lc") not in (None, "", "0"):
                value.attrs["lc"] = r.need("lc")
            new.children.append(value)
        if kind == "prescribe":
            new.children.append(leaf("relative", "1" if r.get("type") == "relative" else "0"))
        elif kind == "force" and r.get("type"):
            new.children.append(leaf("load_type", RIGID_LOAD_TYPES.get(r.need("type"), "0")))
        out.append(new)
    return out


def valued(c: Tag, value: Tag) -> None:
    """<value> of <prescribe>, a number or a map, stands in for the number of <scale>, whose load curve stays."""
    data, old = pop(value, "node_data"), take(c, "scale")
    value.name = "scale"
    if old is not None and "lc" in old.attrs:
        value.attrs.setdefault("lc", old.attrs["lc"])
    if data:
        value.attrs["type"], value.text = "map", data


def load_up(c: Tag) -> None:
    if c.name == "nodal_load" and "bc" in c.attrs:
        c.children.insert(0, leaf("dof", pop(c, "bc")))
        c.attrs.setdefault("type", "nodal_load")
        value = c.child("value")
        if value is not None and c.child("scale") is None:
            value.name = "scale"
    elif c.name == "surface_load" and c.get("type") == "pressure":
        value = c.child("value")
        if value is not None:
            data = pop(value, "surface_data")
            value.name = "pressure"
            if data:
                value.attrs["type"], value.text = "map", data
    elif c.name == "body_load" and c.get("type") == "const":
        const_up(c)


def const_up(c: Tag) -> None:
    """x, y, z under at most one load curve are one vector."""
    parts = [c.child(d) for d in "xyz"]
    curves = {p.get("lc") for p in parts if p is not None and p.text.strip() not in ("0", "0.0")}
    if len(curves) > 1 or any(p is not None and (p.children or p.get("type")) for p in parts):
        return
    force = leaf("force", ",".join(p.text.strip() if p is not None else "0" for p in parts))
    if curves and (lc := curves.pop()):
        force.attrs["lc"] = lc
    c.attrs["type"] = "body force"
    c.children = [force] + [x for x in c if x.name not in ("x", "y", "z")]


def curve_up(c: Tag) -> None:
    if c.name != "loadcurve":
        return
    c.name = "load_controller"
    kind, extend = pop(c, "type", "linear"), pop(c, "extend", "constant")
    c.attrs["type"] = "loadcurve"
    points = Tag("points", line=c.line, doc=c.doc)
    for p in c:
        points.children.append(leaf("point", p.text.strip()))
    c.children = [leaf("interpolate", INTERPOLATIONS.get(kind, kind.upper())),
                  leaf("extend", EXTENDS.get(extend, extend.upper())), points]


def map_up(d: Tag) -> None:
    rename(d, "data_type", "datatype")
    old, new = ROWS[d.name]
    if d.table is not None and d.table.tag == old:
        d.table = type(d.table)(new, d.table.attr, d.table.labels, d.table.values, d.table.start, d.table.end)
    for c in d:
        if c.name == old:
            c.name = new


def steps_up(root: Tag) -> None:
    steps = root.all("Step")
    if not steps or any(s.child("step") is not None for s in steps):
        return
    gathered = Tag("Step", line=steps[0].line, doc=root.doc)
    for i, s in enumerate(steps, 1):
        take(s, "Module")
        s.name = "step"
        s.attrs = {"id": str(i)} | {k: v for k, v in s.attrs.items() if k != "id"}
        gathered.children.append(s)
    root.children[root.children.index(steps[0])] = gathered
    root.children = [c for c in root.children if c.name != "step"]


