"""Versions 1.0-1.2 to 2.0, and 2.0 to 1.2.

Facts from FEBio 4.11's readers (FEBioXML): each element named its own type and material; there were no
sets, so every condition listed its nodes or facets; contact and springs stood in <Boundary>.
"""

from __future__ import annotations

from febkit.model import InputError

from .document import Tag
from .edit import drop_empty, leaf, listed, pop, section, stages
from .mesh import FACETS, label, node_count

MODULES = {"poro": "biphasic"}
# loads on facets, and the parameter that the facets' scale multiplies
SURFACE_LOADS = {"pressure": "pressure", "normal_traction": "traction", "fluidflux": "flux",
                 "heatflux": "flux", "fluid_pressure": "pressure"}
JOINTS = ("rigid joint", "rigid spring", "rigid damper", "rigid angular damper")


# -- up
def up(root: Tag) -> None:
    """Changes a 1.x tree to 2.0 in place."""
    root.attrs["version"] = "2.0"
    module = root.child("Module")
    if module is not None:
        module.attrs["type"] = MODULES.get(module.get("type") or "", module.get("type") or "solid")
    for g in root.all("Geometry"):
        g.children = [new for c in g for new in (elements_up(c) if c.name == "Elements" else [c])]
    for stage in stages(root):
        for s in stage.all("Boundary"):
            s.children = [new for c in s for new in boundary_up(c, stage)]
        for s in stage.all("Loads"):
            s.children = [new for c in s for new in load_up(c)]
        for s in stage.all("Constraints"):
            for c in s:
                if c.name == "rigid_body":
                    c.children = [rigid_up(r) for r in c]
        drop_empty(stage, ("Boundary",))


def elements_up(c: Tag) -> list[Tag]:
    """One <Elements> for each material and shape, in order of first appearance."""
    groups: dict[tuple[str, str], Tag] = {}
    for e in c:
        if node_count(e.name) is None:
            raise InputError(f"unknown element type <{e.name}>", e.where)
        key = (e.need("mat"), e.name)
        if key not in groups:
            name = f"Part{len(groups) + 1}"
            attrs = {"type": e.name, "mat": key[0], "elset": name}
            groups[key] = Tag("Elements", attrs, line=e.line, doc=e.doc)
        groups[key].children.append(Tag("elem", {"id": e.need("id")}, e.text, line=e.line, doc=e.doc))
    return list(groups.values())


def boundary_up(c: Tag, stage: Tag) -> list[Tag]:
    if c.name in ("fix", "prescribe") and "bc" not in c.attrs:
        return grouped(c, c.name, {k: v for k, v in c.attrs.items() if k == "type"})
    if c.name == "contact":
        joint = c.get("type") in JOINTS
        place = section(stage, "Constraints" if joint else "Contact", ("Boundary",))
        c.name = "constraint" if joint else "contact"
        place.children.append(c)
        return []
    if c.name == "spring":
        section(stage, "Discrete", ("Boundary",)).children.append(c)
        return []
    if c.name in ("force", *SURFACE_LOADS):  # 1.0 had loads here
        section(stage, "Loads", ("Boundary",)).children += load_up(c)
        return []
    return [c]


def grouped(c: Tag, name: str, attrs: dict[str, str]) -> list[Tag]:
    """Rows <node id bc lc>value</node>, one tag for each bc and lc."""
    groups: dict[tuple[str, str], Tag] = {}
    for r in c:
        key = (r.need("bc"), r.get("lc") or "")
        if key not in groups:
            own = {"bc": key[0]} | ({"lc": key[1]} if key[1] else {}) | attrs
            groups[key] = Tag(name, own, line=r.line, doc=r.doc)
        groups[key].children.append(Tag("node", {"id": r.need("id")}, r.text, line=r.line, doc=r.doc))
    return list(groups.values())


