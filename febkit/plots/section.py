"""Cross-sections of an element field on the deformed mesh, with flux arrows (study fig 8)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from febkit.metrics.fields import COMPONENTS, FIELDS, element_fields
from febkit.metrics.tables import with_unit
from febkit.model import InputError

from . import canvas

if TYPE_CHECKING:
    import xarray as xr

    from febkit.model import Model

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
AXES = "xyz"


@dataclass(frozen=True, slots=True, eq=False)
class Section:
    """Polygons where a plane cuts elements: ``corners`` (polygon, k, 2) padded with NaN, ``rows`` of the
    elements (into those given), ``parts`` (polygon,) part of each."""

    corners: Floats
    rows: Ints
    parts: Ints

    def polygons(self) -> list[Floats]:
        return [p[np.isfinite(p[:, 0])] for p in self.corners]

    def centres(self) -> Floats:
        """(polygon, 2) means of the corners."""
        return np.asarray(np.nanmean(self.corners, axis=1))


def cut(ds: xr.Dataset, time: int, normal: str = "y", at: float = 0.0, rows: Ints | None = None) -> Section:
    """Section of the solid elements by the material plane ``normal`` = ``at`` of the reference configuration,
    in its deformed place: models of one mesh are cut through the same material, wherever they moved."""
    from febkit.results.mesh import texts
    from febkit.solver import elements

    rows = np.arange(ds.sizes["element"]) if rows is None else rows
    X = np.asarray(ds["X"].values, dtype=float)
    x = X + np.asarray(ds["displacement"][time].values, dtype=float)
    n = AXES.index(normal)
    plane = [i for i in range(3) if i != n]
    conn = np.asarray(ds["connectivity"].values)
    code = np.asarray(ds["element_type"].values)
    part = np.asarray(ds["part"].values)
    found = []
    for k, name in enumerate(texts(ds, "element_types")):
        mine = np.flatnonzero(code[rows] == k)
        if elements.get(name).dim == 3 and len(mine):
            edges = np.array([e[:2] for e in elements.get(name).edges])
            nodes = conn[rows[mine]][:, : elements.get(name).nodes]
            corners, hit = _polygons(X[nodes][:, :, n] - at, x[nodes][:, :, plane], edges)
            found.append((corners, mine[hit]))
    width = max((c.shape[1] for c, _ in found), default=3)
    pad = [np.pad(c, ((0, 0), (0, width - c.shape[1]), (0, 0)), constant_values=np.nan) for c, _ in found]
    hit = np.concatenate([h for _, h in found]) if found else np.zeros(0, dtype=np.int64)
    return Section(np.concatenate(pad) if pad else np.zeros((0, 3, 2)), hit, part[rows[hit]])


def _polygons(d: Floats, x: Floats, edges: Ints) -> tuple[Floats, Ints]:
    """Corners (polygon, edge, 2), in order around each polygon, NaN last; indices of the elements cut.

    ``d`` (e, n) distance of the nodes from the plane, ``x`` (e, n, 2) their places in the picture.
    """
    d = np.where(d == 0, 1e-300, d)
    hit = np.flatnonzero((d.min(axis=1) < 0) & (d.max(axis=1) > 0))
    x, d = x[hit], d[hit]
    a, b = d[:, edges[:, 0]], d[:, edges[:, 1]]
    crosses = a * b < 0
    with np.errstate(divide="ignore", invalid="ignore"):
        s = np.where(crosses, a / (a - b), np.nan)[..., None]
    p = x[:, edges[:, 0]] * (1 - s) + x[:, edges[:, 1]] * s
    centre = np.nanmean(p, axis=1, keepdims=True)
    angle = np.arctan2(p[..., 1] - centre[..., 1], p[..., 0] - centre[..., 0])
    order = np.argsort(np.where(np.isnan(angle), np.inf, angle), axis=1)
    return np.take_along_axis(p, order[..., None], axis=1), hit


def sections(
    results: Mapping[str, tuple[xr.Dataset, Model | None]],
    field: str = "effective_strain",
    time: float = 5.0,
    normal: str = "y",
    at: float = 0.0,
    parts: Sequence[str] | None = None,
    arrows: bool = True,
    title: str = "",
    limits: tuple[float, float] | None = None,
    window: tuple[float, float, float, float] | None = None,
) -> Any:
    """Sections of several results side by side, one colour scale.

    results  label -> (result, model or None); the model gives flux and stress where the plotfile lacks them
    field    one of the element fields (scalar), by default the effective strain
    parts    parts shown; all by default. ``window``: (left, right, bottom, top) in the deformed plane
    """
    if field not in FIELDS or field in COMPONENTS:
        raise InputError(
            f"{field!r} is no scalar element field; choose from effective_strain, effective_stress, "
            "max_shear_strain, volume"
        )
    figure, axes = canvas.grid(1, len(results), 3.6, 3.4)
    made = [_prepare(ds, model, field, time, normal, at, parts, arrows) for ds, model in results.values()]
    unit = made[0][3]
    if any(u != unit for *_, u in made):
        raise InputError(f"{field} is in different units: {', '.join(u or 'unknown' for *_, u in made)}")
    if limits is None:
        values = np.concatenate([v for _, v, *_ in made])
        limits = (float(np.nanquantile(values, 0.01)), float(np.nanquantile(values, 0.99)))
    for ax, (label, (ds, _)), (section, values, flux, _) in zip(axes[0], results.items(), made):
        picture = _draw(ax, section, values, flux, normal, limits, window)
        ax.set_title(label)
        for axis, name in zip((ax.xaxis, ax.yaxis), (a for a in AXES if a != normal)):
            axis.set_label_text(with_unit(name, canvas.unit_of(ds["X"])))
    label = with_unit(field.replace("_", " "), unit)
    figure.colorbar(picture, ax=list(axes[0]), label=label, shrink=0.85)
    figure.suptitle(title)
    return figure


def _prepare(
    ds: xr.Dataset,
    model: Model | None,
    field: str,
    time: float,
    normal: str,
    at: float,
    parts: Sequence[str] | None,
    arrows: bool,
) -> tuple[Section, Floats, Floats | None, str]:
    """The section, values and flux of its elements, and the unit of the values."""
    from febkit.metrics.selection import part_rows

    t = np.asarray(ds["time"].values, dtype=float)
    k = int(np.abs(t - time).argmin())
    if abs(t[k] - time) > 1e-3 * max(abs(time), 1e-3):
        raise InputError(f"no state at t = {time:g}; the nearest is {t[k]:g}")
    rows = (
        np.arange(ds.sizes["element"])
        if parts is None
        else np.unique(np.concatenate([part_rows(ds, p) for p in parts]))
    )
    section = cut(ds, k, normal, at, rows)
    if not len(section.rows):
        raise InputError(f"the plane {normal} = {at:g} cuts no element of these parts")
    near = rows[section.rows]
    names = [field, "fluid_flux"] if arrows else [field]
    f = element_fields(ds.isel(time=[k]), {"cut": near}, model, names)
    if field not in f:
        raise InputError(f"{field} cannot be had from this result without its model")
    at_row = np.searchsorted(f["element_row"].values, near)
    flux = f["fluid_flux"].values[0, at_row] if "fluid_flux" in f else None
    return section, f[field].values[0, at_row], flux, canvas.unit_of(f[field])


def _draw(
    ax: Any,
    section: Section,
    values: Floats,
    flux: Floats | None,
    normal: str,
    limits: tuple[float, float],
    window: tuple[float, float, float, float] | None,
) -> Any:
    from matplotlib.collections import PolyCollection

    plane = [i for i in range(3) if AXES[i] != normal]
    picture = PolyCollection(
        section.polygons(), array=values, cmap="magma", edgecolors="face", linewidths=0.2
    )
    picture.set_clim(*limits)
    ax.add_collection(picture)
    box = window or _box(section)
    if flux is not None:
        _arrows(ax, section.centres(), flux[:, plane], box)
    _outlines(ax, section)
    ax.set_xlim(box[0], box[1])
    ax.set_ylim(box[2], box[3])
    ax.set_aspect("equal")
    ax.tick_params(labelsize=7)
    return picture


def _box(section: Section) -> tuple[float, float, float, float]:
    low, high = np.nanmin(section.corners, axis=(0, 1)), np.nanmax(section.corners, axis=(0, 1))
    margin = 0.02 * (high - low)
    return (low[0] - margin[0], high[0] + margin[0], low[1] - margin[1], high[1] + margin[1])


def _arrows(ax: Any, centre: Floats, q: Floats, box: tuple[float, float, float, float], n: int = 16) -> None:
    """One arrow in each square of an n by n raster, its length by the root of the flux."""
    i = ((centre - [box[0], box[2]]) / [box[1] - box[0], box[3] - box[2]] * n).astype(int)
    inside = ((i >= 0) & (i < n)).all(axis=1)
    _, first = np.unique(i[inside] @ [1, n], return_index=True)
    pick = np.flatnonzero(inside)[first]
    size = np.linalg.norm(q[pick], axis=1)
    if not len(pick) or size.max() == 0:
        return
    v = q[pick] / np.sqrt(np.where(size > 0, size, 1))[:, None] / np.sqrt(size.max())
    ax.quiver(
        *centre[pick].T,
        *v.T,
        color="white",
        scale=n * 1.1,
        width=0.004,
        headwidth=4,
        edgecolor="0.2",
        linewidth=0.2,
    )


def _outlines(ax: Any, section: Section) -> None:
    """Borders between parts: polygon sides that only one polygon of a part has."""
    from matplotlib.collections import LineCollection

    lines = []
    for part in np.unique(section.parts):
        sides: dict[tuple[tuple[float, float], ...], Floats] = {}
        for p in (section.corners[k] for k in np.flatnonzero(section.parts == part)):
            p = p[np.isfinite(p[:, 0])]
            scale = 1e-6 * max(np.ptp(section.corners[..., 0][np.isfinite(section.corners[..., 0])]), 1e-30)
            for a, b in zip(p, np.roll(p, -1, axis=0)):
                ka, kb = (tuple(np.rint(v / scale).astype(int)) for v in (a, b))
                key = (min(ka, kb), max(ka, kb))
                if sides.pop(key, None) is None:
                    sides[key] = np.array([a, b])
        lines += list(sides.values())
    ax.add_collection(LineCollection(lines, colors="white", linewidths=0.5))
