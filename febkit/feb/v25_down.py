"""Version 3.0 to 2.5: what one step down does (see :mod:`.v25` for the way up)."""

from __future__ import annotations

from .document import Tag
from .edit import (
    clone,
    is_true,
    leaf,
    materials,
    pop,
    rename,
    same_text,
    section,
    stages,
    take,
    text,
    walk,
)
from .references import materialise
from .v25 import (
    ANALYSES,
    EXTENDS,
    INTERPOLATIONS,
    LOAD_TYPE_NAMES,
    OLD_BODIES,
    RIGID_LOAD_TYPES,
    RIGID_OLD,
    ROWS,
    THREE_FIELD,
)
from .v30 import QN_DEFAULT, body_name
from .v30_down import thickness_down


def down(root: Tag, notes: list[str]) -> None:
    """Changes a 3.0 tree to 2.5 in place; ``notes`` receives what 2.5 cannot say."""
    root.attrs["version"] = "2.5"
    ids = {name: i for i, name in materials(root).items()}
    module = root.child("Module")
    kind = (module.get("type") if module is not None else None) or "solid"
    if module is not None and module.children:
        notes += [f"<Module><{c.name}>: version 2.5 does not have it" for c in module]
        module.children = []
    asked: list[Tag] = []
    for mesh in root.all("Mesh"):
        asked = geometry_down(root, mesh, ids, notes)
    for g in root.all("Geometry"):
        materialise(root, g, ("@surface", "@edge", "@elem_set"))
    for s in root.all("LoadData"):
        for c in list(s):
            curve_down(c, s, notes)
    for s in root.all("MeshData"):
        for d in s:
            map_down(d)
    for stage in stages(root):
        stage_down(stage, ids, notes)
        controls = stage.all("Control")
        for control in controls:
            control_down(control, kind, asked)
    if asked and not any(True for s in stages(root) for _ in s.all("Control")):
        notes.append("formulations of domains: said in <Control> in version 2.5, and there is none")
    steps_down(root)


def geometry_down(root: Tag, mesh: Tag, ids: dict[str, str], notes: list[str]) -> list[Tag]:
    """Returns what <Control> has to say for the domains."""
    mesh.name = "Geometry"
    domains = {d.get("name"): d for s in root.all("MeshDomains") for d in s}
    root.children = [c for c in root if c.name != "MeshDomains"]
    said: dict[str, set[str]] = {}
    for e in mesh.all("Elements"):
        d = domains.get(e.get("name"))
        shape = e.get("type") or ""
        if d is None:
            notes.append(f'elements "{e.get("name")}": have no domain, and version 2.5 wants a material')
            continue
        e.attrs = {"type": d.get("elem_type") or shape, "name": e.need("name"),
                   "mat": ids.get(d.get("mat") or "", d.get("mat") or "")}
        for c in d:
            if c.name == "shell_thickness":
                thickness_down(section(root, "MeshData", ("Geometry",)), e, c.text.strip(), "var")
            elif c.name in ("alpha", "iso_stab") and d.get("elem_type") == "ut4":
                said.setdefault(c.name, set()).add(c.text.strip())
            elif c.name == "shell_normal_nodal":
                said.setdefault("normals", set()).add("1" if is_true(c.text) else "0")
            else:
                notes.append(f'domain "{d.get("name")}": <{c.name}> has no place in version 2.5')
        if d.get("three_field"):
            said.setdefault(shape, set()).add(d.need("three_field"))
        elif any(shape in shapes for shapes in THREE_FIELD.values()):
            said.setdefault(shape, set()).add("")
    return formulations_down(said, notes)


def formulations_down(said: dict[str, set[str]], notes: list[str]) -> list[Tag]:
    out = []
    normals = said.pop("normals", {"1"})
    if normals == {"0"}:
        out.append(leaf("shell_normal_nodal", "0"))
    elif len(normals) > 1:
        notes.append("<shell_normal_nodal>: holds for all shells in version 2.5, and the domains differ")
    ut4 = {k: said.pop(k) for k in ("alpha", "iso_stab") if k in said}
    if ut4 and all(len(v) == 1 for v in ut4.values()):
        rows = [leaf(k, next(iter(v))) for k, v in ut4.items()]
        rule = Tag("rule", {"elem": "tet4", "type": "UT4"}, children=rows)
        out.append(Tag("integration", children=[rule]))
    elif ut4:
        notes.append("<alpha>, <iso_stab>: hold for all tet4 in version 2.5, and the domains differ")
    for key, shapes in THREE_FIELD.items():
        if key in ("use_three_field_quad", "use_three_field_tri"):
            continue
        flags = set().union(*(said.get(s, set()) for s in shapes))
        if len(flags) == 1 and flags != {""}:
            out.append(leaf(key, "1" if flags == {"on"} else "0"))
        elif len(flags) > 1:
            notes.append(f"<{key}>: holds for all elements of a shape in version 2.5, and the domains differ")
    return out


