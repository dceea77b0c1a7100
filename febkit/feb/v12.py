"""Versions 1.0-1.2 to 2.0, and 2.0 to 1.2.

Facts from FEBio 4.11's readers (FEBioXML): each element named its own type and material; there were no
sets, so every condition listed its nodes or facets; contact and springs stood in <Boundary>.
"""

from __future__ import annotations

from febkit.model import InputError

from .document import Tag
from .edit import drop_empty, leaf, section, stages
from .mesh import FACETS, node_count

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
