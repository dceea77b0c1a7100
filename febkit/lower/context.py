"""What lowering knows while it works: the model, its controllers, and what it had to refuse."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
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
from febkit.model.sets import element_ids, map_items, node_indices
from febkit.solver.fields import Layout
from febkit.solver.values import Constant, Expression, Map, Scaled, Value

if TYPE_CHECKING:
    from febkit.model.math import Formula
    from febkit.solver.controllers import LoadCurve

    from .rigid import Body

Controller = Callable[[float], float]
_PARAMETER = re.compile(r"\$\{(fem\.material\('([^']+)'\)\.(\w+))\}")


def compiled(text: str, names: Iterable[str] | None, constants: Mapping[str, float], where: Where) -> Formula:
    """:func:`febkit.model.math.compile`, imported where a model has a formula."""
    from febkit.model import math as formulas

    return formulas.compile(text, names, constants, where)


def load_curve(points: Sequence[Sequence[float]], spec: Component, what: str) -> LoadCurve:
    """The curve through ``points``, between and outside of which it goes as ``spec`` says."""
    from febkit.solver.controllers import LoadCurve

    interpolate, extend = spec.str("interpolate") or "LINEAR", spec.str("extend") or "CONSTANT"
    if not points:
        raise InputError(f"{what} has no points", spec.where)
    try:
        return LoadCurve(np.array(points, dtype=float), interpolate, extend)
    except ValueError as e:
        raise InputError(f"{what}: {e}", spec.where) from None


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
        self.back = np.full(len(self.X), -1)  # back node of each mesh node, -1 where it has none

    def refuse(self, what: str, where: Where | None = None) -> None:
        """Note a feature that febkit does not solve."""
        self.refused.append(UnsupportedError(f"{what} is not supported by febkit's solver", where))

    # ---- nodal fields -----------------------------------------------------------------------------
    def column(self, dof: str, c: Component) -> int:
        """Column of a degree of freedom by FEBio's name. Raises InputError where the model has none."""
        if not self.layout.has(dof):
            what = {"p": "fluid pressure"}.get(dof, f'degree of freedom "{dof}"')
            raise InputError(f'{c.what}: a "{self.model.module}" model has no {what}', c.where)
        return self.layout.column(dof)

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
        if spec.type == "math":
            leaf = spec.spec.need("math")
            f = compiled(leaf.text, {"t", *self.model.variables}, dict(self.model.variables), leaf.where)
            return lambda t: float(f(t=t))
        self.refuse(f'load controller type="{spec.type}"', spec.where)
        return lambda t: 1.0

    # ---- values -----------------------------------------------------------------------------------
    def value(self, leaf: Component | None, default: float | None = None, maps: str = "") -> Value:
        """A parameter as a solver value: number, formula or map, times its load controller.

        ``maps``: the set or part whose item order a map must follow ("" where no map can be meant).
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
            return self.formula((leaf.child("math") or leaf).text, leaf)
        if kind == "map":
            return self._map((leaf.child("map") or leaf).text.strip(), leaf, maps)
        if kind != "const":
            self.refuse(f'<{leaf.tag} type="{kind}">', leaf.where)
            return Constant(0.0)
        leaf = leaf.child("const") or leaf
        return Constant(leaf.as_float()) if values.spells_number(leaf.text) else self.formula(leaf.text, leaf)

    def components(self, leaf: Component, n: int, maps: str = "") -> tuple[Value, ...]:
        """A parameter of ``n`` numbers: given in the file, or by the ``n`` columns of an element map."""
        if leaf.type == "map" and maps:
            return tuple(Map(column) for column in np.ascontiguousarray(self.element_rows(leaf, maps, n).T))
        if leaf.type not in (None, "const", "vector"):
            self.refuse(f'<{leaf.tag} type="{leaf.type}">', leaf.where)
            return (Constant(0.0),) * n
        return tuple(self._scaled(Constant(x), leaf) for x in leaf.as_floats(n))

    def vector(self, leaf: Component) -> tuple[Value, Value, Value]:
        """A vector parameter: three numbers or three formulas, times its load controller."""
        x, y, z = self.formulas(leaf) if leaf.type == "math" else self.components(leaf, 3)
        return x, y, z

    def formulas(self, leaf: Component) -> tuple[Value, Value, Value]:
        """Three formulas separated by commas, times a load controller."""
        parts = leaf.text.split(",")
        if len(parts) != 3:
            raise InputError(f"<{leaf.tag}> must be three formulas separated by commas", leaf.where)
        x, y, z = (self._scaled(self.formula(p, leaf), leaf) for p in parts)
        return x, y, z

    def formula(self, text: str, leaf: Component) -> Value:
        referred = self._referred(text, leaf)
        names = ("X", "Y", "Z", "t", *self.model.variables, *referred)
        f = compiled(text, names, dict(self.model.variables), leaf.where)
        if referred:
            def value(X: np.ndarray, Y: np.ndarray, Z: np.ndarray, t: float) -> np.ndarray:
                place = np.stack([X, Y, Z], axis=-1)
                return np.asarray(f(X, Y, Z, t, **{k: v(t, place) for k, v in referred.items()}))

            return Expression(value, steady=f.steady and all(v.steady for v in referred.values()))
        if f.uniform and f.steady:
            v = float(f())
            if not math.isfinite(v):
                raise InputError(f'<{leaf.tag}>: the formula "{text.strip()}" gives {v:g}', leaf.where)
            return Constant(v)
        return Expression(f, steady=f.steady)

    def _referred(self, text: str, leaf: Component) -> dict[str, Value]:
        """Parameters of materials that a formula refers to, ``${fem.material('name').E}``, by that text."""
        out: dict[str, Value] = {}
        for whole, name, parameter in _PARAMETER.findall(text):
            material = next((m for m in self.model.materials if m.name == name), None)
            found = None if material is None else material.child(parameter)
            if found is None:
                raise InputError(f'there is no parameter "{parameter}" of a material "{name}"', leaf.where)
            out[whole] = self.value(found)
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
        if not maps:
            self.refuse(f"a map as <{leaf.tag}>", leaf.where)
        elif data.kind == "element" and maps in self.blocks:
            return Map(self.element_rows(leaf, maps, 1)[:, 0])
        elif data.kind == "node" and maps not in self.blocks and data.values is not None:
            return Map(self._node_map(data, maps, leaf))
        else:
            self.refuse(f'the {data.kind} map "{name}"', data.where)
        return Constant(0.0)

    def _node_map(self, data: MeshData, ref: str, leaf: Component) -> np.ndarray:
        """A node map by the places of its own set, which FEBio takes for those of the set it is used on."""
        mesh = self.model.mesh
        out = np.zeros(len(node_indices(mesh, data.set, data.where)))
        wanted = len(node_indices(mesh, ref, leaf.where))
        if len(out) < wanted:
            raise InputError(
                f'<{leaf.tag}>: the map "{data.name}" is of {len(out)} nodes, "{ref}" has {wanted}', leaf.where
            )
        items = map_items(mesh, data)
        out[items] = np.asarray(data.values, float).reshape(len(items), -1)[:, 0]
        return out

    def element_rows(self, leaf: Component, part: str, width: int) -> np.ndarray:
        """The map that ``leaf`` names: its first ``width`` columns, one row for each element of a part."""
        name = (leaf.child("map") or leaf).text.strip()
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
            if d.values is None or d.items is None:
                self.refuse(f'element data "{d.name}" made by {d.spec.type}', d.where)
                return np.zeros((len(block.ids), 9))
            ids = element_ids(mesh, d.set, d.where)[map_items(mesh, d)]
            given.append((ids.tolist(), np.asarray(d.values, float).reshape(len(d.values), -1)))
        out = np.full((len(block.ids), max((v.shape[1] for _, v in given), default=9)), np.nan)
        for ids, rows in given:
            for i, row in zip(ids, rows, strict=True):
                k = order.get(i)
                if k is not None:
                    out[k, : len(row)] = row
        return out

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
