"""A Model to a version 4.0 tree."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

from febkit.model import Component, Domain, LoadController, LogEntry, Mesh, MeshData, Model, Output, Step
from febkit.model.mesh import Ints

from .build import DATA_KINDS, DOMAIN_KINDS, STEP_SECTIONS
from .component import tag_of
from .document import Tag
from .mesh import floats
from .table import Table

LOG_SETS = {"node_data": "node_set", "element_data": "elem_set", "domain_data": "domain"}
DOMAIN_TAGS = {kind: tag for tag, kind in DOMAIN_KINDS.items()}


def leaf(tag: str, text: object, /, **attrs: str) -> Tag:
    return Tag(tag, attrs, str(text))


def number(v: float) -> str:
    """The fewest digits that read back the same, whole numbers without a point."""
    return str(int(v)) if abs(v) < 1e15 and v == int(v) else repr(float(v))


def table(tag: str, labels: Ints, values: NDArray, attr: str = "id") -> Table:
    return Table(tag, attr, labels, values, -1, -1)


def joined(values: Iterable[int]) -> str:
    return ",".join(map(str, values))


def section(name: str, components: Iterable[Component]) -> Tag:
    return Tag(name, children=[tag_of(c) for c in components])


def mesh_tag(mesh: Mesh) -> Tag:
    out = Tag("Mesh")
    add = out.children.append
    ids = mesh.node_ids
    groups = _node_groups(mesh)
    for name, index in groups:
        tag = Tag("Nodes", {"name": name} if name else {})
        tag.table = table("node", ids[index], mesh.X[index])
        add(tag)
    scattered = mesh.node_blocks.keys() - {name for name, _ in groups} - mesh.node_sets.keys()
    for name in sorted(scattered):
        add(leaf("NodeSet", joined(ids[mesh.node_blocks[name]].tolist()), name=name))
    for b in mesh.blocks:
        tag = Tag("Elements", {"type": b.type, "name": b.name})
        tag.table = table("elem", b.ids, ids[b.conn])
        add(tag)
    for n in mesh.node_sets.values():
        add(leaf("NodeSet", joined(ids[n.nodes].tolist()), name=n.name))
    for e in mesh.edges.values():
        tag = Tag("Edge", {"name": e.name})
        tag.table = table(f"line{e.lines.shape[1]}", np.arange(1, len(e.lines) + 1), ids[e.lines])
        add(tag)
    for s in mesh.surfaces.values():
        add(_surface_tag(s.name, s.facets, s.ids, ids))
    for es in mesh.element_sets.values():
        add(leaf("ElementSet", joined(es.elements.tolist()), name=es.name))
    for d in mesh.discrete_sets.values():
        rows = [leaf("delem", joined(p)) for p in ids[d.pairs].tolist()]
        add(Tag("DiscreteSet", {"name": d.name}, children=rows))
    for p in mesh.surface_pairs.values():
        sides = [leaf("primary", p.primary), leaf("secondary", p.secondary)]
        add(Tag("SurfacePair", {"name": p.name}, children=sides))
    for name, parts in mesh.part_lists.items():
        add(leaf("PartList", ",".join(parts), name=name))
    return out


def _node_groups(mesh: Mesh) -> list[tuple[str, Ints]]:
    """Named <Nodes> groups, and the runs of nodes between them, in order."""
    out: list[tuple[str, Ints]] = []
    at = 0
    groups = [(name, g) for name, g in mesh.node_blocks.items() if len(g)]
    for name, g in sorted(groups, key=lambda item: int(item[1][0])):
        if int(g[0]) < at or (np.diff(g) != 1).any():
            continue  # no run of its own: the caller writes it as a node set
        if int(g[0]) > at:
            out.append(("", np.arange(at, int(g[0]))))
        out.append((name, g))
        at = int(g[-1]) + 1
    if at < len(mesh.node_ids):
        out.append(("", np.arange(at, len(mesh.node_ids))))
    return out


def _surface_tag(name: str, facets: Mapping[str, Ints], labels: Mapping[str, Ints], ids: Ints) -> Tag:
    tag = Tag("Surface", {"name": name})
    first = 1
    parts = []
    for kind, conn in facets.items():
        own = labels.get(kind)
        if own is None or len(own) != len(conn):
            own = np.arange(first, first + len(conn))
        first += len(conn)
        parts.append((kind, own, ids[conn]))
    if len(parts) == 1 and len(parts[0][1]):
        kind, own, conn = parts[0]
        tag.table = table(kind, own, conn)
        return tag
    rows = [(int(i), kind, row) for kind, own, conn in parts for i, row in zip(own, conn.tolist())]
    rows.sort(key=lambda r: r[0])  # facet ids give the file's order
    tag.children = [leaf(kind, joined(row), id=str(i)) for i, kind, row in rows]
    return tag


def domains_tag(model: Model) -> Tag:
    out = Tag("MeshDomains")
    out.children = [domain_tag(d) for d in model.domains]
    return out


def domain_tag(d: Domain) -> Tag:
    tag = tag_of(d.spec) if d.spec is not None else Tag(DOMAIN_TAGS[d.kind])
    tag.name = DOMAIN_TAGS[d.kind]
    rest = {k: v for k, v in tag.attrs.items() if k not in ("name", "mat", "type")}
    tag.attrs = {"name": d.block} | ({"mat": d.material} if d.material else {})
    tag.attrs |= ({"type": d.type} if d.type else {}) | rest
    return tag


def data_tag(d: MeshData) -> Tag:
    tag = tag_of(d.spec)
    kind = next(k for k, v in DATA_KINDS.items() if v[0] == d.kind)
    _, set_attr, row = DATA_KINDS[kind]
    tag.attrs[set_attr] = d.set
    if d.values is None or d.items is None:
        return tag
    tag.children = []
    if "type" not in tag.attrs and "name" not in tag.attrs:
        tag.attrs["name"] = d.name
    if tag.attrs.get("type") == "mat_axis" and d.values.shape[1] == 6:
        for i, v in zip(d.items.tolist(), d.values.tolist()):
            axes = [leaf("a", ",".join(map(number, v[:3]))), leaf("d", ",".join(map(number, v[3:])))]
            tag.children.append(Tag(row, {"lid": str(i)}, children=axes))
    elif np.isnan(d.values).any():
        for i, v in zip(d.items.tolist(), d.values.tolist()):
            tag.children.append(leaf(row, ",".join(number(x) for x in v if x == x), lid=str(i)))
    else:
        tag.table = table(row, d.items, d.values, "lid")
    return tag


def controller_tag(c: LoadController) -> Tag:
    tag = tag_of(c.spec)
    tag.name = "load_controller"
    tag.attrs = {"id": str(c.id)} | ({"name": c.name} if c.name else {}) | {"type": c.type} | {
        k: v for k, v in tag.attrs.items() if k not in ("id", "name", "type")}
    old = tag.child("points")
    if old is not None and [tuple(floats(p.text, p)) for p in old] == [tuple(p) for p in c.points]:
        return tag
    if c.points:
        points = Tag("points", children=[leaf("point", f"{number(t)},{number(v)}") for t, v in c.points])
        if old is None:
            tag.children.append(points)
        else:
            tag.children[tag.children.index(old)] = points
    return tag


def step_sections(step: Step) -> list[Tag]:
    out = [] if step.control is None else [tag_of(step.control)]
    for name, field in STEP_SECTIONS.items():
        components = getattr(step, field)
        if components:
            out.append(section(name, components))
    return out


def log_tag(entry: LogEntry) -> Tag:
    if entry.spec is not None:
        return tag_of(entry.spec)
    attr = LOG_SETS.get(entry.kind, "surface")
    attrs = {"data": entry.data}
    attrs |= {k: v for k, v in (("file", entry.file), ("name", entry.name), (attr, entry.set)) if v}
    if entry.delim != " ":
        attrs["delim"] = entry.delim
    return Tag(entry.kind, attrs, joined(entry.items))


def output_tag(output: Output) -> Tag:
    out = Tag("Output")
    if output.log or output.log_file:
        attrs = {"file": output.log_file} if output.log_file else {}
        out.children.append(Tag("logfile", attrs, children=[log_tag(e) for e in output.log]))
    if output.plot or output.plot_spec is not None:
        tag = Tag("plotfile") if output.plot_spec is None else tag_of(output.plot_spec)
        tag.attrs = {"type": output.plot_type} | {k: v for k, v in tag.attrs.items() if k != "type"}
        variables = []
        for v in output.plot:
            var = Tag("var") if v.spec is None else tag_of(v.spec)
            own = {"type": v.type if v.alias is None else f"{v.type}={v.alias}"}
            own |= {"surface": v.surface} if v.surface else {}
            var.attrs = own | {k: x for k, x in var.attrs.items() if k not in ("type", "surface")}
            variables.append(var)
        tag.children = variables + tag.children
        out.children.append(tag)
    return out


def module_tag(model: Model) -> Tag:
    if model.module_spec is not None:
        tag = tag_of(model.module_spec)
        tag.attrs["type"] = model.module
        units = tag.child("units")
        if units is not None and model.units is not None:
            units.text = model.units
            return tag
        if "units" in tag.attrs or units is not None or not model.units:
            return tag
    else:
        tag = Tag("Module", {"type": model.module})
    if model.units:
        tag.children.append(leaf("units", model.units))
    return tag


def globals_tag(model: Model) -> Tag | None:
    out = Tag("Globals")
    if model.constants:
        rows = [leaf(k, number(v)) for k, v in model.constants.items()]
        out.children.append(Tag("Constants", children=rows))
    if model.variables:
        rows = [leaf("var", number(v), name=k) for k, v in model.variables.items()]
        out.children.append(Tag("Variables", children=rows))
    for u in model.unknown:
        if u.tag == "Globals":
            out.children += [tag_of(c) for c in u.children]
    return out if out.children else None


def _control_only(steps: list[Step]) -> Component | None:
    """The control, where one nameless step holds nothing else: it can stand outside <Step>."""
    if len(steps) != 1 or steps[0].name is not None or len(step_sections(steps[0])) != 1:
        return None
    return steps[0].control


def tree(model: Model) -> Tag:
    """The <febio_spec version="4.0"> that says what the model says."""
    root = Tag("febio_spec", {"version": "4.0"})
    add = root.children.append
    add(module_tag(model))
    steps = list(model.steps)
    single = _control_only(steps)
    if single is not None:
        add(tag_of(single))
    globals_ = globals_tag(model)
    if globals_ is not None:
        add(globals_)
    if model.materials:
        add(section("Material", model.materials))
    add(mesh_tag(model.mesh))
    if model.domains:
        add(domains_tag(model))
    if model.mesh_data:
        add(Tag("MeshData", children=[data_tag(d) for d in model.mesh_data]))
    root.children += step_sections(model.common)
    if model.discrete:
        add(section("Discrete", model.discrete))
    if steps and single is None:
        rows = []
        for i, s in enumerate(steps, 1):
            attrs = {"id": str(i)} | ({"name": s.name} if s.name else {})
            rows.append(Tag("step", attrs, children=step_sections(s)))
        add(Tag("Step", children=rows))
    if model.controllers:
        add(Tag("LoadData", children=[controller_tag(c) for c in model.controllers]))
    add(output_tag(model.output))
    root.children += [tag_of(u) for u in model.unknown if u.tag != "Globals"]
    return root
