"""The model: everything a .feb file says, in one shape for all versions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from typing import Any

import numpy as np

from febkit.record import record, value_record

from .component import Component
from .mesh import Mesh
from .source import Where


@value_record
class Domain:
    """Assigns a material and a formulation to an element block."""

    block: str  # name of the element block (part)
    kind: str  # "solid", "shell", "beam", "discrete"
    material: str  # material name ("" where none)
    type: str | None = None  # "elastic-solid", "three-field-solid", "ut4-solid", ...
    spec: Component | None = None
    where: Where = field(default_factory=Where)


@record
class MeshData:
    """A map on nodes, elements or facets.

    ``values`` is (item, component) for <node>/<elem>/<face> lists, with ``items`` the file's own
    labels: node rows 1-based within the node set (``lid``), element rows within the element set, ...;
    None where ``spec`` generates the map (type="math", "const", "surface-to-surface map", ...).
    """

    kind: str  # "node", "element", "surface"
    name: str  # map name, or the parameter it fills ("shell thickness", "fiber", "mat_axis", ...)
    set: str  # name of the set or part it lives on
    spec: Component
    items: np.ndarray | None = None
    values: np.ndarray | None = None
    where: Where = field(default_factory=Where)


@value_record
class LoadController:
    """``<load_controller id= type=>``; ``points`` (n, 2) where it is a load curve."""

    id: int
    type: str
    spec: Component
    name: str | None = None
    points: tuple[tuple[float, float], ...] = ()
    where: Where = field(default_factory=Where)


@value_record
class PlotVariable:
    type: str  # "displacement", or 'p=alias' already split: type and alias
    alias: str | None = None
    surface: str | None = None
    where: Where = field(default_factory=Where)
    spec: Component | None = None  # where the file says more: an element set, a list of items


@value_record
class LogEntry:
    kind: str  # "node_data", "element_data", "rigid_body_data", ...
    data: str  # "x;y;z"
    file: str | None = None
    delim: str = " "
    name: str | None = None
    set: str | None = None
    items: tuple[int, ...] = ()
    spec: Component | None = None
    where: Where = field(default_factory=Where)


@value_record
class Output:
    plot: tuple[PlotVariable, ...] = ()
    plot_type: str = "febio"
    plot_spec: Component | None = None  # <compression>, ...
    log: tuple[LogEntry, ...] = ()
    log_file: str | None = None


@value_record
class Step:
    """Boundary conditions, loads and control that act during one step (or, in ``Model``, in all)."""

    name: str | None = None
    control: Component | None = None
    boundary: tuple[Component, ...] = ()
    loads: tuple[Component, ...] = ()
    contact: tuple[Component, ...] = ()
    constraints: tuple[Component, ...] = ()
    rigid: tuple[Component, ...] = ()
    initial: tuple[Component, ...] = ()
    adaptors: tuple[Component, ...] = ()
    where: Where = field(default_factory=Where)


@record
class Model:
    """A .feb model.

    ``common`` holds the sections outside <Step>; ``steps`` the steps in order (one step, holding the
    control, where the file has a top-level <Control> only).
    """

    version: str
    module: str
    mesh: Mesh
    materials: tuple[Component, ...] = ()
    domains: tuple[Domain, ...] = ()
    mesh_data: tuple[MeshData, ...] = ()
    common: Step = field(default_factory=Step)
    steps: tuple[Step, ...] = ()
    discrete: tuple[Component, ...] = ()
    controllers: tuple[LoadController, ...] = ()
    output: Output = field(default_factory=Output)
    constants: Mapping[str, float] = field(default_factory=dict)  # <Globals><Constants>
    variables: Mapping[str, float] = field(default_factory=dict)  # <Globals><Variables>
    units: str | None = None
    module_spec: Component | None = None
    file: str = ""
    document: object | None = None  # the lossless XML document the model was read from
    unknown: tuple[Component, ...] = ()  # sections this version of febkit has no record for
    nested: Mapping[str, Model] = field(default_factory=dict)  # models that materials name, by those names


def as_record(model: Any) -> Model:
    """The frozen record of a :class:`febkit.Model`, or the record itself."""
    record: Model = getattr(model, "record", model)
    return record
