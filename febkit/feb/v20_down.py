"""Version 2.5 to 2.0: what one step down does (see :mod:`.v20` for the way up)."""

from __future__ import annotations

from febkit.model import InputError

from .document import Tag
from .edit import drop_empty, leaf, listed, pop, rename, section, stages, text, walk
from .mesh import label
from .v20 import ELEMENT_DATA, INITIAL, SPRINGS


def down(root: Tag, notes: list[str]) -> None:
    """Changes a 2.5 tree to 2.0 in place; ``notes`` receives what 2.0 cannot say."""
    root.attrs["version"] = "2.0"
    geometry = section(root, "Geometry")
    pairs: dict[str, dict[str, str]] = {}
    springs: dict[str, list[str]] = {}
    for c in list(geometry):
        if c.name == "Nodes":
            rename(c, "name", "set")
        elif c.name == "Elements":
            rename(c, "name", "elset")
        elif c.name == "SurfacePair":
            pairs[c.need("name")] = {x.name: x.text.strip() for x in c}
            geometry.children.remove(c)
        elif c.name == "DiscreteSet":
            springs[c.need("name")] = [x.text.strip() for x in c]
            geometry.children.remove(c)
    maps_down(root, geometry, notes)
    for stage in stages(root):
        for s in stage.all("Boundary"):
            s.children = [new for c in s for new in boundary_down(c, stage, geometry, notes)]
        for s in stage.all("Initial"):
            s.children = [new for c in s for new in initial_down(c, geometry, notes)]
        for s in stage.all("Loads"):
            s.children = [c for c in s if load_down(c, notes)]
        for s in stage.all("Contact"):
            for c in s:
                contact_down(c, pairs)
        for s in stage.all("Constraints"):
            for c in s:
                if "surface" in c.attrs:
                    c.children.append(leaf("surface", set=pop(c, "surface")))
        for s in stage.all("Discrete"):
            discrete_down(s, springs, notes)
        if stage.child("MeshAdaptor") is not None:
            stage.children = [c for c in stage if c.name != "MeshAdaptor"]
            notes.append("<MeshAdaptor>: version 2.0 does not have it")
        drop_empty(stage, ("Boundary", "Initial", "Loads", "Constraints"))
    for s in root.all("Output"):
        for entry in (e for log in s.all("logfile") for e in log):
            rename(entry, "node_set", "set")
            rename(entry, "elem_set", "elset")


def maps_down(root: Tag, geometry: Tag, notes: list[str]) -> None:
    """Element maps go to <ElementData>."""
    back = {v: k for k, v in ELEMENT_DATA.items()}
    ids = {c.get("elset") or c.get("name") or "": listed(c) for c in geometry
           if c.name in ("Elements", "ElementSet")}
    rows: dict[str, Tag] = {}
    for s in root.all("MeshData"):
        for d in s:
            var = back.get(d.get("var") or "")
            if d.name != "ElementData" or var is None:
                notes.append(f'map "{d.get("name") or d.get("var")}": version 2.0 does not have it')
                continue
            own = ids.get(d.get("elem_set") or "", [])
            for lid, text_, children in _rows(d):
                if not 1 <= lid <= len(own):
                    raise InputError(f'row lid="{lid}" lies outside "{d.get("elem_set")}"', d.where)
                element = rows.setdefault(own[lid - 1], Tag("element", {"id": own[lid - 1]}))
                element.children.append(Tag(var, text=text_, children=children))
    root.children = [c for c in root if c.name != "MeshData"]
    if rows:
        geometry.children.append(Tag("ElementData", children=list(rows.values())))


def _rows(d: Tag) -> list[tuple[int, str, list[Tag]]]:
    if d.table is not None:
        labels, values = d.table.labels.tolist(), d.table.values.tolist()
        return [(i, ",".join(map(repr, v)), []) for i, v in zip(labels, values)]
    return [(label(r, "lid"), r.text.strip(), r.children) for r in d]


def boundary_down(c: Tag, stage: Tag, geometry: Tag, notes: list[str]) -> list[Tag]:
    if c.name == "rigid_body":
        section(stage, "Constraints", ("Boundary",)).children.append(c)
        return []
    if c.name == "rigid":
        nodes = _set_nodes(c, geometry)
        contact = section(stage, "Contact", ("Boundary",))
        rows = [leaf("node", id=i, rb=c.need("rb")) for i in nodes]
        contact.children.append(Tag("contact", {"type": "rigid"}, children=rows))
        return []
    if c.name == "bc" or c.name not in ("fix", "prescribe", "linear_constraint"):
        notes.append(f'<{c.name} type="{c.get("type")}"> in <Boundary>: version 2.0 does not have it')
        return []
    rename(c, "node_set", "set")
    if c.name == "prescribe":
        return prescribe_down(c, notes)
    return [c]


