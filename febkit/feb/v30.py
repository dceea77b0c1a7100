"""Version 3.0 to 4.0 and back.

Facts from FEBio 4.11's readers (FEBioXML): sets were lists of tags; conditions were "fix", "prescribe",
"init_dof" with a dof; rigid conditions one tag; quasi-Newton parameters lay flat in <solver>; maps said
``var``, ``generator`` and ``datatype``.
"""

from __future__ import annotations

from . import dofs
from .document import Tag
from .edit import (
    drop_empty,
    leaf,
    listed,
    materials,
    pop,
    rename,
    section,
    set_child,
    stages,
    take,
    text,
)

QN = {"max_ups": "max_ups", "qn_max_buffer_size": "max_buffer_size", "qn_cycle_buffer": "cycle_buffer",
      "cmax": "cmax"}
QN_NAMES = {"bfgs": "BFGS", "0": "BFGS", "broyden": "Broyden", "1": "Broyden", "jfnk": "JFNK", "2": "JFNK"}
# module -> quasi-Newton method of its solver where none is given
QN_DEFAULT = {"solid": "BFGS", "heat": "BFGS"}
SHELLS = {"0": "elastic-shell-old", "2": "elastic-shell-eas", "3": "elastic-shell-ans"}
RIGID_DOFS = ("Rx", "Ry", "Rz", "Ru", "Rv", "Rw")
RIGID_LOADS = {"follower force": "rigid_follower_force", "follower moment": "rigid_follower_moment"}
RIGID_ICS = ("initial_rigid_velocity", "initial_rigid_angular_velocity")
CONTACT_NAMES = {"facet-to-facet sliding": "sliding-facet-on-facet",
                 "sliding_with_gaps": "sliding-node-on-facet"}
# what a domain is where nothing is said, by its material and module
DEFAULT_TYPES = ("rigid-solid", "rigid-shell", "linear-truss", "remodeling-solid", "biphasic-solid",
                 "biphasic-shell", "biphasic-solute-solid", "biphasic-solute-shell", "triphasic-solid",
                 "multiphasic-solid", "multiphasic-shell")
LINES = ("line2", "line3", "truss2")
SOLID_TYPES = {"three-field-solid": {"three_field": "on"}, "elastic-solid": {"three_field": "off"},
               "three-field-shell": {"three_field": "on"}, "ut4-solid": {"elem_type": "ut4"}}
SHELL_TYPES = {"elastic-shell-eas": {"elem_type": "q4eas"}, "elastic-shell-ans": {"elem_type": "q4ans"},
               "elastic-shell": {"three_field": "off"}}


# -- up
def up(root: Tag) -> None:
    """Changes a 3.0 tree to 4.0 in place."""
    root.attrs["version"] = "4.0"
    names = materials(root)
    module = root.child("Module")
    kind = (module.get("type") if module is not None else None) or "solid"
    for mesh in root.all("Geometry"):
        mesh.name = "Mesh"
    for mesh in root.all("Mesh"):
        sets_up(mesh)
    shell = ""
    for stage in stages(root):
        for control in stage.all("Control"):
            shell = control_up(control, kind) or shell
        for s in stage.all("Boundary"):
            s.children = [new for bc in s for new in bc_up(bc, names, shell)]
        for s in stage.all("Initial"):
            for ic in s:
                ic_up(ic)
        for s in stage.all("Rigid"):
            s.children = [new for c in s for new in rigid_up(c, names)]
        contact_up(stage)
        for s in stage.all("Constraints"):
            for c in s:
                bodies_up(c, names)
    for s in root.all("MeshData"):
        for d in s:
            map_up(d)
    shapes = {e.get("name"): e.get("type") for mesh in root.all("Mesh") for e in mesh.all("Elements")}
    for s in root.all("MeshDomains"):
        for d in s:
            if shapes.get(d.get("name")) in LINES:
                d.name = "BeamDomain"
            domain_up(d, SHELLS.get(shell))


