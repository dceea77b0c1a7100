"""Local material axes and fiber directions: <mat_axis>, <fiber>, and element data of these."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import numpy as np

from febkit.model import Component, InputError, MeshData, values
from febkit.solver.solids import axes

from .context import Context

Make = Callable[[Context, Component, str], Any]
_INNER = re.compile(r"(\w+)\[(\d+)\]\.fiber")  # path of element data for the fibers of a material within


def element_axes(ctx: Context, part: str) -> np.ndarray | None:
    """Axes (m, 3, 3) from <ElementData type="mat_axis"> on a part, or None where there are none."""
    data = _element_data(ctx, "mat_axis")
    if not data:
        return None
    rows = ctx.element_map(data, part)
    if np.isnan(rows).all():
        return None
    if rows.shape[1] < 6:
        raise InputError('<ElementData type="mat_axis"> must give two vectors <a> and <d> a row', data[0].where)
    Q = axes.element_axes(rows[:, :3], rows[:, 3:6]).Q.copy()
    Q[np.isnan(rows).any(axis=1)] = np.eye(3)
    return Q


def _element_data(ctx: Context, name: str) -> list[MeshData]:
    return [d for d in ctx.model.mesh_data if d.kind == "element" and d.name == name]


def _vec(c: Component, tag: str, default: tuple[float, float, float]) -> tuple[float, ...]:
    leaf = c.child(tag)
    return default if leaf is None else leaf.as_floats(3)


def _coordinates(ctx: Context, part: str) -> np.ndarray:
    return ctx.model.mesh.X[ctx.blocks[part].conn]


def _nodes(ctx: Context, c: Component, part: str, n: int) -> tuple[int, ...]:
    """1-based local nodes that span an axis, 0 where the file names none."""
    leaf = c.child("local") or c
    numbers = tuple(values.integer(x, leaf.what, leaf.where) for x in leaf.text.replace(",", " ").split())
    count = ctx.blocks[part].conn.shape[1]
    for k in numbers:
        if not 0 <= k <= count:
            raise InputError(f'{leaf.what}: an element of part "{part}" has nodes 1 to {count}, not {k}', leaf.where)
    given = (*numbers, *([0] * n))[:n]
    if any(given[:2]) and not (all(given[:2]) and given[0] != given[1]):
        raise InputError(f"{leaf.what} must name two different nodes, not {values.shown(leaf.text)}", leaf.where)
    return given


def _given_axes(c: Component) -> axes.FixedAxes:
    """Axes by the nine numbers of a rotation, row by row."""
    leaf = c.child("const") or c
    Q = np.reshape(leaf.as_floats(9), (3, 3))
    if np.abs(Q @ Q.T - np.eye(3)).max() > 1e-3 or np.linalg.det(Q) < 0.0:
        raise InputError(f"{leaf.what} must be a rotation, its columns unit vectors at right angles", leaf.where)
    return axes.FixedAxes(Q[None])


MAT_AXIS: dict[str, Make] = {
    "const": lambda _, c, p: _given_axes(c),
    "vector": lambda _, c, p: axes.vector_axes(_vec(c, "a", (1, 0, 0)), _vec(c, "d", (0, 1, 0))),
    "local": lambda x, c, p: axes.local_axes(_coordinates(x, p), _nodes(x, c, p, 3)),  # type: ignore[arg-type]
    "angles": lambda x, c, p: axes.AngleAxes(x.value(c.child("theta"), 0.0, p), x.value(c.child("phi"), 90.0, p)),
    "spherical": lambda _, c, p: axes.SphericalAxes(_vec(c, "center", (0, 0, 0)), _vec(c, "vector", (1, 0, 0))),
    "cylindrical": lambda _, c, p: axes.CylindricalAxes(
        _vec(c, "center", (0, 0, 0)), _vec(c, "axis", (0, 0, 1)), _vec(c, "vector", (1, 0, 0))
    ),
    "polar": lambda _, c, p: axes.PolarAxes(
        _vec(c, "center", (0, 0, 0)), _vec(c, "axis", (0, 0, 1)), _vec(c, "vector1", (1, 0, 0)),
        _vec(c, "vector2", (1, 0, 0)), c.float("radius1", 0.0), c.float("radius2", 1.0),
    ),
    "map": lambda x, c, p: axes.FixedAxes(x.element_rows(c, p, 9).reshape(-1, 3, 3)),
}  # fmt: skip


def _user_fiber(ctx: Context, c: Component, part: str) -> Any:
    data = _element_data(ctx, "fiber")
    if not data:
        raise InputError('<fiber type="user"> needs <ElementData type="fiber">', c.where)
    return _by_element(ctx.element_map(data, part), data, part)


def _by_element(rows: np.ndarray, data: list[MeshData], part: str) -> Any:
    if rows.shape[1] < 3 or np.isnan(rows[:, :3]).any():
        message = f'<ElementData type="{data[0].name}"> must give three numbers for each element of "{part}"'
        raise InputError(message, data[0].where)
    return axes.fixed_vector(rows[:, :3])


def element_fibers(ctx: Context, spec: Component, part: str) -> Any:
    """Directions from element data that take the place of <fiber>, as in FEBio; None where there are none.

    "fiber" is of the part's material itself, "solid[1].fiber" of the second <solid> in it.
    """
    material = next(d.material for d in ctx.model.domains if d.block == part)
    top = next(m for m in ctx.model.materials if m.name == material)

    def means(path: str) -> bool:
        inner = _INNER.fullmatch(path)
        if inner is None:
            return path == "fiber" and spec is top
        return any(c is spec and k == int(inner[2]) for k, c in enumerate(top.all(inner[1])))

    data = [d for d in ctx.model.mesh_data if d.kind == "element" and means(d.name)]
    rows = ctx.element_map(data, part) if data else np.full((1, 1), np.nan)
    return None if np.isnan(rows).all() else _by_element(rows, data, part)


def _math_fiber(ctx: Context, c: Component, part: str) -> Any:
    return axes.MathVector(*ctx.formulas(c.child("vector") or c.child("math") or c))


DIRECTION: dict[str, Make] = {
    "vector": lambda _, c, p: axes.fixed_vector(
        c.as_floats(3) if c.text.strip() and not c.children else _vec(c, "vector", (1, 0, 0))
    ),
    "local": lambda x, c, p: axes.local_vector(_coordinates(x, p), _nodes(x, c, p, 2)),  # type: ignore[arg-type]
    "angles": lambda x, c, p: axes.AngleVector(x.value(c.child("theta"), 0.0, p), x.value(c.child("phi"), 90.0, p)),
    "spherical": lambda _, c, p: axes.SphericalVector(_vec(c, "center", (0, 0, 0)), _vec(c, "vector", (1, 0, 0))),
    "cylindrical": lambda _, c, p: axes.CylindricalVector(
        _vec(c, "center", (0, 0, 0)), _vec(c, "axis", (0, 0, 1)), _vec(c, "vector", (1, 0, 0))
    ),
    "user": _user_fiber,
    "math": _math_fiber,
    "map": lambda x, c, p: axes.fixed_vector(x.element_rows(c, p, 3)),
}  # fmt: skip


def _make(table: dict[str, Make], ctx: Context, spec: Component, part: str) -> Any:
    kind = spec.type or "vector"
    if kind not in table:
        ctx.refuse(f'<{spec.tag} type="{kind}">', spec.where)
        return None
    return table[kind](ctx, spec, part)


def mat_axis(ctx: Context, spec: Component, part: str) -> Any:
    """<mat_axis type=...>: points -> axes (1|n, 3, 3)."""
    return _make(MAT_AXIS, ctx, spec, part)


def direction(ctx: Context, spec: Component, part: str) -> Any:
    """<fiber type=...>: points -> directions (1|n, 3)."""
    return _make(DIRECTION, ctx, spec, part)
