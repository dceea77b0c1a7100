"""What is in a results file: sizes, parts, sets, variables, times and ranges; reads one state for ranges."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from febkit import units

from .fields import components
from .variables import unit_symbol
from .xplt.reader import PlotFile
from .xplt.records import PlotVariable


@dataclass(frozen=True, slots=True)
class VariableSummary:
    """A variable and the range of each of its components."""

    name: str
    section: str
    format: str
    type: str
    units: str  # "" where they are not known
    components: tuple[str, ...]
    low: tuple[float, ...]  # NaN where there are no data
    high: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class PlotSummary:
    """A plotfile in a few lines."""

    path: str
    version: int
    software: str
    units: str | None
    compressed: bool
    times: np.ndarray
    statuses: np.ndarray
    leftover: int  # bytes of a state that is not complete
    meshes: int
    nodes: int
    parts: list[tuple[str, str, int, str]]  # (name, element type, elements, material)
    node_sets: dict[str, int]
    element_sets: dict[str, int]
    surfaces: dict[str, int]
    variables: list[VariableSummary] = field(default_factory=list)


def summarize(path: str | os.PathLike[str], every: bool = False) -> PlotSummary:
    """Summarise a plotfile; ranges are of the last state, or of all states where ``every``."""
    with PlotFile(path) as f:
        mesh = max(f.states[-1].mesh, 0) if f.states else 0
        o = f.outline(mesh)
        states = np.array([i for i, s in enumerate(f.states) if max(s.mesh, 0) == mesh], int)
        materials = dict(o.parts)
        return PlotSummary(
            path=os.fspath(path),
            version=f.version,
            software=f.header.software,
            units=f.header.units,
            compressed=any(s.block.packed for s in f.states),
            times=f.times,
            statuses=f.statuses,
            leftover=f.container.leftover,
            meshes=f.n_meshes,
            nodes=o.n_nodes,
            parts=[(n, d.type, d.count, materials.get(d.part_id, str(d.part_id)))
                   for n, d in zip(o.part_names, o.domains)],
            node_sets={k: len(np.asarray(v)) for k, v in o.node_sets.items()},
            element_sets={k: len(np.asarray(v)) for k, v in o.element_sets.items()},
            surfaces={s.name: len(s.rows()) for s in o.surfaces},
            variables=list(_variables(f, states if every else states[-1:])),
        )


def _variables(f: PlotFile, states: np.ndarray) -> Iterator[VariableSummary]:
    system = units.system(f.header.units)
    for i, v in enumerate(f.variables):
        if v.section == "material":
            continue
        labels = component_labels(v)
        low, high = np.full(len(labels), np.inf), np.full(len(labels), -np.inf)
        for t in states:
            for a, b in _ranges(f, i, int(t), len(labels)):
                low, high = np.fmin(low, a), np.fmax(high, b)
        none = low > high
        low[none] = high[none] = np.nan
        symbol = v.units or unit_symbol(v.name)
        unit = system.of(symbol) if system else symbol if symbol == "1" else ""
        yield VariableSummary(v.name, v.section, v.format, v.type, unit, labels, tuple(low), tuple(high))


def _ranges(f: PlotFile, i: int, t: int, n: int) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """(lowest, highest) of each component in each region."""
    for _, values in f.regions(i, t):
        if values.size and values.size % n == 0:
            rows = values.reshape(-1, n)
            yield np.fmin.reduce(rows, axis=0), np.fmax.reduce(rows, axis=0)


def component_labels(v: PlotVariable) -> tuple[str, ...]:
    """A label for each float of one value; one empty label for scalars."""
    _, labels = components(v)
    if labels:
        return labels
    if v.values == 1:
        return ("",)
    names = v.array_names if len(v.array_names) == v.n else tuple(str(k + 1) for k in range(v.n))
    return tuple(f"{a}.{c}" for a in names for c in "xyz") if v.type == "array vec3f" else names