def sets_up(mesh: Tag) -> None:
    known: dict[str, str] = {}
    for s in mesh:
        if s.name in ("NodeSet", "ElementSet"):
            if s.children or s.table is not None:
                words = [w for c in s.all("node_list") for w in c.text.replace(",", " ").split()]
                words += listed(s)
                words += [known.get(c.get("node_set") or c.get("set") or "", "") for c in s.all("NodeSet")]
                s.text, s.children, s.table = ",".join(w for w in words if w), [], None
            if s.name == "NodeSet":
                known[s.get("name") or ""] = s.text


def control_up(control: Tag, module: str) -> str:
    """Returns the shell formulation that the control asks for, if any."""
    solver = control.child("solver")
    shell = take(control, "shell_formulation")
    if shell is None and solver is not None:
        shell = take(solver, "shell_formulation")
    analysis = control.child("analysis")
    if analysis is not None:
        analysis.text = analysis.text.strip().upper().replace("STEADY_STATE", "STEADY-STATE")
    if solver is not None:
        solver.attrs.setdefault("type", module)
        solver_up(solver, module)
    stepper = control.child("time_stepper")
    if stepper is not None:
        stepper.attrs.setdefault("type", "default")
    return shell.text.strip() if shell is not None else ""


def solver_up(solver: Tag, module: str) -> None:
    flat = {new: take(solver, old) for old, new in QN.items()}
    name = take(solver, "qnmethod")
    given = {k: v for k, v in flat.items() if v is not None}
    if name is None and not given:
        return
    qn = solver.child("qn_method")
    if qn is None:
        qn = Tag("qn_method", {"type": QN_DEFAULT.get(module, "Broyden")})
        solver.children.append(qn)
    if name is not None:
        word = name.text.strip().lower()
        full = next((k for k in QN_NAMES if word and k.startswith(word)), word)
        qn.attrs["type"] = QN_NAMES.get(full, name.text.strip())
    for new, v in given.items():
        v.name = new
        qn.children.append(v)


def bc_up(bc: Tag, names: dict[str, str], shell: str) -> list[Tag]:
    kind = bc.get("type")
    if kind == "fix":
        return fix_up(bc)
    if kind == "prescribe":
        prescribe_up(bc)
    elif kind == "rigid":
        body_name(bc, "rb", names)
        if shell == "0" and bc.child("clamp_shells") is None:
            bc.children.append(leaf("clamp_shells", "0"))
    return [bc]


def fix_up(bc: Tag) -> list[Tag]:
    """One condition for each group of dofs."""
    given = dofs.parse(text(bc, "dofs") or text(bc, "dof"))
    if given is None:
        return [bc]
    out: list[Tag] = []
    for group in dofs.GROUPS:
        own = [d for d in given if d in group.dofs]
        if not own:
            continue
        if group.fixed is None:
            bc = Tag("bc", dict(bc.attrs), children=[leaf("dofs", ",".join(own))], line=bc.line, doc=bc.doc)
            out.append(bc)
            continue
        new = Tag("bc", {**bc.attrs, "type": group.fixed}, line=bc.line, doc=bc.doc)
        if out and "name" in bc.attrs:
            new.attrs["name"] = f'{bc.attrs["name"]}_{len(out) + 1}'
        if group.flag(own[0]) == "c_dof":
            new.children = [leaf("c_dof", ",".join(own))]
        elif group.named:
            new.children = [leaf(group.flag(d), "1" if d in own else "0") for d in group.dofs]
        out.append(new)
    return out


def prescribe_up(bc: Tag) -> None:
    dof = text(bc, "dof")
    group = dofs.BY_DOF.get("T" if dof == "t" else dof)
    if group is None or group.prescribed is None:
        return
    bc.attrs["type"] = group.prescribed
    scale = bc.child("scale")
    if scale is not None:
        scale.name = "value"
    if not group.named:
        take(bc, "dof")


