"""What lowering knows while it works: the model, its controllers, and what it had to refuse."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from febkit.model import (
    Component,
    ElementBlock,
    InputError,
    LoadController,
    MeshData,
    Model,
    UnsupportedError,
    Where,
    values,
)
from febkit.model.reasons import reason
from febkit.model.sets import element_ids, map_items, node_indices, surface
from febkit.solver.fields import Layout
from febkit.solver.problem import Step
from febkit.solver.values import Composed, Constant, Expression, Map, Scaled, Value

from .functions import Controller, compiled, interval, load_curve

if TYPE_CHECKING:
    from febkit.solver.contact.tied_node import TiedNode
    from febkit.solver.feedback import Pid
    from febkit.solver.problem import Block, Problem

    from .rigid import Body

METHODS = {"penalty": 0, "auglag": 1, "lagmult": 2, "0": 0, "1": 1, "2": 2}  # of <laugon>, how a constraint is held
FACETS = "@facets:"  # marks a surface whose facets a map may follow
_TYPE = re.compile(r'type="([^"]+)"')
_PARAMETER = re.compile(r"fem\.material\('([^']+)'\)\.([\w.]+)")


class Context:
    """Shared by all parts of the lowering. Refusals are collected, so that a user sees all at once."""

    def __init__(self, model: Model) -> None:
        self.model = model
        self.refused: list[UnsupportedError] = []
        self._controllers: dict[int, Controller] = {}
        self.layout = Layout([])  # of the nodal fields, once the materials are known
        self.X = model.mesh.X  # nodes of the problem: the mesh's, then back nodes of shells
        self.rigid: dict[str, Body] = {}  # rigid bodies by the name of their material
        self.centres: list[np.ndarray] = []  # and their centres, by index
        self.numbers: dict[str, int] = {}  # places of the blocks in the problem, by name
        self.made: list[Block] = []  # and the blocks
        self.bonded: list[tuple[Step, Component, TiedNode]] = []  # tied contacts by multipliers, and their steps
        self.common = Step()  # what acts in every step
        self.feedback: list[Pid] = []  # controllers that follow the solution
        self.lower: Callable[[Model], Problem]  # lowers another model, which this one names
        self._made_data: dict[int, np.ndarray | None] = {}
        self.back = np.full(len(self.X), -1)  # back node of each mesh node, -1 where it has none

    @property
    def variables(self) -> dict[str, float]:
        """Global variables by the names that formulas have for them: ``a`` and ``fem.a``."""
        own = self.model.variables
        return {**own, **{f"fem.{name}": v for name, v in own.items()}}

    def refuse(self, what: str, where: Where | None = None) -> None:
        """Note a feature that febkit does not solve."""
        named = _TYPE.search(what)
        why = reason(named[1]) if named else ""
        said = f"{what} is not supported by febkit's solver"
        self.refused.append(UnsupportedError(f"{said}: {why}" if why else said, where))

    # ---- nodal fields -----------------------------------------------------------------------------
    def column(self, dof: str, c: Component) -> int:
        """Column of a degree of freedom by FEBio's name. Raises InputError where the model has none."""
        if not self.layout.has(dof):
            what = {"p": "fluid pressure"}.get(dof, f'degree of freedom "{dof}"')
            raise InputError(f'{c.what}: a "{self.model.module}" model has no {what}', c.where)
        return self.layout.column(dof)

    def bottoms(self, c: Component, conns: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
        """Facets on the back faces of shells, where ``c`` has <shell_bottom>. Raises InputError where there is none."""
        out = {k: self.back[v] for k, v in conns.items()}
        if any((v < 0).any() for v in out.values()):
            raise InputError(f'<shell_bottom>: a facet of "{c.attrs.get("surface", "")}" is no shell', c.where)
        return out

    # ---- controllers ------------------------------------------------------------------------------
    def controller(self, number: int, leaf: Component) -> Controller:
        """The load controller of this id, which ``leaf`` names, as a function of time."""
        if number not in self._controllers:
            spec = self.curves.get(number)
            if spec is None:
                raise InputError(f'<{leaf.tag} lc="{number}">: there is no load controller {number}', leaf.where)
            self._controllers[number] = self._make_controller(spec)
        return self._controllers[number]

    def _make_controller(self, spec: LoadController) -> Controller:
        if spec.type == "loadcurve":
            return load_curve(spec.points, spec.spec, f"load controller {spec.id}")
        if spec.type in ("math", "math-interval"):
            leaf = spec.spec.need("math")
            f = compiled(leaf.text, {"t", *self.variables}, self.variables, leaf.where)
            if spec.type == "math":
                return lambda t: float(f(t=t))
            return interval(spec.spec, lambda t: float(f(t=t)))
        if spec.type == "PID":
            from .feedback import pid

            return pid(self, spec)
        self.refuse(f'load controller type="{spec.type}"', spec.where)
        return lambda t: 1.0

    # ---- values -----------------------------------------------------------------------------------
    def value(self, leaf: Component | None, default: float | None = None, maps: str = "") -> Value:
        """A parameter as a solver value: number, formula or map, times its load controller.

        ``maps``: the node set or part whose item order a map must follow, or :data:`FACETS` and a surface; "" where no
        map can be meant.
        """
        if leaf is None:
            assert default is not None
            return Constant(default)
        return self._scaled(self._base(leaf, maps), leaf)

    def _scaled(self, base: Value, leaf: Component) -> Value:
        number = leaf.lc
        return base if number is None else Scaled(base, self.controller(number, leaf))

    def _base(self, leaf: Component, maps: str) -> Value:
        kind = leaf.type or leaf.attrs.get("type") or "const"
        if kind == "math":
            return self.formula((leaf.child("math") or leaf).text, leaf, maps)
        if kind == "map":
            return self._map((leaf.child("map") or leaf).text.strip(), leaf, maps)
        if kind != "const":
            self.refuse(f'<{leaf.tag} type="{kind}">', leaf.where)
            return Constant(0.0)
        leaf = leaf.child("const") or leaf
        return Constant(leaf.as_float()) if values.spells_number(leaf.text) else self.formula(leaf.text, leaf, maps)

    def components(self, leaf: Component, n: int, maps: str = "") -> tuple[Value, ...]:
        """A parameter of ``n`` numbers: given in the file, by formulas or maps of elements separated by commas, or by
        the ``n`` columns of one map."""
        names = [x.strip() for x in (leaf.child("map") or leaf).text.split(",")]
        if leaf.type == "map" and maps and len(names) == n > 1:
            return tuple(self._scaled(self._map(name, leaf, maps), leaf) for name in names)
        if leaf.type == "map" and maps:
            return tuple(Map(column) for column in np.ascontiguousarray(self.element_rows(leaf, maps, n).T))
        if leaf.type == "math" and maps:
            return self.formulas(leaf, n, maps)
        if leaf.type not in (None, "const", "vector"):
            self.refuse(f'<{leaf.tag} type="{leaf.type}">', leaf.where)
            return (Constant(0.0),) * n
        return tuple(self._scaled(Constant(x), leaf) for x in leaf.as_floats(n))

    def vector(self, leaf: Component) -> tuple[Value, Value, Value]:
        """A vector parameter: three numbers or three formulas, times its load controller."""
        x, y, z = self.formulas(leaf) if leaf.type == "math" else self.components(leaf, 3)
        return x, y, z

    def formulas(self, leaf: Component, n: int = 3, maps: str = "") -> tuple[Value, ...]:
        """``n`` formulas separated by commas, times a load controller."""
        parts = leaf.text.split(",")
        if len(parts) != n:
            number = {2: "two", 3: "three"}.get(n, str(n))
            raise InputError(f"<{leaf.tag}> must be {number} formulas separated by commas", leaf.where)
        return tuple(self._scaled(self.formula(p, leaf, maps), leaf) for p in parts)

    def formula(self, text: str, leaf: Component, maps: str = "") -> Value:
        """A formula of X, Y, Z, t, global variables, parameters beside it or elsewhere in the model, and maps."""
        f = compiled(text, None, self.variables, leaf.where)
        parts = {name: self._named(name, text, leaf, maps) for name in sorted(f.names - {"X", "Y", "Z", "t"})}
        if parts:
            return Composed(f, parts, steady=f.steady and all(v.steady for v in parts.values()))
        if f.uniform and f.steady:
            v = float(f())
            if not math.isfinite(v):
                raise InputError(f'<{leaf.tag}>: the formula "{text.strip()}" gives {v:g}', leaf.where)
            return Constant(v)
        return Expression(f, steady=f.steady)

    def _named(self, name: str, text: str, leaf: Component, maps: str) -> Value:
        """What a name in a formula stands for, in FEBio's order: a parameter beside it, one of the model, a map."""
        found = self._beside(leaf, name)
        path = _PARAMETER.fullmatch(name)
        if path is not None:
            found = next((m for m in self.model.materials if m.name == path[1]), None)
            for tag in path[2].split("."):
                found = None if found is None else found.child(tag)
            if found is None:
                raise InputError(f'there is no parameter "{path[2]}" of a material "{path[1]}"', leaf.where)
        if found is leaf:
            raise InputError(f'<{leaf.tag}>: the formula "{text.strip()}" refers to itself', leaf.where)
        if found is not None:
            return self.value(found, maps=maps)
        known = [d.name for d in self.model.mesh_data]
        if name in known:
            return self._map(name, leaf, maps)
        names = ["X", "Y", "Z", "t", *self.model.variables, *known]
        said = values.near(name, names) or f"; known are {', '.join(names)}"
        raise InputError(f'formula "{text.strip()}": unknown variable {name}{said}', leaf.where)

    def _beside(self, leaf: Component, name: str) -> Component | None:
        """The parameter of this name of the component that ``leaf`` belongs to."""
        owner = self.owners.get(id(leaf))
        return None if owner is None else owner.child(name)

    @cached_property
    def owners(self) -> dict[int, Component]:
        """The component that each parameter belongs to, by the parameter's identity."""
        out: dict[int, Component] = {}
        steps = (self.model.common, *self.model.steps)
        ahead = [*self.model.materials, *(c for s in steps for c in (*s.boundary, *s.loads, *s.initial, *s.rigid))]
        while ahead:
            c = ahead.pop()
            for child in c:
                out[id(child)] = c
                ahead.append(child)
        return out

    # ---- maps -------------------------------------------------------------------------------------
    def map_data(self, name: str, leaf: Component) -> list[MeshData]:
        """The records of a map in <MeshData>; several of one name are one map, as in FEBio."""
        found = [d for d in self.model.mesh_data if d.name == name]
        if not found:
            message = f'<{leaf.tag} type="map">: there is no map "{name}" in <MeshData>'
            raise InputError(message + values.near(name, (d.name for d in self.model.mesh_data)), leaf.where)
        return found

    def _map(self, name: str, leaf: Component, maps: str) -> Value:
        data = self.map_data(name, leaf)[0]
        facets = maps.removeprefix(FACETS) if maps.startswith(FACETS) else ""
        if not maps:
            self.refuse(f"a map as <{leaf.tag}>", leaf.where)
        elif data.kind == "element" and maps in self.blocks and data.spec.type == "surface-to-surface map":
            from .generated import between

            return between(self, data, self.blocks[maps])
        elif data.kind == "element" and maps in self.blocks:
            return Map(self.element_rows(leaf, maps, 1, name)[:, 0])
        elif data.kind == "node" and not facets and maps not in self.blocks and self._listed(data):
            return Map(self._node_map(data, maps, leaf))
        elif data.kind == "surface" and facets and data.values is not None:
            return Map(self._facet_map(data, facets, leaf))
        else:
            self.refuse(f'the {data.kind} map "{name}"', data.where)
        return Constant(0.0)

    def _listed(self, data: MeshData) -> bool:
        """Are there values at nodes, as the file lists them or by a formula?"""
        return data.values is not None or data.spec.type == "math"

    def _facet_map(self, data: MeshData, name: str, leaf: Component) -> np.ndarray:
        """A map of facets by the places of its own surface, which FEBio takes for those of the one it is used on."""
        mesh = self.model.mesh
        have, wanted = (sum(map(len, surface(mesh, n, leaf.where).facets.values())) for n in (data.set, name))
        items = map_items(mesh, data)
        rows = np.asarray(data.values, float).reshape(len(items), -1)
        if rows.shape[1] != 1 or have < wanted or len(np.unique(items)) < have:
            raise InputError(
                f'<{leaf.tag}>: the map "{data.name}" must have one number for each of the {wanted} facets of "{name}"',
                leaf.where,
            )
        out = np.zeros(have)
        out[items] = rows[:, 0]
        return out

    def _node_map(self, data: MeshData, ref: str, leaf: Component) -> np.ndarray:
        """A node map by the places of its own set, which FEBio takes for those of the set it is used on."""
        mesh = self.model.mesh
        out = np.zeros(len(node_indices(mesh, data.set, data.where)))
        wanted = len(node_indices(mesh, ref, leaf.where))
        if len(out) < wanted:
            raise InputError(
                f'<{leaf.tag}>: the map "{data.name}" is of {len(out)} nodes, "{ref}" has {wanted}', leaf.where
            )
        if data.values is None:
            from .generated import formula

            return formula(self, data)
        items = map_items(mesh, data)
        out[items] = np.asarray(data.values, float).reshape(len(items), -1)[:, 0]
        return out

    def element_rows(self, leaf: Component, part: str, width: int, name: str = "") -> np.ndarray:
        """The map ``name``, or that ``leaf`` names: its first ``width`` columns, a row for each element of a part."""
        name = name or (leaf.child("map") or leaf).text.strip()
        rows = self.element_map(self.map_data(name, leaf), part)
        if rows.shape[1] < width:
            message = f'<{leaf.tag}>: the map "{name}" has {rows.shape[1]} numbers a row, not {width}'
            raise InputError(message, leaf.where)
        rows = rows[:, :width]
        bare = np.isnan(rows).any(axis=1)
        if bare.any():
            e = self.blocks[part].ids[int(np.argmax(bare))]
            raise InputError(f'<{leaf.tag}>: the map "{name}" says nothing of element {e} of "{part}"', leaf.where)
        return rows

    def element_map(self, data: list[MeshData], part: str) -> np.ndarray:
        """Rows of element maps by the elements of a part; NaN where they say nothing."""
        block, mesh = self.blocks[part], self.model.mesh
        order = {int(i): k for k, i in enumerate(block.ids)}
        given = []
        for d in data:
            ids = element_ids(mesh, d.set, d.where)
            if d.values is None or d.items is None:
                rows = self._generated(d)
                if rows is None:
                    return np.zeros((len(block.ids), 9))
            else:
                ids, rows = ids[map_items(mesh, d)], np.asarray(d.values, float).reshape(len(d.values), -1)
            given.append((ids.tolist(), rows))
        out = np.full((len(block.ids), max((v.shape[1] for _, v in given), default=9)), np.nan)
        for ids, rows in given:
            for i, row in zip(ids, rows, strict=True):
                k = order.get(i)
                if k is not None:
                    out[k, : len(row)] = row
        return out

    def _generated(self, d: MeshData) -> np.ndarray | None:
        """Rows of element data that the file has made, a row for each element of its set; None where it is refused."""
        from .generated import GENERATORS

        if id(d) not in self._made_data:
            make, tags = GENERATORS.get(d.spec.type or "", (None, frozenset()))
            if make is None:
                self.refuse(f'element data "{d.name}" made by {d.spec.type}', d.where)
            else:
                self.check_tags(d.spec, tags)
            self._made_data[id(d)] = None if make is None else make(self.model.mesh, d)
        return self._made_data[id(d)]

    @cached_property
    def curves(self) -> dict[int, LoadController]:
        return {c.id: c for c in reversed(self.model.controllers)}

    @cached_property
    def blocks(self) -> dict[str, ElementBlock]:
        return {b.name: b for b in self.model.mesh.blocks}

    # ---- parameters -------------------------------------------------------------------------------
    def check_tags(self, spec: Component, known: set[str] | frozenset[str]) -> None:
        """Refuse parameters of a component that would otherwise be passed over in silence."""
        for c in spec:
            if c.tag not in known:
                label = f' type="{spec.type}"' if spec.type else ""
                self.refuse(f"<{c.tag}> of <{spec.tag}{label}>", c.where)
