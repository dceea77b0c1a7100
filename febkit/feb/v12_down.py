"""Version 2.0 to 1.2: what one step down does (see :mod:`.v12` for the way up)."""

from __future__ import annotations

from .document import Tag
from .edit import leaf, listed, pop, same_text, section, stages
from .mesh import label
from .v12 import SURFACE_LOADS


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
    attrs = _linear(c, kind, notes)
    value = c.child(SURFACE_LOADS[kind])
    loaded: list[Tag] = []
    for f in _facets(facets, surface.get("set") or ""):
        f.attrs |= {"lc": (value.get("lc") if value is not None else None) or "0",
                    "scale": value.text.strip() if value is not None else "1"}
        loaded.append(f)
    return [Tag(kind, attrs, children=loaded)]


def _linear(c: Tag, kind: str, notes: list[str]) -> dict[str, str]:
    """A pressure's type; other parameters that say anything are lost."""
    attrs: dict[str, str] = {}
    for p in c:
        if p.name in ("surface", SURFACE_LOADS[kind]) or same_text(p.text.strip(), "0"):
            continue
        if p.name == "linear" and kind == "pressure":
            attrs["type"] = "linear"
        elif p.name != "symmetric_stiffness":
            notes.append(f'<surface_load type="{kind}"><{p.name}>: version 1.2 does not have it')
    return attrs


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
