"""What two models mean differently: numbers as numbers, sets by their members, order where it matters.

Names of conditions and steps, and ids that only number, are no part of the meaning.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from febkit.model import Component, InputError, LogEntry, Mesh, MeshData, Model, as_record
from febkit.model.sets import element_ids, node_indices

from .canonical import canonical
from .edit import RTOL, same_text


@dataclass(frozen=True, slots=True)
class Difference:
    """``what`` differs: ``a`` in the first model, ``b`` in the second."""

    what: str
    a: str
    b: str

    def __str__(self) -> str:
        return f"{self.what}: {self.a} | {self.b}"


def diff(a: Model, b: Model, rtol: float = RTOL) -> list[Difference]:
    """Differences in meaning between two models; numbers agree within ``rtol``."""
    return _Diff(canonical(as_record(a)), canonical(as_record(b)), rtol).run()


def _short(v: Any) -> str:
    s = str(v)
    return s if len(s) <= 60 else s[:57] + "..."


class _Diff:
    def __init__(self, a: Model, b: Model, rtol: float) -> None:
        self.a, self.b, self.rtol = a, b, rtol
        self.out: list[Difference] = []

    def add(self, what: str, a: Any, b: Any) -> None:
        self.out.append(Difference(what, _short(a), _short(b)))

    def run(self) -> list[Difference]:
        a, b = self.a, self.b
        for field in ("module", "units"):
            if getattr(a, field) != getattr(b, field):
                self.add(field, getattr(a, field), getattr(b, field))
        self.numbers("constant", a.constants, b.constants)
        self.numbers("variable", a.variables, b.variables)
        self.mesh(a.mesh, b.mesh)
        self.named("material", a.materials, b.materials)
        self.domains()
        self.maps()
        self.stage("model", a.common, b.common)
        if len(a.steps) != len(b.steps):
            self.add("steps", len(a.steps), len(b.steps))
        for i, (s, t) in enumerate(zip(a.steps, b.steps), 1):
            self.stage(f"step {i}", s, t)
        self.listed("discrete", a.discrete, b.discrete)
        self.controllers()
        self.output()
        self.listed("section", a.unknown, b.unknown)
        return self.out

    def numbers(self, what: str, a: Mapping[str, float], b: Mapping[str, float]) -> None:
        for k in sorted(a.keys() | b.keys()):
            x, y = a.get(k), b.get(k)
            if x is None or y is None or not np.isclose(x, y, rtol=self.rtol, atol=0):
                self.add(f"{what} {k}", x, y)

    # -- mesh
    def array(self, what: str, a: np.ndarray, b: np.ndarray) -> None:
        if a.shape != b.shape:
            self.add(what, f"shape {a.shape}", f"shape {b.shape}")
        elif a.dtype.kind == "f":
            if not np.allclose(a, b, rtol=self.rtol, atol=0, equal_nan=True):
                self.add(what, *self._worst(a, b))
        elif not np.array_equal(a, b):
            self.add(what, *self._worst(a, b))

    def _worst(self, a: np.ndarray, b: np.ndarray) -> tuple[Any, Any]:
        i = int(np.argmax(a.reshape(-1) != b.reshape(-1)))
        return a.reshape(-1)[i], b.reshape(-1)[i]

    def mesh(self, a: Mesh, b: Mesh) -> None:
        self.array("node ids", a.node_ids, b.node_ids)
        self.array("node coordinates", a.X, b.X)
        for name, x, y in self._pairs("part", {e.name: e for e in a.blocks}, {e.name: e for e in b.blocks}):
            if x.type != y.type:
                self.add(f"part {name} type", x.type, y.type)
            self.array(f"part {name} element ids", x.ids, y.ids)
            self.array(f"part {name} connectivity", x.conn, y.conn)
        first, second = {**a.node_blocks, **a.node_sets}, {**b.node_blocks, **b.node_sets}
        for name, x, y in self._pairs("node set", first, second):
            self.array(f"node set {name}", getattr(x, "nodes", x), getattr(y, "nodes", y))
        for name, x, y in self._pairs("element set", a.element_sets, b.element_sets):
            self.array(f"element set {name}", x.elements, y.elements)
        for name, x, y in self._pairs("surface", a.surfaces, b.surfaces):
            for kind, f, g in self._pairs(f"surface {name}", x.facets, y.facets):
                self.array(f"surface {name} {kind}", f, g)
        for name, x, y in self._pairs("edge", a.edges, b.edges):
            self.array(f"edge {name}", x.lines, y.lines)
        for name, x, y in self._pairs("discrete set", a.discrete_sets, b.discrete_sets):
            self.array(f"discrete set {name}", x.pairs, y.pairs)
        for name, x, y in self._pairs("surface pair", a.surface_pairs, b.surface_pairs):
            sides = ((x.primary, y.primary), (x.secondary, y.secondary))
            if not all(p == q or self.same_surface(p, q) for p, q in sides):
                self.add(f"surface pair {name}", (x.primary, x.secondary), (y.primary, y.secondary))

    def _pairs(self, what: str, a: Mapping[str, Any], b: Mapping[str, Any]) -> Iterable[tuple[str, Any, Any]]:
        for k in a:
            if k not in b:
                self.add(f"{what} {k}", "there", "missing")
        for k in b:
            if k not in a:
                self.add(f"{what} {k}", "missing", "there")
        return [(k, a[k], b[k]) for k in a if k in b]

    # -- components
    def named(self, what: str, a: Iterable[Component], b: Iterable[Component]) -> None:
        first, second = {c.name or str(c.id): c for c in a}, {c.name or str(c.id): c for c in b}
        for name, x, y in self._pairs(what, first, second):
            self.component(f"{what} {name}", x, y)

    def listed(self, what: str, a: tuple[Component, ...], b: tuple[Component, ...]) -> None:
        """Conditions of one section, kind by kind in their order."""
        def kinds(cs: tuple[Component, ...]) -> dict[str, list[Component]]:
            out: dict[str, list[Component]] = {}
            for c in cs:
                out.setdefault(f"<{c.tag}{f' type={c.type}' if c.type else ''}>", []).append(c)
            return out

        x, y = kinds(a), kinds(b)
        for k in dict.fromkeys([*x, *y]):
            p, q = x.get(k, []), y.get(k, [])
            if len(p) != len(q):
                self.add(f"{what} {k}", f"{len(p)} of them", f"{len(q)} of them")
            for i, (c, d) in enumerate(zip(p, q), 1):
                self.component(f"{what} {k}{f' {i}' if len(p) > 1 else ''}", c, d)

    def component(self, what: str, a: Component, b: Component) -> None:
        if a.type != b.type:
            self.add(f"{what} type", a.type, b.type)
        if not same_text(a.text, b.text, self.rtol):
            self.add(what, a.text, b.text)
        for k in sorted(a.attrs.keys() | b.attrs.keys()):
            x, y = a.attrs.get(k), b.attrs.get(k)
            if x != y and not self.same_set(k, x, y):
                self.add(f"{what} {k}=", x, y)
        self.children(what, a, b)

    def children(self, what: str, a: Component, b: Component) -> None:
        for tag in dict.fromkeys(c.tag for c in (*a.children, *b.children)):
            x, y = a.all(tag), b.all(tag)
            if len(x) != len(y):
                self.add(f"{what}/{tag}", f"{len(x)} of them" if x else "missing",
                         f"{len(y)} of them" if y else "missing")
            for i, (c, d) in enumerate(zip(x, y), 1):
                self.component(f"{what}/{tag}{f'[{i}]' if len(x) > 1 else ''}", c, d)

    def same_set(self, attr: str, x: str | None, y: str | None) -> bool:
        """Two names of one set of nodes or elements."""
        if x is None or y is None:
            return False
        if attr == "surface":
            return self.same_surface(x, y)
        if attr == "surface_pair":
            p, q = self.a.mesh.surface_pairs.get(x), self.b.mesh.surface_pairs.get(y)
            return p is not None and q is not None and all(
                self.same_surface(*s) for s in ((p.primary, q.primary), (p.secondary, q.secondary)))
        if attr == "discrete_set":
            d, e = self.a.mesh.discrete_sets.get(x), self.b.mesh.discrete_sets.get(y)
            return d is not None and e is not None and np.array_equal(d.pairs, e.pairs)
        resolve = {"node_set": node_indices, "elem_set": element_ids}.get(attr)
        if resolve is None:
            return False
        try:
            return np.array_equal(np.unique(resolve(self.a.mesh, x)), np.unique(resolve(self.b.mesh, y)))
        except InputError:
            return False

    def same_surface(self, x: str, y: str) -> bool:
        """Two names of one set of facets."""
        s, t = self.a.mesh.surfaces.get(x), self.b.mesh.surfaces.get(y)
        if s is None or t is None or s.facets.keys() != t.facets.keys():
            return False
        return all(np.array_equal(s.facets[k], t.facets[k]) for k in s.facets)

    # -- the rest
    def domains(self) -> None:
        for name, x, y in self._pairs("domain", {d.block: d for d in self.a.domains},
                                      {d.block: d for d in self.b.domains}):
            for field in ("kind", "material", "type"):
                if getattr(x, field) != getattr(y, field):
                    self.add(f"domain {name} {field}", getattr(x, field), getattr(y, field))
            if x.spec is not None and y.spec is not None:
                self.children(f"domain {name}", x.spec, y.spec)

    def maps(self) -> None:
        def keyed(ms: tuple[MeshData, ...]) -> dict[str, MeshData]:
            return {f"{m.kind} {m.name} on {m.set}": m for m in ms}

        for name, x, y in self._pairs("map", keyed(self.a.mesh_data), keyed(self.b.mesh_data)):
            self.component(f"map {name}", x.spec, y.spec)
            if (x.values is None) != (y.values is None):
                self.add(f"map {name}", "generated" if x.values is None else "listed",
                         "generated" if y.values is None else "listed")
            elif x.values is not None:
                self.array(f"map {name} items", x.items, y.items)
                self.array(f"map {name} values", x.values, y.values)

    def stage(self, what: str, a: Any, b: Any) -> None:
        if (a.control is None) != (b.control is None):
            self.add(f"{what} control", a.control is not None, b.control is not None)
        elif a.control is not None:
            self.component(f"{what} control", a.control, b.control)
        for field in ("boundary", "loads", "contact", "constraints", "rigid", "initial", "adaptors"):
            self.listed(f"{what} {field}", getattr(a, field), getattr(b, field))

    def controllers(self) -> None:
        for i, x, y in self._pairs("load controller", {str(c.id): c for c in self.a.controllers},
                                   {str(c.id): c for c in self.b.controllers}):
            if x.type != y.type:
                self.add(f"load controller {i} type", x.type, y.type)
            self.array(f"load controller {i} points", np.array(x.points), np.array(y.points))
            self.children(f"load controller {i}", x.spec, y.spec)

    def output(self) -> None:
        a, b = self.a.output, self.b.output
        one = [(v.type, v.alias, v.surface) for v in a.plot]
        two = [(v.type, v.alias, v.surface) for v in b.plot]
        for v in sorted(set(one) ^ set(two), key=str):
            self.add(f"plot variable {v[0]}", v in one, v in two)
        if a.plot_type != b.plot_type:
            self.add("plot type", a.plot_type, b.plot_type)
        first, second = [_log(self.a, e) for e in a.log], [_log(self.b, e) for e in b.log]
        if len(first) != len(second):
            self.add("log entries", len(first), len(second))
        for i, (p, q) in enumerate(zip(first, second), 1):
            for what, x, y in zip(("kind", "data", "file", "items"), p, q):
                if x != y:
                    self.add(f"log entry {i} {what}", x, y)


def _log(model: Model, e: LogEntry) -> tuple[str, str, str | None, Any]:
    """What an entry writes, with its set as the ids in it."""
    items: Any = e.items or e.set
    try:
        if e.set is not None and e.kind == "node_data":
            items = tuple(model.mesh.node_ids[node_indices(model.mesh, e.set)].tolist())
        elif e.set is not None and e.kind == "element_data":
            items = tuple(element_ids(model.mesh, e.set).tolist())
    except InputError:
        items = e.set
    return e.kind, e.data, e.file, items
