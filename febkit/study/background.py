"""The tissue's own material around the cells: what it is at a point, as numbers, in place of the cell model's."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from febkit.model import Component, InputError, Model, Where

if TYPE_CHECKING:
    from febkit.lower.context import Context

Floats = NDArray[np.float64]


def with_background(cell: Model, tissue: Model, at: Sequence[float], name: str) -> tuple[Model, list[str]]:
    """The cell model whose material ``name`` is the tissue's at the point ``at``, and what was put in its place.

    Maps give the value of the element that holds the point, formulas of X, Y, Z theirs at the point, local axes and
    fiber directions theirs there. Raises InputError where the models cannot share a material, or values follow time.
    """
    old = next((m for m in cell.materials if m.name == name), None)
    if old is None:
        known = ", ".join(m.name or "" for m in cell.materials)
        raise InputError(
            f"the cell model has no material {name!r} to be the tissue's; it has {known}: name one in [coupling], "
            "material = ...",
            Where(cell.file),
        )
    if cell.module != tissue.module:
        raise InputError(
            f'the cell model is "{cell.module}", the tissue "{tissue.module}": they cannot share a material',
            Where(cell.file),
        )
    found, part = material_at(tissue, at)
    new = replace(found, name=old.name, id=old.id)
    said = [f"material {name} is the tissue's {found.name} in part {part}: " + ", ".join(_numbers(new))]
    return replace(cell, materials=tuple(new if m is old else m for m in cell.materials), document=None), said


def material_at(model: Model, at: Sequence[float]) -> tuple[Component, str]:
    """The material at a point of a model, with numbers for maps and formulas, and the part that the point lies in."""
    from febkit import coupling
    from febkit.lower.context import Context

    X = np.asarray(at, dtype=float)[None]
    field = coupling.from_mesh(model.mesh, np.zeros(1), np.zeros((1, len(model.mesh.X), 3)))
    where = coupling.locate(field, X)
    if not where.inside[0]:
        raise InputError(f"({', '.join(f'{x:g}' for x in at)}) lies outside the tissue", Where(model.file))
    label = field.blocks[where.block[0]].ids[where.element[0]]
    block = next(b for b in model.mesh.blocks if (b.ids == label).any())
    element = int(np.flatnonzero(block.ids == label)[0])
    domain = next((d for d in model.domains if d.block == block.name), None)
    named = {m.name: m for m in model.materials}
    if domain is None or domain.material not in named:
        raise InputError(f'part "{block.name}" of the tissue has no material', Where(model.file))
    return _Local(Context(model), block.name, X, element).material(named[domain.material]), block.name


class _Local:
    """Values of a model at one point ``X`` (1, 3) in one element of a part."""

    def __init__(self, ctx: Context, part: str, X: Floats, element: int) -> None:
        self.ctx, self.part, self.X, self.e = ctx, part, X, np.array([element])
        self.maps = {d.name for d in ctx.model.mesh_data}

    def material(self, m: Component) -> Component:
        from febkit.lower.axes import element_axes

        out = self.fixed(m)
        if self.ctx.refused:
            raise self.ctx.refused[0]
        Q = element_axes(self.ctx, self.part)
        if Q is None:
            return out
        return replace(out, children=(*(c for c in out if c.tag != "mat_axis"), _axes(m, Q[self.e][0])))

    def fixed(self, c: Component) -> Component:
        """A component without anything that varies in space."""
        from febkit.lower import axes

        if c.lc is not None:
            raise InputError(
                f"{c.what} follows a load curve: the cells' surroundings cannot take it over", c.where
            )
        if c.tag == "mat_axis" and c.type not in (None, "vector"):
            return _axes(c, self._seen(axes.mat_axis(self.ctx, c, self.part)))
        if c.tag == "fiber" and c.type in axes.DIRECTION and c.type != "vector":
            text = _text(self._seen(axes.direction(self.ctx, c, self.part)))
            return replace(c, type="vector", text=text, children=())
        if c.type == "map":
            name = (c.child("map") or c).text.strip()
            rows = self.ctx.element_map(self.ctx.map_data(name, c), self.part)[self.e][0]
            if np.isnan(rows).any():
                self.ctx.element_rows(c, self.part, len(rows), name)  # says which element the map leaves out
            return replace(c, type=None, text=_text(rows), children=(), attrs={})
        if c.children:
            return replace(c, children=tuple(self.fixed(x) for x in c))
        return self._leaf(c)

    def _leaf(self, c: Component) -> Component:
        if c.type != "math" and not self._names_a_map(c.text):
            return c
        value = self.ctx.value(c, maps=self.part)
        if not value.steady:
            raise InputError(
                f'{c.what}: the formula "{c.text.strip()}" follows time: the cells\' surroundings cannot take it '
                "over",
                c.where,
            )
        return replace(c, type=None, text=_text(value(0.0, self.X, self.e)[:1]), attrs={})

    def _names_a_map(self, text: str) -> bool:
        import re

        return bool(self.maps.intersection(re.findall(r"[A-Za-z_]\w*", text)))

    def _seen(self, what: Any) -> Floats:
        """Axes (3, 3) or a direction (3,) at the point."""
        from febkit.solver.points import Points

        if what is None:
            raise self.ctx.refused[0]
        one = np.eye(3)[None]
        found: Floats = np.asarray(what(Points(F=one, J=np.ones(1), X=self.X, e=self.e)))[0]
        return found


def _axes(c: Component, Q: Floats) -> Component:
    """<mat_axis type="vector"> of axes that are columns (3, 3)."""
    leaves = (Component("a", text=_text(Q[:, 0])), Component("d", text=_text(Q[:, 1])))
    return Component("mat_axis", "vector", children=leaves, where=c.where)


def _text(v: Floats) -> str:
    return ",".join(repr(float(x)) for x in np.ravel(v))


def _numbers(c: Component) -> list[str]:
    """Leaves that are one number, as "E = 0.5"."""
    out = []
    for x in c:
        out += _numbers(x) if x.children else [f"{x.tag} = {x.text.strip()}"] if x.text.strip() else []
    return out