def _set_nodes(c: Tag, geometry: Tag) -> list[str]:
    for s in geometry:
        if s.name == "NodeSet" and s.get("name") == c.get("node_set"):
            return listed(s)
        if s.name == "Nodes" and s.get("set") == c.get("node_set"):
            return listed(s)
    return []


def prescribe_down(c: Tag, notes: list[str]) -> list[Tag]:
    scale = c.child("scale")
    if scale is not None and scale.get("type") not in (None, "const"):
        notes.append(f'<prescribe bc="{c.get("bc")}" set="{c.get("set")}"> with a {scale.get("type")} value: '
                     "version 2.0 does not have it")
        return []
    attrs = dict(c.attrs)
    if scale is not None and scale.get("lc"):
        attrs["lc"] = scale.need("lc")
    attrs["scale"] = scale.text.strip() if scale is not None else "1"
    if text(c, "relative") in ("1", "true"):
        attrs["type"] = "relative"
    return [Tag("prescribe", attrs, line=c.line, doc=c.doc)]


def initial_down(c: Tag, geometry: Tag, notes: list[str]) -> list[Tag]:
    nodes = _set_nodes(c, geometry)
    rows = [leaf("node", text(c, "value"), id=i) for i in nodes]
    if c.name == "ic" and c.get("type") == "velocity":
        return [Tag("velocity", children=rows)]
    bc = c.get("bc") or ""
    name = next((k for k, v in INITIAL.items() if v == bc), None)
    if name is not None:
        return [Tag(name, children=rows)]
    if bc[:1] in ("c", "d") and bc[1:].isdigit():
        name = "concentration" if bc[0] == "c" else "shell_concentration"
        return [Tag(name, {"sol": bc[1:]}, children=rows)]
    notes.append(f'<{c.name} type="{c.get("type") or bc}"> in <Initial>: version 2.0 does not have it')
    return []


def load_down(c: Tag, notes: list[str]) -> bool:
    if c.name == "nodal_load":
        scale = c.child("scale")
        if scale is not None and scale.get("type") not in (None, "const"):
            notes.append(f'<nodal_load bc="{c.get("bc")}"> with a value that varies: '
                         "version 2.0 does not have it")
            return False
        rename(c, "node_set", "set")
        if scale is not None:
            c.attrs["scale"] = scale.text.strip()
            c.attrs["lc"] = scale.get("lc") or "0"
        c.children = []
    elif c.name in ("surface_load", "edge_load"):
        kind = c.name.split("_")[0]
        if kind in c.attrs:
            c.children.append(leaf(kind, set=pop(c, kind)))
        for p in walk(c)[1:]:
            if p.get("type") in ("map", "math"):
                notes.append(f'<{c.name} type="{c.get("type")}"> with a value that varies: '
                             "version 2.0 does not have it")
                return False
    elif c.name == "body_load":
        return body_down(c, notes)
    return True


def body_down(c: Tag, notes: list[str]) -> bool:
    if c.get("elem_set"):
        notes.append("<body_load> on an element set: version 2.0 loads the whole body")
        return False
    if c.get("type") == "body force":
        force = c.child("force")
        if force is None or force.get("type") not in (None, "vector", "const"):
            notes.append("<body_load> with a value that varies: version 2.0 does not have it")
            return False
        lc = {"lc": force.need("lc")} if force.get("lc") else {}
        c.attrs["type"] = "const"
        c.children = [leaf(d, v, **lc) for d, v in zip("xyz", force.text.replace(",", " ").split())]
    return True


def contact_down(c: Tag, pairs: dict[str, dict[str, str]]) -> None:
    c.attrs.setdefault("name", c.get("surface_pair") or "contact")
    sides = pairs.get(pop(c, "surface_pair"), {})
    for kind, side in (("master", "secondary"), ("slave", "primary")):
        if side in sides:
            c.children.append(leaf("surface", type=kind, set=sides[side]))
    if "surface" in c.attrs:
        c.children.append(leaf("surface", set=pop(c, "surface")))


def discrete_down(s: Tag, springs: dict[str, list[str]], notes: list[str]) -> None:
    found = [c for c in s if c.name == "discrete_material"]
    out = [c for c in s if c.name not in ("discrete", "discrete_material")]
    back = {v: k for k, v in SPRINGS.items()}
    for c in s:
        if c.name != "discrete":
            continue
        number = label(c, "dmat")
        if not 1 <= number <= len(found):
            raise InputError(f'<discrete dmat="{number}">: there is no such discrete material', c.where)
        material = found[number - 1]
        kind = material.get("type") or ""
        if kind not in back:
            notes.append(f'discrete material of type "{kind}": version 2.0 does not have it')
            continue
        rows = [leaf("node", p) for p in springs.get(c.get("discrete_set") or "", [])]
        attrs = {"name": c.get("discrete_set") or "springs", "type": back[kind]}
        out.append(Tag("spring", attrs, children=rows + material.children))
    s.children = out
