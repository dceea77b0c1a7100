"""Version 2.0 to 2.5 and back.

Facts from FEBio 4.11's readers (FEBioXML): lists of nodes and facets stood inside the conditions; a set was
``set=``, a part ``elset=``; contact named its surfaces "master" and "slave"; springs were <spring>;
element data lay in <Geometry>.
"""

from __future__ import annotations

from febkit.model import InputError

from . import dofs
from .document import Tag
from .edit import drop_empty, fresh, leaf, listed, pop, rename, section, stages
from .mesh import FACETS, LINES

SPRINGS = {"": "linear spring", "linear": "linear spring",
           "tension-only linear": "tension-only linear spring", "nonlinear": "nonlinear spring"}
INITIAL = {"temperature": "T", "fluid_pressure": "p", "shell_fluid_pressure": "q", "dilatation": "ef"}
CONTACTS = {"sliding_with_gaps": "sliding-node-on-facet", "facet-to-facet sliding": "sliding-facet-on-facet",
            "sliding2": "sliding-biphasic", "sliding3": "sliding-biphasic-solute",
            "sliding-tension-compression": "sliding-elastic", "tied": "tied-node-on-facet"}
WORDS = {"flip_master": "flip_secondary", "flip_slave": "flip_primary"}
ELEMENT_DATA = {"fiber": "fiber", "mat_axis": "mat_axis", "thickness": "shell thickness"}


class Names:
    """Adds sets to the geometry under names of their own."""

    def __init__(self, root: Tag) -> None:
        self.geometry = section(root, "Geometry", ("Material",))
        self.used = {c.get("name") or c.get("elset") or "" for c in self.geometry}

    def add(self, kind: str, base: str, rows: list[Tag], like: Tag) -> str:
        name = fresh(base, self.used)
        new = Tag(kind, {"name": name}, children=rows, line=like.line, doc=like.doc)
        new.table = like.table if not rows else None
        self.geometry.children.append(new)
        return name

    def nodes(self, like: Tag, base: str) -> str:
        return self.add("NodeSet", base, [leaf("n", id=i) for i in listed(like)], like)

    def surface(self, like: Tag, base: str) -> str:
        return self.add("Surface", base, _numbered(like, FACETS), like)


def _numbered(like: Tag, kinds: dict[str, int]) -> list[Tag]:
    rows: list[Tag] = []
    for c in like:
        if c.name not in kinds:
            raise InputError(f"<{c.name}> does not belong in <{like.name}>", c.where)
        rows.append(Tag(c.name, {"id": str(len(rows) + 1)}, c.text, line=c.line, doc=c.doc))
    return rows


# -- up
def up(root: Tag) -> None:
    """Changes a 2.0 tree to 2.5 in place."""
    root.attrs["version"] = "2.5"
    names = Names(root)
    elements: dict[str, list[str]] = {}
    parts: list[str] = []
    for g in root.all("Geometry"):
        for c in g:
            if c.name == "Nodes":
                rename(c, "set", "name")
            elif c.name == "Elements":
                rename(c, "elset", "name")
                if not c.get("name"):
                    c.attrs["name"] = fresh("Part", names.used)
                parts.append(c.need("name"))
                elements[c.need("name")] = listed(c)
            elif c.name == "ElementSet":
                elements[c.get("name") or ""] = listed(c)
    element_data_up(root, elements, parts)
    for stage in stages(root):
        for s in stage.all("Boundary"):
            s.children = [new for c in s for new in boundary_up(c, names, root)]
        for s in stage.all("Initial"):
            s.children = [initial_up(c, names) for c in s]
        for s in stage.all("Loads"):
            s.children = [new for c in s for new in load_up(c, names)]
        contact_up(stage, names)
        for s in stage.all("Constraints"):
            for c in s:
                constraint_up(c, names)
        discrete_up(stage, names)
    for s in root.all("Output"):
        for entry in (e for log in s.all("logfile") for e in log):
            rename(entry, "set", "node_set")
            rename(entry, "elset", "elem_set")
    order_up(root)


def order_up(root: Tag) -> None:
    """The module comes first."""
    module = root.child("Module")
    if module is None:
        root.children.insert(0, Tag("Module", {"type": "solid"}, line=root.line, doc=root.doc))
    elif root.children[0] is not module:
        root.children.remove(module)
        root.children.insert(0, module)


