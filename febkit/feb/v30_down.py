"""Version 4.0 to 3.0: what one step down does (see :mod:`.v30` for the way up)."""

from __future__ import annotations

from . import dofs
from .document import Tag
from .edit import (
    drop_empty,
    fresh,
    is_true,
    leaf,
    listed,
    materials,
    pop,
    rename,
    same_text,
    section,
    set_child,
    stages,
    take,
    text,
    walk,
)
from .mesh import VAR_MAPS, floats, ints
from .references import materialise
from .v30 import (
    DEFAULT_TYPES,
    QN,
    QN_NAMES,
    RIGID_DOFS,
    RIGID_ICS,
    RIGID_LOADS,
    SHELL_TYPES,
    SOLID_TYPES,
    )


def down(root: Tag, notes: list[str], edges: bool = False) -> None:
    """Changes a 4.0 tree to 3.0 in place; ``notes`` receives what 3.0 cannot say.

    ``edges`` keeps what 3.0 lost and the versions before it had.
    """
    root.attrs["version"] = "3.0"
    ids = {name: i for i, name in materials(root).items()}
    lists: dict[str, str] = {}
    for mesh in root.all("Mesh"):
        materialise(root, mesh, ("@edge",))
        lists = sets_down(mesh, notes, edges)
    shells = {e.get("name"): e for mesh in root.all("Mesh") for e in mesh.all("Elements")}
    for s in root.all("MeshDomains"):
        for d in list(s):
            thickness = take(d, "shell_thickness")  # which FEBio reads from 4.0 on
            if thickness is not None and d.get("name") in shells:
                data = section(root, "MeshData", ("MeshDomains",))
                thickness_down(data, shells[d.get("name")], thickness.text.strip(), "type")
            domain_down(d, s, notes)
    for s in root.all("MeshData"):
        for d in s:
            map_down(d)
    for stage in stages(root):
        for control in stage.all("Control"):
            control_down(control, notes)
        for s in stage.all("Boundary"):
            s.children = [bc for bc in s if bc_down(bc, notes)]
        for s in stage.all("Initial"):
            for ic in s:
                ic_down(ic)
        for s in stage.all("Rigid"):
            s.children = [c for c in s if rigid_down(c, ids, notes)]
        drop_empty(stage, ("Boundary", "Rigid"))
    for tag in walk(root):
        for attr, v in tag.attrs.items():
            if v in lists:
                tag.attrs[attr] = lists[v]


def sets_down(mesh: Tag, notes: list[str], edges: bool) -> dict[str, str]:
    """Returns new names of references to part lists."""
    used = {c.get("name") or "" for c in mesh}
    elements: dict[str, list[str]] = {}
    if mesh.child("PartList") is not None:
        elements = {c.get("name") or "": listed(c) for c in mesh.all("Elements")}
    references: dict[str, str] = {}
    for s in list(mesh):
        if s.name in ("NodeSet", "ElementSet") and not s.children:
            ids = ints(s.text, s).tolist()
            if s.name == "ElementSet":
                elements[s.get("name") or ""] = [str(i) for i in ids]
            s.text, s.children = "", [leaf("n" if s.name == "NodeSet" else "e", id=str(i)) for i in ids]
        elif s.name == "Edge" and not edges:
            mesh.children.remove(s)
            notes.append(f'edge "{s.get("name")}": version 3.0 has no <Edge>')
        elif s.name == "PartList":
            name = fresh(s.get("name") or "parts", used)
            parts = [w.strip() for w in s.text.split(",")]
            rows = [leaf("e", id=i) for p in parts for i in elements.get(p, [])]
            at = mesh.children.index(s)
            mesh.children[at] = Tag("ElementSet", {"name": name}, children=rows)
            references[f'@part_list:{s.get("name")}'] = name
            notes.append(f'part list "{s.get("name")}": written as the element set "{name}"')
    return references


def thickness_down(data: Tag, elements: Tag, thickness: str, kind: str) -> None:
    """A shell domain's thickness, given to each of its elements where no map of <MeshData> gives it.

    ``kind``: the attribute that says what a map is of.
    """
    name = elements.need("name")
    mapped = any(d.get(kind) == "shell thickness" and d.get("elem_set") == name
                 and len(d.children if d.table is None else d.table.labels) == len(listed(elements)) for d in data)
    if mapped or same_text(thickness or "0", "0"):
        return
    t = elements.table
    n = max((len(floats(c.text, c)) for c in elements), default=0) if t is None else t.values.shape[1]
    count = len(elements.children) if t is None else len(t.labels)
    rows = Tag("ElementData", {kind: "shell thickness", "elem_set": name})
    rows.children = [leaf("e", ",".join([thickness] * n), lid=str(i)) for i in range(1, count + 1)]
    data.children.insert(0, rows)