def load_up(c: Tag) -> list[Tag]:
    if c.name == "force":
        return grouped(c, "nodal_load", {})
    if c.name == "body_force":
        c.name = "body_load"
        c.attrs.setdefault("type", "const")
        return [c]
    if c.name in ("nodal_load", "surface_load", "edge_load", "body_load"):
        return [c]
    if c.name not in SURFACE_LOADS:
        if any(r.name in FACETS for r in c):
            raise InputError(f"<{c.name}> of version 1 has no counterpart in version 4.0", c.where)
        c.attrs["type"], c.name = c.name, "body_load"
        return [c]
    return surface_load_up(c)


def surface_load_up(c: Tag) -> list[Tag]:
    groups: dict[tuple[str, str], Tag] = {}
    parameter = SURFACE_LOADS[c.name]
    for f in c:
        key = (f.get("scale") or "1", f.get("lc") or "")
        if key not in groups:
            value = leaf(parameter, key[0], **({"lc": key[1]} if key[1] else {}))
            extra = [leaf("linear", "1")] if c.name == "pressure" and c.get("type") == "linear" else []
            groups[key] = Tag("surface_load", {"type": c.name}, children=[value, *extra, Tag("surface")],
                              line=c.line, doc=c.doc)
        groups[key].children[-1].children.append(Tag(f.name, {}, f.text, line=f.line, doc=f.doc))
    return list(groups.values())


def rigid_up(r: Tag) -> Tag:
    kind, _, axis = r.name.partition("_")
    if kind not in ("trans", "rot") or axis not in ("x", "y", "z"):
        return r
    attrs = {"bc": axis if kind == "trans" else f"R{axis}"}
    new = Tag(r.get("type") or "fixed", attrs, r.text, line=r.line, doc=r.doc)
    if r.get("lc"):
        new.attrs["lc"] = r.need("lc")
    if r.get("relative") == "true":
        new.attrs["type"] = "relative"
    return new


# -- down
def down(root: Tag, notes: list[str]) -> None:
    """Changes a 2.0 tree to 1.2 in place; ``notes`` receives what 1.2 cannot say."""
    root.attrs["version"] = "1.2"
    nodes: dict[str, list[str]] = {}
    facets: dict[str, list[Tag]] = {}
    elements: dict[str, list[str]] = {}
    for g in root.all("Geometry"):
        geometry_down(g, nodes, facets, elements)
    used: set[str] = set()
    for stage in stages(root):
        for s in stage.all("Boundary"):
            s.children = [new for c in s for new in boundary_down(c, nodes, used)]
        for s in stage.all("Loads"):
            s.children = [new for c in s for new in load_down(c, nodes, facets, used, notes)]
        contact_down(stage, facets, used)
        for s in stage.all("Constraints"):
            for c in s:
                if c.name == "rigid_body":
                    c.children = [new for r in c for new in rigid_down(r, notes)]
                for f in c.all("surface"):
                    used.add(f.get("set") or "")
                    f.children = _facets(facets, pop(f, "set"))
        for s in stage.all("Discrete"):
            springs = [c for c in s if c.name == "spring"]
            section(stage, "Boundary", ("Geometry",)).children += springs
            notes += [f"<{c.name}> in <Discrete>: version 1.2 does not have it"
                      for c in s if c.name != "spring"]
        stage.children = [c for c in stage if c.name != "Discrete"]
    for s in root.all("Output"):
        for entry in (e for log in s.all("logfile") for e in log):
            own = {**nodes, **elements}.get(pop(entry, "set") or pop(entry, "elset"))
            if own is not None:
                entry.text = ",".join(own)
    lost = sorted((nodes.keys() | facets.keys()) - used - {""})
    if lost:
        notes.append("sets that no condition uses: version 1.2 has no sets: " + ", ".join(lost))


def geometry_down(g: Tag, nodes: dict[str, list[str]], facets: dict[str, list[Tag]],
                  elements: dict[str, list[str]]) -> None:
    flat = Tag("Elements", line=g.line, doc=g.doc)
    kept: list[Tag] = []
    for c in g:
        if c.name == "Nodes":
            if c.get("set"):
                nodes[c.need("set")] = listed(c)
            c.attrs = {}
            kept.append(c)
        elif c.name == "NodeSet":
            nodes[c.need("name")] = listed(c)
        elif c.name in ("Surface", "Edge"):
            facets[c.need("name")] = _rows(c)
        elif c.name == "ElementSet":
            elements[c.need("name")] = listed(c)
        elif c.name == "Elements":
            elements[c.get("elset") or ""] = listed(c)
            for e in _rows(c):
                flat.children.append(Tag(c.need("type"), {"id": e.need("id"), "mat": c.need("mat")}, e.text))
        else:
            kept.append(c)
    flat.children.sort(key=label)
    at = max((i for i, c in enumerate(kept) if c.name == "Nodes"), default=-1) + 1
    g.children = [*kept[:at], flat, *kept[at:]]