def element_data_up(root: Tag, elements: dict[str, list[str]], parts: list[str]) -> None:
    """<ElementData> of <Geometry> becomes maps, one for each part and kind of data."""
    part_of = {i: (name, n) for name in parts for n, i in enumerate(elements[name], 1)}
    maps: dict[tuple[str, str], Tag] = {}
    for g in root.all("Geometry"):
        for data in g.all("ElementData"):
            g.children.remove(data)
            for c in data:
                places = [part_of.get(c.get("id") or "")] if c.name == "element" else [
                    (c.get("set") or "", n) for n in range(1, len(elements.get(c.get("set") or "", [])) + 1)]
                for value in c:
                    for place in places:
                        _put(maps, place, value, c)
    if maps:
        section(root, "MeshData", ("Geometry",)).children += maps.values()


def _put(maps: dict[tuple[str, str], Tag], place: tuple[str, int] | None, value: Tag, c: Tag) -> None:
    if place is None:
        raise InputError(f'<{c.name} id="{c.get("id")}"> refers to an element that does not exist', c.where)
    var = ELEMENT_DATA.get(value.name)
    if var is None:
        raise InputError(f"<{value.name}> in <ElementData> has no counterpart in version 4.0", value.where)
    part, lid = place
    default = Tag("ElementData", {"var": var, "elem_set": part}, line=c.line, doc=c.doc)
    rows = maps.setdefault((part, var), default)
    below = list(value.children)
    rows.children.append(Tag("elem", {"lid": str(lid)}, value.text, below, value.line, value.doc))


def boundary_up(c: Tag, names: Names, root: Tag) -> list[Tag]:
    if c.name == "fix":
        given = dofs.parse(c.need("bc"))
        if given is None:
            raise InputError(f'<fix bc="{c.get("bc")}"> names no degrees of freedom', c.where)
        c.attrs["bc"] = ",".join(given)
        _set_up(c, names, "fix")
        return [c]
    if c.name == "prescribe":
        return prescribe_up(c, names, root)
    return [c]


def _set_up(c: Tag, names: Names, base: str) -> None:
    if "set" in c.attrs:
        rename(c, "set", "node_set")
    elif "node_set" not in c.attrs:
        c.attrs["node_set"] = names.nodes(c, base)
        c.children, c.table = [], None


def prescribe_up(c: Tag, names: Names, root: Tag) -> list[Tag]:
    values = [r.text.strip() for r in c]
    if c.table is not None:
        values = [repr(v) for v in c.table.values[:, 0].tolist()]
    relative = pop(c, "type") == "relative"
    lc, scale = pop(c, "lc"), pop(c, "scale", "1")
    if c.get("bc") == "t":
        c.attrs["bc"] = "T"
    if not values and c.text.strip():
        scale = c.text.strip()
    uniform = {v or scale for v in values} or {scale}
    _set_up(c, names, "prescribe")
    child = leaf("scale", next(iter(uniform)), **({"lc": lc} if lc else {}))
    if len(uniform) > 1:
        data = fresh(f'{c.need("node_set")}_value', names.used)
        rows = [leaf("node", v or scale, lid=str(i)) for i, v in enumerate(values, 1)]
        maps = section(root, "MeshData", ("Geometry",))
        maps.children.append(Tag("NodeData", {"name": data, "node_set": c.need("node_set")}, children=rows))
        child = leaf("scale", data, type="map", **({"lc": lc} if lc else {}))
    c.text = ""
    c.children = [child] + ([leaf("relative", "1")] if relative else [])
    return [c]


def initial_up(c: Tag, names: Names) -> Tag:
    if c.name in ("ic", "init", "rigid_body"):
        return c
    values = {r.text.strip() for r in c}
    if c.table is not None:
        values = {",".join(map(repr, v)) for v in c.table.values.tolist()}
    if len(values) != 1:
        raise InputError(f"<{c.name}> with a value for each node is not read: use one value", c.where)
    name = names.nodes(c, c.name)
    if c.name == "velocity":
        new = Tag("ic", {"type": "velocity", "node_set": name}, line=c.line, doc=c.doc)
    else:
        solute = c.get("sol") or "1"
        solutes = {"concentration": f"c{solute}", "shell_concentration": f"d{solute}"}
        dof = INITIAL.get(c.name) or solutes.get(c.name)
        if dof is None:
            raise InputError(f"<{c.name}> does not belong in <Initial>", c.where)
        new = Tag("init", {"bc": dof, "node_set": name}, line=c.line, doc=c.doc)
    new.children = [leaf("value", values.pop())]
    return new


