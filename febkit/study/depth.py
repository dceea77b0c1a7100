"""How deep points lie in a tissue: the heights of its top and bottom above and below each of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from febkit.model import InputError, Where

from .points import Point, Points

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
NEAR = 1e-6  # of the tissue's height: so far outside a point still counts as on the surface


@dataclass(frozen=True, slots=True, eq=False)
class Column:
    """The outer surface of a tissue as triangles (n, 3, 3), flat or curved; depth runs along -z."""

    triangles: Floats

    @classmethod
    def of(cls, X: Floats, parts: Sequence[tuple[str, Ints]], where: Where) -> Column:
        from febkit.model.elements import ELEMENTS, FACES

        quads: list[Ints] = []
        for kind, conn in parts:
            for _, nodes in FACES[ELEMENTS[kind].shape] if ELEMENTS[kind].dim == 3 else ():
                quads.append(
                    conn[:, [*nodes, *nodes[-1:] * (4 - len(nodes))]]
                )  # a triangle names its last corner twice
        if not quads:
            raise InputError("the tissue has no solid elements to tell depths by", where)
        every = np.concatenate(quads)
        _, first, count = np.unique(np.sort(every, axis=1), axis=0, return_index=True, return_counts=True)
        outer = every[first[count == 1]]
        return cls(np.concatenate([X[outer[:, [0, 1, 2]]], X[outer[:, [0, 2, 3]]]]))

    def heights(self, x: float, y: float) -> tuple[float, float] | None:
        """z of bottom and top on the vertical through (x, y); None where it passes the tissue by."""
        T = self.triangles
        low, high = T[:, :, :2].min(axis=1), T[:, :, :2].max(axis=1)
        slack = NEAR * float((high - low).max())
        at = np.array([x, y])
        near = ((low - slack <= at) & (at <= high + slack)).all(axis=1)
        a, b, c = T[near].swapaxes(0, 1)
        area = _cross(b - a, c - a)
        size = np.linalg.norm(b - a, axis=1) * np.linalg.norm(c - a, axis=1)
        flat = np.abs(area) > 1e-9 * size  # those that stand upright have no area from above
        a, b, c, area = a[flat], b[flat], c[flat], area[flat]
        p = np.append(at, 0.0)
        wb, wc = _cross(p - a, c - a) / area, _cross(b - a, p - a) / area
        inside = (wb >= -NEAR) & (wc >= -NEAR) & (wb + wc <= 1 + NEAR)
        z = (a[:, 2] + wb * (b - a)[:, 2] + wc * (c - a)[:, 2])[inside]
        return (float(z.min()), float(z.max())) if len(z) else None


def _cross(u: Floats, v: Floats) -> Floats:
    """The third component of u x v."""
    w: Floats = u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]
    return w


def placed(
    points: Points, columns: Mapping[str, Column], where: Where
) -> tuple[tuple[Point, ...], tuple[float, ...]]:
    """Coordinates and normalised depths of points, the same in each of the tissues (by case).

    Raises InputError for points outside, and where tissues of several cases have other heights.
    """
    at: list[Point] = []
    depths: list[float] = []
    found: dict[tuple[float, float], tuple[float, float]] = {}
    for k, (x, y, third) in enumerate(points.rows):
        if (x, y) not in found:
            found[x, y] = _one({c: q.heights(x, y) for c, q in columns.items()}, k, points.rows[k], where)
        low, high = found[x, y]
        tall = high - low
        z = float(f"{high - third * tall:.12g}") if points.depths else third
        if not low - NEAR * tall <= z <= high + NEAR * tall:
            raise InputError(_outside(k, (x, y, z), low, high), where)
        at.append((x, y, z))
        depths.append(float(np.clip(third if points.depths else (high - z) / tall, 0.0, 1.0)))
    return tuple(at), tuple(depths)


def check_inside(points: Points, columns: Mapping[str, Column], where: Where) -> None:
    """Raises InputError where a point lies outside the tissue of a case."""
    for k, row in enumerate(points.rows):
        for case, column in columns.items():
            low, high = _found(column.heights(row[0], row[1]), case, k, row, where)
            if not low - NEAR * (high - low) <= row[2] <= high + NEAR * (high - low):
                raise InputError(_outside(k, row, low, high), where)


def check_centre(columns: Mapping[str, Column], where: Where) -> None:
    """Raises InputError where (0, 0, 0), taken for want of points, is not inside."""
    for column in columns.values():
        found = column.heights(0.0, 0.0)
        if found is None or not found[0] < 0.0 < found[1]:
            raise InputError(
                "it is not said where the cells are, and (0, 0, 0) is not inside the tissue: say so in [points]", where
            )


def _outside(k: int, row: Point, low: float, high: float) -> str:
    said = ", ".join(f"{c:g}" for c in row)
    return f"point {k + 1} ({said}) lies outside the tissue, which reaches from z = {low:g} to {high:g} there"


def _found(
    heights: tuple[float, float] | None, case: str, k: int, row: Point, where: Where
) -> tuple[float, float]:
    if heights is None:
        raise InputError(
            f"point {k + 1} ({row[0]:g}, {row[1]:g}, {row[2]:g}) lies outside the tissue of case {case}: no part "
            "of it is above or below",
            where,
        )
    return heights


def _one(
    heights: Mapping[str, tuple[float, float] | None], k: int, row: Point, where: Where
) -> tuple[float, float]:
    first: tuple[float, float] | None = None
    for case, one in heights.items():
        h = _found(one, case, k, row, where)
        if first is not None and max(abs(h[0] - first[0]), abs(h[1] - first[1])) > 1e-6 * (
            first[1] - first[0]
        ):
            raise InputError(
                f"the tissue of case {case} reaches from z = {h[0]:g} to {h[1]:g} at point {k + 1}, that of case "
                f"{next(iter(heights))} from {first[0]:g} to {first[1]:g}: depths must be the same in all "
                "cases; make a study of each",
                where,
            )
        first = first or h
    assert first is not None
    return first


def columns(tissues: Mapping[str, Mapping[str, Any]], where: Where) -> dict[str, Column]:
    """The tissue of each case: its template's mesh, the mesh of its model, or that of its results."""
    out: dict[str, Column] = {}
    made: dict[str, Column] = {}
    for case, table in tissues.items():
        same = repr(sorted((k, repr(v)) for k, v in table.items() if k != "case"))
        if same not in made:
            made[same] = _column(table, where)
        out[case] = made[same]
    return out


def _column(table: Mapping[str, Any], where: Where) -> Column:
    if "file" in table:
        from febkit import feb

        mesh = feb.read(table["file"]).mesh
    elif "results" in table:
        from febkit import results
        from febkit.coupling.field import solid_blocks

        with results.open(table["results"]) as ds:
            X = np.asarray(ds["X"].values, dtype=float)
            return Column.of(X, [(b.type, b.conn) for b in solid_blocks(ds)], Where(table["results"]))
    else:
        from febkit.templates.generators import GENERATORS

        from .models import template_of, values_of

        t = template_of(table, "tissue")
        mesh = GENERATORS[t.mesh](values_of(t, table, where)).mesh
    return Column.of(
        mesh.X, [(b.type, b.conn) for b in mesh.blocks], Where(str(Path(str(table.get("file", where)))))
    )