def _rows(c: Tag) -> list[Tag]:
    if c.table is None:
        return c.children
    t = c.table
    return [leaf(t.tag, ",".join(str(int(x)) for x in v), id=str(i))
            for i, v in zip(t.labels.tolist(), t.values.tolist())]


def _facets(facets: dict[str, list[Tag]], name: str) -> list[Tag]:
    return [Tag(f.name, {"id": str(i)}, f.text) for i, f in enumerate(facets.get(name, []), 1)]


def boundary_down(c: Tag, nodes: dict[str, list[str]], used: set[str]) -> list[Tag]:
    if c.name not in ("fix", "prescribe"):
        return [c]
    own = nodes.get(c.get("set") or "")
    used.add(c.get("set") or "")
    rows = listed(c) if own is None else own
    bc = (c.get("bc") or "").replace(",", "")
    if c.name == "fix":
        return [Tag("fix", children=[leaf("node", id=i, bc=bc) for i in rows])]
    lc = {"lc": c.need("lc")} if c.get("lc") else {"lc": "0"}
    value = c.get("scale") or "1"
    attrs = {"type": c.need("type")} if c.get("type") else {}
    return [Tag("prescribe", attrs, children=[leaf("node", value, id=i, bc=bc, **lc) for i in rows])]


def load_down(c: Tag, nodes: dict[str, list[str]], facets: dict[str, list[Tag]], used: set[str],
              notes: list[str]) -> list[Tag]:
    if c.name == "nodal_load":
        used.add(c.get("set") or "")
        own = nodes.get(c.get("set") or "", [])
        scale, bc, lc = c.get("scale") or "1", c.need("bc"), c.get("lc") or "0"
        rows = [leaf("node", scale, id=i, bc=bc, lc=lc) for i in own]
        return [Tag("force", children=rows)]
    if c.name == "body_load":
        c.name = "body_force"
        return [c]
    kind = c.get("type") or ""
    surface = c.child("surface")
    if kind not in SURFACE_LOADS or surface is None:
        notes.append(f'<{c.name} type="{kind}">: version 1.2 does not have it')
        return []
    used.add(surface.get("set") or "")
    value = c.child(SURFACE_LOADS[kind])
    loaded: list[Tag] = []
    for f in _facets(facets, surface.get("set") or ""):
        f.attrs |= {"lc": (value.get("lc") if value is not None else None) or "0",
                    "scale": value.text.strip() if value is not None else "1"}
        loaded.append(f)
    return [Tag(kind, children=loaded)]


def contact_down(stage: Tag, facets: dict[str, list[Tag]], used: set[str]) -> None:
    for s in stage.all("Contact"):
        for c in s:
            for f in c.all("surface"):
                used.add(f.get("set") or "")
                f.children = _facets(facets, pop(f, "set"))
        section(stage, "Boundary", ("Geometry",)).children += s.children
    stage.children = [c for c in stage if c.name != "Contact"]


def rigid_down(r: Tag, notes: list[str]) -> list[Tag]:
    bc = r.get("bc") or ""
    if r.name not in ("prescribed", "fixed", "force"):
        notes.append(f"<rigid_body><{r.name}>: version 1.2 does not have it")
        return []
    name = f"rot_{bc[1:]}" if bc.startswith("R") else f"trans_{bc}"
    attrs = {"type": r.name}
    if r.name != "fixed":
        attrs["lc"] = r.get("lc") or "0"
        if r.get("type") == "relative":
            attrs["relative"] = "true"
    return [Tag(name, attrs, r.text)]