def curve_down(c: Tag, curves: Tag, notes: list[str]) -> None:
    number = c.get("id")
    if c.get("type") != "loadcurve":
        notes.append(f'load controller {number} of type "{c.get("type")}": version 2.5 has load curves only; '
                     "a curve of 1 stands in its place")
        one = [leaf("point", "0,1"), leaf("point", "1,1")]
        attrs = {"id": number or "1", "type": "linear"}
        curves.children[curves.children.index(c)] = Tag("loadcurve", attrs, children=one)
        return
    kinds = {v: k for k, v in INTERPOLATIONS.items()}
    extends = {v: k for k, v in EXTENDS.items()}
    points = c.child("points")
    c.name = "loadcurve"
    c.attrs = {"id": number or "1", "type": kinds.get(text(c, "interpolate", "LINEAR").upper(), "linear"),
               "extend": extends.get(text(c, "extend", "CONSTANT").upper(), "constant")}
    c.children = [leaf("point", p.text.strip()) for p in points] if points is not None else []


def map_down(d: Tag) -> None:
    rename(d, "datatype", "data_type" if d.name != "ElementData" else "datatype")
    new, old = ROWS[d.name]
    if d.table is not None and d.table.tag == old:
        d.table = type(d.table)(new, d.table.attr, d.table.labels, d.table.values, d.table.start, d.table.end)
    for c in d:
        if c.name == old:
            c.name = new


def stage_down(stage: Tag, ids: dict[str, str], notes: list[str]) -> None:
    for s in stage.all("Boundary"):
        s.children = [new for bc in s for new in bc_down(bc, ids)]
    for s in stage.all("Initial"):
        for c in s:
            if c.get("type") == "init_dof":
                c.name = "init"
                found = take(c, "dof")
                c.attrs = {"bc": found.text if found else ""} | {
                    k: v for k, v in c.attrs.items() if k != "type"}
    for s in stage.all("Loads"):
        s.children = [new for c in s for new in load_down(c, notes)]
    rigid = take(stage, "Rigid")
    if rigid is not None:
        rigid_down(stage, rigid, ids, notes)


def bc_down(bc: Tag, ids: dict[str, str]) -> list[Tag]:
    kind = bc.get("type")
    if kind == "fix":
        bc.name = "fix"
        bc.attrs = {"bc": text(bc, "dofs")} | {k: v for k, v in bc.attrs.items() if k != "type"}
        bc.children = []
    elif kind == "prescribe":
        found = take(bc, "dof")
        bc.name = "prescribe"
        bc.attrs = {"bc": found.text if found else ""} | {k: v for k, v in bc.attrs.items() if k != "type"}
    elif kind == "rigid":
        rb = take(bc, "rb")
        number = rb.text.strip() if rb is not None else ""
        bc.name = "rigid"
        bc.attrs = {"rb": ids.get(number, number)} | {k: v for k, v in bc.attrs.items() if k != "type"}
    elif kind == "linear constraint" and bc.child("offset") is None and not any(
            "lc" in x.attrs for x in walk(bc)):
        bc.name, bc.attrs = "linear_constraint", {"node": text(bc, "node"), "bc": text(bc, "dof")}
        bc.children = [leaf("node", text(d, "value"), id=text(d, "node"), bc=text(d, "dof"))
                       for d in bc.all("child_dof")]
    return [bc]


def load_down(c: Tag, notes: list[str]) -> list[Tag]:
    if c.name == "nodal_load" and c.get("type") == "nodal_force":
        return _force_down(c, notes)
    if c.name == "nodal_load" and c.get("type") == "nodal_load":
        found = take(c, "dof")
        c.attrs = {"bc": found.text if found else ""} | {k: v for k, v in c.attrs.items() if k != "type"}
    elif c.name == "nodal_load":
        notes.append(f'<nodal_load type="{c.get("type")}">: version 2.5 does not have it')
        return []
    return [c]


