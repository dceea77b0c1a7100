"""A version 4.0 tree to a Model."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from febkit.model import (
    Component,
    Domain,
    InputError,
    LoadController,
    LogEntry,
    Mesh,
    MeshData,
    Model,
    Output,
    PlotVariable,
    Step,
    Where,
)

from . import mesh as mesh_section
from .component import component
from .document import Document, Tag

DOMAIN_KINDS = {"SolidDomain": "solid", "ShellDomain": "shell", "BeamDomain": "beam",
                "DiscreteDomain": "discrete"}
DATA_KINDS = {"NodeData": ("node", "node_set", "node"), "ElementData": ("element", "elem_set", "e"),
              "SurfaceData": ("surface", "surface", "face")}
# sections of a step, and the field of Step that holds their children
STEP_SECTIONS = {"Boundary": "boundary", "Loads": "loads", "Contact": "contact",
                 "Constraints": "constraints", "Rigid": "rigid", "Initial": "initial",
                 "MeshAdaptor": "adaptors"}
LOG_SETS = ("node_set", "elem_set", "surface", "domain")


def floats(tag: Tag) -> list[float]:
    return mesh_section.floats(tag.text, tag)


def data_values(tag: Tag, row_name: str) -> tuple[np.ndarray | None, np.ndarray | None]:
    """Labels and values of a map given row by row; (None, None) where it is generated."""
    names = {"node": ("node",), "e": ("e", "elem"), "face": ("face",)}[row_name]
    if tag.table is not None:
        return mesh_section.rows(tag, names, None, "lid")
    listed = [c for c in tag if "lid" in c.attrs]
    if not listed:
        return None, None
    labels, values = [], []
    for c in listed:
        v = [x for child in c for x in floats(child)] if c.children else floats(c)
        labels.append(mesh_section.label(c, "lid"))
        values.append(v)
    width = max(len(v) for v in values)
    grid = np.full((len(values), width), np.nan)  # shells of unlike shapes: short rows end in NaN
    for i, v in enumerate(values):
        grid[i, :len(v)] = v
    return np.array(labels, dtype=np.int64), grid


class ModelBuilder:
    """Collects the sections of one 4.0 tree."""

    def __init__(self, root: Tag, file: str, doc: Document | None = None) -> None:
        self.root, self.file, self.doc = root, file, doc
        self.fields: dict[str, Any] = {"module": "solid"}
        self.common: dict[str, Any] = {}
        self.steps: list[Step] = []
        self.unknown: list[Component] = []

    def build(self) -> Model:
        sections = sorted(self.root, key=lambda t: t.name != "Mesh")  # the mesh first
        for tag in sections:
            read = SECTIONS.get(tag.name)
            if read is not None:
                read(self, tag)
            elif tag.name in STEP_SECTIONS:
                self._extend(self.common, tag)
            else:
                self.unknown.append(component(tag, self.doc, self._place(tag)))
        control = self.common.pop("control", None)
        steps = tuple(self.steps)
        if control is not None:
            steps = _with_control(control, steps)
        none = Mesh(np.zeros(0, np.int64), np.zeros((0, 3)))
        return Model(version="4.0", mesh=self.fields.pop("mesh", none), common=Step(**self.common),
                     steps=steps, file=self.file, unknown=tuple(self.unknown), **self.fields)

    def _place(self, tag: Tag) -> Where:
        """Of a section; the file where a conversion has made it."""
        return tag.where if tag.doc is not None else Where(self.file)

    def _extend(self, out: dict[str, Any], tag: Tag) -> None:
        field = STEP_SECTIONS[tag.name]
        out[field] = out.get(field, ()) + tuple(component(c, self.doc, self._place(tag)) for c in tag)

    def _add(self, field: str, records: tuple[Any, ...]) -> None:
        self.fields[field] = self.fields.get(field, ()) + records

    def module(self, tag: Tag) -> None:
        self.fields["module"] = tag.get("type") or "solid"
        units = tag.child("units")
        self.fields["units"] = tag.get("units") or (units.text.strip() if units is not None else None)
        self.fields["module_spec"] = component(tag, self.doc, self._place(tag))

    def globals(self, tag: Tag) -> None:
        other = []
        for c in tag:
            if c.name == "Constants":
                self.fields["constants"] = {k.name: floats(k)[0] for k in c if k.text.strip()}
            elif c.name == "Variables":
                self.fields["variables"] = {k.need("name"): (floats(k) or [0.0])[0] for k in c}
            else:
                other.append(component(c, self.doc, self._place(tag)))
        if other:
            self.unknown.append(Component("Globals", children=tuple(other), where=tag.where))

    def material(self, tag: Tag) -> None:
        self._add("materials", tuple(component(c, self.doc, self._place(tag)) for c in tag))

    def mesh(self, tag: Tag) -> None:
        if "mesh" in self.fields:
            raise InputError("there is a second <Mesh> section", tag.where)
        self.fields["mesh"] = mesh_section.MeshReader(tag).read()

    def domains(self, tag: Tag) -> None:
        out = []
        for c in tag:
            kind = DOMAIN_KINDS.get(c.name)
            if kind is None:
                raise InputError(f"<{c.name}> does not belong in <MeshDomains>", c.where)
            out.append(Domain(c.need("name"), kind, c.get("mat") or "", c.get("type"),
                              component(c, self.doc, self._place(tag)), c.where))
        self._add("domains", tuple(out))

    def mesh_data(self, tag: Tag) -> None:
        out = []
        for c in tag:
            if c.name not in DATA_KINDS:
                raise InputError(f"<{c.name}> does not belong in <MeshData>", c.where)
            kind, set_attr, row = DATA_KINDS[c.name]
            items, values = data_values(c, row)
            if items is None:
                spec = component(c, self.doc, self._place(tag))
            else:  # the rows are in ``items`` and ``values``
                head = Tag(c.name, c.attrs, "", [], c.line, c.doc)
                spec = component(head)
                if self.doc is not None:
                    self.doc.origin[id(spec)] = c
            type_ = c.get("type") or ""
            fills = type_ in mesh_section.VAR_MAPS or ".fiber" in type_  # which says more than a name beside it
            name = type_ if fills else c.get("name") or type_
            out.append(MeshData(kind, name, c.need(set_attr), spec, items, values, c.where))
        self._add("mesh_data", tuple(out))

    def load_data(self, tag: Tag) -> None:
        out = []
        for c in tag:
            spec = component(c, self.doc, self._place(tag))
            if c.name != "load_controller" or spec.id is None:
                raise InputError(f"<{c.name}> in <LoadData> must be <load_controller id= type=>", c.where)
            points: tuple[tuple[float, float], ...] = ()
            listed = c.child("points")
            if listed is not None:
                points = tuple(_point(p) for p in listed)
            out.append(LoadController(spec.id, spec.type or "loadcurve", spec, spec.name, points, c.where))
        self._add("controllers", tuple(out))

    def control(self, tag: Tag) -> None:
        self.common["control"] = component(tag, self.doc, self._place(tag))

    def step(self, tag: Tag) -> None:
        for s in tag:
            if s.name != "step":
                raise InputError(f"<{s.name}> in <Step> must be <step>", s.where)
            fields: dict[str, Any] = {"name": s.get("name"), "where": s.where}
            for c in s:
                if c.name == "Control":
                    fields["control"] = component(c, self.doc, self._place(tag))
                elif c.name in STEP_SECTIONS:
                    self._extend(fields, c)
                else:
                    raise InputError(f"<{c.name}> does not belong in <step>", c.where)
            self.steps.append(Step(**fields))

    def discrete(self, tag: Tag) -> None:
        self._add("discrete", tuple(component(c, self.doc, self._place(tag)) for c in tag))

    def output(self, tag: Tag) -> None:
        out = self.fields.get("output", Output())
        for c in tag:
            if c.name == "plotfile":
                head = Tag(c.name, c.attrs, c.text, [x for x in c if x.name != "var"], c.line, c.doc)
                out = replace(out, plot=out.plot + tuple(_plot_variable(v) for v in c.all("var")),
                              plot_type=c.get("type") or "febio", plot_spec=component(head))
            elif c.name == "logfile":
                out = replace(out, log=out.log + tuple(_log_entry(e, self.doc) for e in c),
                              log_file=c.get("file") or out.log_file)
            else:
                raise InputError(f"<{c.name}> does not belong in <Output>", c.where)
        self.fields["output"] = out


def _with_control(control: Component, steps: tuple[Step, ...]) -> tuple[Step, ...]:
    """A <Control> outside <Step> speaks of the first step, whose own control comes after it."""
    if not steps:
        return (Step(control=control, where=control.where),)
    own = steps[0].control
    if own is not None:
        control = replace(own, children=control.children + own.children)
    return (replace(steps[0], control=control), *steps[1:])


def _point(tag: Tag) -> tuple[float, float]:
    v = floats(tag)
    if len(v) != 2:
        raise InputError(f"<{tag.name}> must hold two numbers, not {len(v)}", tag.where)
    return v[0], v[1]


def _plot_variable(tag: Tag) -> PlotVariable:
    type_, _, alias = tag.need("type").partition("=")
    more = bool(tag.text.strip() or tag.children or set(tag.attrs) - {"type", "surface"})
    return PlotVariable(type_, alias or None, tag.get("surface"), tag.where, component(tag) if more else None)


def _log_entry(tag: Tag, doc: Document | None) -> LogEntry:
    text = tag.text.strip()
    set_ = next((tag.attrs[a] for a in LOG_SETS if a in tag.attrs), None)
    items = tuple(mesh_section.ints(text, tag).tolist()) if text else ()
    return LogEntry(tag.name, tag.need("data"), tag.get("file"), tag.get("delim") or " ", tag.get("name"),
                    set_, items, component(tag, doc), tag.where)


SECTIONS: dict[str, Callable[[ModelBuilder, Tag], None]] = {
    "Module": ModelBuilder.module,
    "Globals": ModelBuilder.globals,
    "Material": ModelBuilder.material,
    "Mesh": ModelBuilder.mesh,
    "MeshDomains": ModelBuilder.domains,
    "MeshData": ModelBuilder.mesh_data,
    "LoadData": ModelBuilder.load_data,
    "Control": ModelBuilder.control,
    "Step": ModelBuilder.step,
    "Discrete": ModelBuilder.discrete,
    "Output": ModelBuilder.output,
}