def domain_down(d: Tag, domains: Tag, notes: list[str]) -> None:
    kind = d.get("type")
    if d.name == "BeamDomain":
        d.name = "SolidDomain"
        kind = pop(d, "type") or None
        if kind not in (None, *DEFAULT_TYPES):
            notes.append(f'domain "{d.get("name")}": version 3.0 cannot ask for type "{kind}"')
        return
    if kind is None:
        return
    del d.attrs["type"]
    if kind in DEFAULT_TYPES:
        return
    attrs = (SOLID_TYPES if kind in SOLID_TYPES else SHELL_TYPES).get(kind)
    if attrs is None:
        notes.append(f'domain "{d.get("name")}": version 3.0 cannot ask for type "{kind}"')
    else:
        d.attrs |= attrs


def map_down(d: Tag) -> None:
    rename(d, "data_type", "datatype")
    kind = d.get("type")
    if kind is None:
        return
    rename(d, "type", "var" if kind in VAR_MAPS or ".fiber" in kind else "generator")


def control_down(control: Tag, notes: list[str]) -> None:
    solver = control.child("solver")
    stepper = control.child("time_stepper")
    if stepper is not None:
        kind = pop(stepper, "type", "default")
        if kind != "default":
            notes.append(f'time stepper "{kind}": version 3.0 has the default one only')
    if solver is None:
        return
    pop(solver, "type")
    qn = take(solver, "qn_method")
    if qn is None:
        return
    back = {new: old for old, new in QN.items()}
    kind = qn.get("type") or "BFGS"
    if kind == "full Newton":
        solver.children += [leaf("qnmethod", "BFGS"), leaf("max_ups", "0")]
        return
    if kind not in QN_NAMES.values():
        notes.append(f'quasi-Newton method "{kind}": version 3.0 does not have it')
        return
    solver.children.append(leaf("qnmethod", kind))
    for c in qn:
        if c.name in back:
            c.name = back[c.name]
            solver.children.append(c)
        else:
            notes.append(f"<qn_method><{c.name}>: version 3.0 does not have it")


def bc_down(bc: Tag, notes: list[str]) -> bool:
    """False where the condition does nothing."""
    kind = bc.get("type") or ""
    if kind in dofs.BY_FIXED:
        return fix_down(bc, dofs.BY_FIXED[kind], notes)
    if kind in dofs.BY_PRESCRIBED:
        group = dofs.BY_PRESCRIBED[kind]
        bc.attrs["type"] = "prescribe"
        value = bc.child("value")
        if value is not None:
            value.name = "scale"
        if not group.named:
            bc.children.insert(0, leaf("dof", group.dofs[0]))
    return True


def fix_down(bc: Tag, group: dofs.Group, notes: list[str]) -> bool:
    if not group.named:
        own = list(group.dofs)
    elif group.flag(group.dofs[0]) == "c_dof":
        own = text(bc, "c_dof").replace(",", " ").split()
    else:
        own = [d for d in group.dofs if is_true(text(bc, f"{d}_dof", "0"))]
    known = {group.flag(d) for d in group.dofs}
    notes += [f'<bc type="{group.fixed}"><{c.name}>: not said in version 3.0'
              for c in bc if c.name not in known]
    bc.attrs["type"] = "fix"
    bc.children = [leaf("dofs", ",".join(own))]
    return bool(own)


def ic_down(ic: Tag) -> None:
    group = dofs.BY_INITIAL.get(ic.get("type") or "")
    if group is None:
        return
    ic.attrs["type"] = "init_dof"
    if not group.named:
        ic.children.insert(0, leaf("dof", group.dofs[0]))


def rigid_down(c: Tag, ids: dict[str, str], notes: list[str]) -> bool:
    rb = c.child("rb")
    if rb is not None and c.name != "rigid_connector":
        rb.text = ids.get(rb.text.strip(), rb.text)
    kind = c.get("type") or ""
    if c.name == "rigid_bc" and kind == "rigid_fixed":
        own = [d for d in RIGID_DOFS if is_true(text(c, f"{d}_dof", "0"))]
        c.children = [x for x in c if not x.name.endswith("_dof")] + [leaf("dofs", ",".join(own))]
        c.name, c.attrs["type"] = "rigid_constraint", "fix"
        return bool(own)
    if c.name == "rigid_bc" and kind in ("rigid_displacement", "rigid_rotation"):
        dof = text(c, "dof")
        set_child(c, "dof", {"x": "Rx", "y": "Ry", "z": "Rz"}.get(dof, dof))
        c.name, c.attrs["type"] = "rigid_constraint", "prescribe"
    elif c.name == "rigid_load" and kind in ("rigid_force", "rigid_moment"):
        c.name, c.attrs["type"] = "rigid_constraint", "force"
    elif c.name == "rigid_ic" and kind in RIGID_ICS:
        c.name = "rigid_constraint"
    elif c.name == "rigid_load" and kind in RIGID_LOADS.values():
        c.name = "rigid_constraint"
        c.attrs["type"] = next(old for old, new in RIGID_LOADS.items() if new == kind)
    elif c.name == "rigid_bc":
        c.name = "rigid_constraint"
    elif c.name != "rigid_connector":
        notes.append(f'<{c.name} type="{kind}">: version 3.0 does not have it')
        return False
    return True