def _force_down(c: Tag, notes: list[str]) -> list[Tag]:
    """A nodal force is a load on each of x, y, z."""
    value = c.child("value")
    if value is None or value.get("type") not in (None, "vector", "const"):
        notes.append('<nodal_load type="nodal_force"> with a value that varies: version 2.5 does not have it')
        return []
    out = []
    for dof, v in zip("xyz", value.text.replace(",", " ").split()):
        if not same_text(v, "0"):
            scale = leaf("scale", v, **({"lc": value.need("lc")} if value.get("lc") else {}))
            rest = [clone(x) for x in c if x.name not in ("value", "shell_bottom")]
            attrs = {"bc": dof} | {k: x for k, x in c.attrs.items() if k != "type"}
            out.append(Tag("nodal_load", attrs, children=[scale, *rest], line=c.line, doc=c.doc))
    return out


def rigid_down(stage: Tag, rigid: Tag, ids: dict[str, str], notes: list[str]) -> None:
    back = {v: k for k, v in RIGID_OLD.items()}
    bodies: dict[str, Tag] = {}
    others: list[Tag] = []
    for c in rigid:
        for child in OLD_BODIES:
            body_name(c, child, ids)
        if c.name == "rigid_connector":
            c.name = "constraint"
            others.append(c)
            continue
        kind = c.get("type") or ""
        body = bodies.setdefault(text(c, "rb"), Tag("rigid_body", {"mat": text(c, "rb")}))
        rows = _rigid_rows(c, kind, back)
        if not rows:
            notes.append(f'<rigid_constraint type="{kind}">: version 2.5 does not have it')
        body.children += rows
    used = [b for b in bodies.values() if b.children]
    if used:
        section(stage, "Boundary", ("Control", "Geometry", "MeshData")).children += used
    if others:
        section(stage, "Constraints", ("Boundary", "Loads", "Contact")).children += others


def _rigid_rows(c: Tag, kind: str, back: dict[str, str]) -> list[Tag]:
    value = c.child("value")
    lc = {"lc": value.need("lc")} if value is not None and value.get("lc") else {}
    number = value.text.strip() if value is not None else ""
    if kind == "fix":
        return [leaf("fixed", bc=back[d]) for d in text(c, "dofs").replace(",", " ").split() if d in back]
    if kind == "prescribe" and text(c, "dof") in back:
        relative = {"type": "relative"} if is_true(text(c, "relative", "0")) else {}
        return [leaf("prescribed", number, bc=back[text(c, "dof")], **(lc or {"lc": "0"}), **relative)]
    if kind == "force" and text(c, "dof") in back:
        code = text(c, "load_type", "0")
        number_ = LOAD_TYPE_NAMES.get(code.upper(), code)
        word = next((k for k, v in RIGID_LOAD_TYPES.items() if v == number_), "")
        return [leaf("force", number, bc=back[text(c, "dof")], **({"type": word} if word else {}),
                     **(lc or {"lc": "0"}))]
    if kind == "initial_rigid_velocity":
        return [leaf("initial_velocity", number)]
    if kind == "initial_rigid_angular_velocity":
        return [leaf("initial_angular_velocity", number)]
    return []


def control_down(control: Tag, module: str, asked: list[Tag]) -> None:
    flat: list[Tag] = []
    for c in control:
        if c.name == "analysis":
            word = c.text.strip()
            old = next((k for k, v in ANALYSES.items() if v == word.upper()), word.lower())
            flat.append(leaf("analysis", type=old))
        elif c.name == "solver":
            flat += c.children
            if c.child("qnmethod") is None and QN_DEFAULT.get(module, "Broyden") != "BFGS":
                flat.append(leaf("qnmethod", QN_DEFAULT.get(module, "Broyden")))
        else:
            flat.append(c)
    if control.child("solver") is None and QN_DEFAULT.get(module, "Broyden") != "BFGS":
        flat.append(leaf("qnmethod", QN_DEFAULT.get(module, "Broyden")))
    control.children = flat + [clone(a) for a in asked]


def steps_down(root: Tag) -> None:
    for gathered in root.all("Step"):
        steps = gathered.all("step")
        for s in steps:
            s.name = "Step"
            pop(s, "id")
        at = root.children.index(gathered)
        root.children[at:at + 1] = steps


