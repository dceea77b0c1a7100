"""What lowering knows while it works: the model, its controllers, and what it had to refuse."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from febkit.model import Component, InputError, Model, UnsupportedError, Where
from febkit.solver.values import Constant, Expression, Map, Scaled, Value

if TYPE_CHECKING:
    from febkit.model.math import Formula

    from .rigid import Body

Controller = Callable[[float], float]
_PARAMETER = re.compile(r"\$\{(fem\.material\('([^']+)'\)\.(\w+))\}")


def compiled(text: str, names: Iterable[str] | None, constants: Mapping[str, float], where: Where) -> Formula:
    """:func:`febkit.model.math.compile`, imported where a model has a formula."""
    from febkit.model import math

    return math.compile(text, names, constants, where)


class Context:
    """Shared by all parts of the lowering. Refusals are collected, so that a user sees all at once."""

    def __init__(self, model: Model) -> None:
        self.model = model
        self.refused: list[UnsupportedError] = []
        self._controllers: dict[int, Controller] = {}
        self.X = model.mesh.X  # nodes of the problem: the mesh's, then back nodes of shells
        self.rigid: dict[str, Body] = {}  # rigid bodies by the name of their material
        self.centres: list[np.ndarray] = []  # and their centres, by index
        self.numbers: dict[str, int] = {}  # places of the blocks in the problem, by name
        self.back = np.full(len(self.X), -1)  # back node of each mesh node, -1 where it has none

    def refuse(self, what: str, where: Where | None = None) -> None:
        """Note a feature that febkit does not solve."""
        self.refused.append(UnsupportedError(f"{what} is not supported by febkit's solver", where))

    # ---- controllers ------------------------------------------------------------------------------
    def controller(self, number: int, where: Where) -> Controller:
        """The load controller of this id as a function of time."""
        if number not in self._controllers:
            spec = next((c for c in self.model.controllers if c.id == number), None)
            if spec is None:
                raise InputError(f"there is no load controller with id {number}", where)
            self._controllers[number] = self._make_controller(spec)
        return self._controllers[number]

    def _make_controller(self, spec: object) -> Controller:
        from febkit.model import LoadController

        assert isinstance(spec, LoadController)
        if spec.type == "loadcurve":
            from febkit.solver.controllers import LoadCurve


            interpolate = spec.spec.str("interpolate", "LINEAR") or "LINEAR"
            extend = spec.spec.str("extend", "CONSTANT") or "CONSTANT"
            try:
                return LoadCurve(np.array(spec.points, dtype=float).reshape(-1, 2), interpolate, extend)
            except ValueError as e:
                raise InputError(f"load controller {spec.id}: {e}", spec.where) from None
        if spec.type in ("math", "math-interval"):
            leaf = spec.spec.need("math")
            names = {"t", *self.model.variables}
            f = compiled(leaf.text, names, dict(self.model.variables), leaf.where)
            if spec.type == "math":
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
        base = self._base(leaf, maps)
        return base if leaf.lc is None else Scaled(base, self.controller(leaf.lc, leaf.where))

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
        try:
            return Constant(float(leaf.text))
        except ValueError:
            return self.formula(leaf.text, leaf)

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
            return Constant(float(f()))
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

    def _map(self, name: str, leaf: Component, maps: str) -> Value:
        data = next((d for d in self.model.mesh_data if d.name == name), None)
        if data is None:
            raise InputError(f'there is no map "{name}" in <MeshData>', leaf.where)
        if not maps:
            self.refuse(f'a map as <{leaf.tag}>', leaf.where)
            return Constant(0.0)
        if data.kind == "element":
            return Map(self.element_map(data, maps)[:, 0])
        if data.kind == "node" and data.values is not None:
            return Map(np.asarray(data.values, float).reshape(len(data.values), -1)[:, 0])
        self.refuse(f'the {data.kind} map "{name}"', data.where)
        return Constant(0.0)

    def element_map(self, data: object, part: str) -> np.ndarray:
        """Rows of an element map by the elements of a block; NaN where the map says nothing."""
        from febkit.model import MeshData
        from febkit.model.sets import element_ids

        assert isinstance(data, MeshData)
        block = self.blocks[part]
        ids = element_ids(self.model.mesh, data.set, data.where)
        if data.values is None or data.items is None:
            self.refuse(f'element data "{data.name}" made by {data.spec.type}', data.where)
            return np.zeros((len(block.ids), 3))
        values = np.asarray(data.values, float).reshape(len(data.values), -1)
        order = {int(i): k for k, i in enumerate(block.ids)}
        out = np.full((len(block.ids), values.shape[1]), np.nan)
        for lid, row in zip(np.asarray(data.items, int), values):
            k = order.get(int(ids[lid - 1]))
            if k is not None:
                out[k] = row
        return out

    @cached_property
    def blocks(self) -> dict:
        return {b.name: b for b in self.model.mesh.blocks}

    # ---- parameters -------------------------------------------------------------------------------
    def check_tags(self, spec: Component, known: set[str] | frozenset[str]) -> None:
        """Refuse parameters of a component that would otherwise be passed over in silence."""
        for c in spec:
            if c.tag not in known:
                label = f' type="{spec.type}"' if spec.type else ""
                self.refuse(f"<{c.tag}> of <{spec.tag}{label}>", c.where)