def ic_up(ic: Tag) -> None:
    if ic.get("type") != "init_dof":
        return
    dof = text(ic, "dof")
    group = dofs.BY_DOF.get("T" if dof == "t" else dof)
    if group is not None and group.initial is not None:
        ic.attrs["type"] = group.initial
        if not group.named:
            take(ic, "dof")


def body_name(tag: Tag, child: str, names: dict[str, str]) -> None:
    c = tag.child(child)
    if c is not None and c.text.strip() in names:
        c.text = names[c.text.strip()]


def bodies_up(c: Tag, names: dict[str, str]) -> None:
    for child in ("body_a", "body_b", "rb", "rbA", "rbB"):
        body_name(c, child, names)


def rigid_dof(word: str) -> str:
    """"Rx".."Rw", also by number."""
    return RIGID_DOFS[int(word)] if word.isascii() and word.isdigit() and int(word) < 6 else word


def rigid_up(c: Tag, names: dict[str, str]) -> list[Tag]:
    bodies_up(c, names)
    if c.name != "rigid_constraint":
        return [c]
    kind = c.get("type")
    if kind == "fix":
        c.name, c.attrs["type"] = "rigid_bc", "rigid_fixed"
        found = take(c, "dofs")
        words = [rigid_dof(w) for w in (found.text if found else "").replace(",", " ").split()]
        c.children += [leaf(f"{d}_dof", "1" if d in words else "0") for d in RIGID_DOFS]
    elif kind == "prescribe":
        dof = rigid_dof(text(c, "dof"))
        c.name = "rigid_bc"
        c.attrs["type"] = "rigid_displacement" if dof in RIGID_DOFS[:3] else "rigid_rotation"
        set_child(c, "dof", {"Rx": "x", "Ry": "y", "Rz": "z"}.get(dof, dof))
    elif kind == "force":
        dof = rigid_dof(text(c, "dof"))
        c.name = "rigid_load"
        c.attrs["type"] = "rigid_force" if dof in RIGID_DOFS[:3] else "rigid_moment"
        set_child(c, "dof", dof)
    elif kind in RIGID_ICS:
        c.name = "rigid_ic"
    elif kind in RIGID_LOADS:
        c.name, c.attrs["type"] = "rigid_load", RIGID_LOADS[kind]
    else:
        c.name = "rigid_bc"
    return [c]


def contact_up(stage: Tag) -> None:
    for s in stage.all("Contact"):
        for c in list(s):
            c.attrs["type"] = CONTACT_NAMES.get(c.get("type") or "", c.get("type") or "")
            if c.get("type") in ("rigid_wall", "linear constraint"):
                s.children.remove(c)
                c.name = "constraint"
                section(stage, "Constraints", ("Contact", "Loads", "Boundary")).children.append(c)
    drop_empty(stage, ("Contact",))


def map_up(d: Tag) -> None:
    rename(d, "datatype", "data_type")
    generator = pop(d, "generator")
    if generator:
        d.attrs["type"] = generator
        if "var" in d.attrs:
            rename(d, "var", "name")
    elif "var" in d.attrs:
        rename(d, "var", "type")


def domain_up(d: Tag, shell: str | None) -> None:
    three = pop(d, "three_field").lower()
    elem = d.get("elem_type") or ""
    if elem in ("q4eas", "q4ans", "ut4"):
        del d.attrs["elem_type"]
        d.attrs["type"] = "ut4-solid" if elem == "ut4" else f"elastic-shell-{elem[2:]}"
    elif three in ("on", "1", "true"):
        d.attrs["type"] = "three-field-solid" if d.name == "SolidDomain" else "three-field-shell"
    elif three:
        d.attrs["type"] = "elastic-solid" if d.name == "SolidDomain" else "elastic-shell"
    elif d.name == "ShellDomain" and shell is not None and "type" not in d.attrs:
        d.attrs["type"] = shell