def load_up(c: Tag, names: Names) -> list[Tag]:
    if c.name == "nodal_load":
        return nodal_load_up(c, names)
    if c.name in ("surface_load", "edge_load"):
        kind, kinds = ("surface", FACETS) if c.name == "surface_load" else ("edge", LINES)
        for s in c.all(kind):
            c.children.remove(s)
            if s.get("set"):
                c.attrs[kind] = s.need("set")
            elif kind == "surface":
                c.attrs[kind] = names.surface(s, c.get("name") or "surface_load")
            else:
                c.attrs[kind] = names.add("Edge", c.get("name") or "edge_load", _numbered(s, kinds), s)
    return [c]


def nodal_load_up(c: Tag, names: Names) -> list[Tag]:
    lc = pop(c, "lc")
    attrs = {"lc": lc} if lc else {}
    if c.get("set"):
        rename(c, "set", "node_set")
        c.children = [leaf("scale", pop(c, "scale", c.text.strip() or "1"), **attrs)]
        c.text = ""
        return [c]
    groups: dict[str, list[Tag]] = {}
    for r in c:
        groups.setdefault(r.text.strip() or "1", []).append(r)
    if c.table is not None:
        for i, v in zip(c.table.labels.tolist(), c.table.values[:, 0].tolist()):
            groups.setdefault(repr(v), []).append(leaf("node", id=str(i)))
    out = []
    for value, rows in groups.items():
        name = names.nodes(Tag(c.name, children=rows, line=c.line, doc=c.doc), "nodal_load")
        out.append(Tag("nodal_load", {"bc": c.need("bc"), "node_set": name},
                       children=[leaf("scale", value, **attrs)], line=c.line, doc=c.doc))
    return out


def contact_up(stage: Tag, names: Names) -> None:
    for s in stage.all("Contact"):
        for c in list(s):
            kind = c.get("type") or ""
            if kind == "rigid":
                s.children.remove(c)
                section(stage, "Boundary", ("Contact",)).children += rigid_up(c, names)
            elif kind == "linear constraint":
                s.children.remove(c)
                c.name = "constraint"
                section(stage, "Constraints", ("Contact",)).children.append(c)
            else:
                c.attrs["type"] = CONTACTS.get(kind, kind)
                surfaces_up(c, names)
    drop_empty(stage, ("Contact",))


def rigid_up(c: Tag, names: Names) -> list[Tag]:
    groups: dict[str, list[Tag]] = {}
    for r in c:
        groups.setdefault(r.need("rb"), []).append(r)
    out = []
    for rb, rows in groups.items():
        name = names.nodes(Tag(c.name, children=rows, line=c.line, doc=c.doc), f"rigid_{rb}")
        out.append(Tag("rigid", {"rb": rb, "node_set": name}, line=c.line, doc=c.doc))
    return out


def surfaces_up(c: Tag, names: Names) -> None:
    sides: dict[str, str] = {}
    for s in c.all("surface"):
        c.children.remove(s)
        if s.get("format") == "element face":
            message = 'surfaces of format="element face" are not read: list the nodes of the faces'
            raise InputError(message, s.where)
        side = {"master": "secondary", "slave": "primary"}.get(s.get("type") or "slave", "primary")
        sides[side] = s.get("set") or names.surface(s, f"contact_{side}")
    for p in c:
        p.name = WORDS.get(p.name, p.name)
    if c.get("type") == "rigid_wall":
        c.attrs["surface"] = sides.get("primary", "")
    elif sides:
        rows = [leaf(k, v) for k, v in sides.items()]
        c.attrs["surface_pair"] = fresh(c.get("name") or "contact", names.used)
        names.geometry.children.append(Tag("SurfacePair", {"name": c.attrs["surface_pair"]}, children=rows))


def constraint_up(c: Tag, names: Names) -> None:
    for s in c.all("surface"):
        c.children.remove(s)
        c.attrs["surface"] = s.get("set") or names.surface(s, c.get("name") or "constraint")


def discrete_up(stage: Tag, names: Names) -> None:
    for s in stage.all("Discrete"):
        out: list[Tag] = []
        count = 0
        for c in s:
            if c.name != "spring":
                out.append(c)
                continue
            count += 1
            kind = c.get("type") or ""
            pairs = [leaf("delem", r.text.strip()) for r in c.all("node")]
            name = fresh(c.get("name") or "springs", names.used)
            names.geometry.children.append(Tag("DiscreteSet", {"name": name}, children=pairs))
            attrs = {"id": str(count), "name": name, "type": SPRINGS.get(kind, kind)}
            rest = [r for r in c if r.name != "node"]
            out.append(Tag("discrete_material", attrs, children=rest, line=c.line, doc=c.doc))
            out.append(Tag("discrete", {"dmat": str(count), "discrete_set": name}, line=c.line, doc=c.doc))
        s.children = out
