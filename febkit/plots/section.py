"""Cross-sections of any quantity on the deformed mesh, with flux arrows (study fig 8)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from febkit.metrics.fields import element_fields
from febkit.model import InputError

from . import canvas
from .quantity import Quantity, clock, quantity, time_index

if TYPE_CHECKING:
    import xarray as xr

    from febkit.model import Model

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
AXES = "xyz"
_MANY = 5000  # polygons above which a PDF or SVG holds them as a picture


@dataclass(frozen=True, slots=True, eq=False)
class Section:
    """Polygons where a plane cuts elements: ``corners`` (polygon, k, 2) padded with NaN, ``rows`` of the
    elements (into those given), ``parts`` (polygon,) part of each. A corner lies on the edge between the nodes
    ``ends`` (polygon, k, 2), at the ``share`` (polygon, k) of the second."""

    corners: Floats
    rows: Ints
    parts: Ints
    ends: Ints
    share: Floats

    def polygons(self) -> list[Floats]:
        return [p[np.isfinite(p[:, 0])] for p in self.corners]

    def centres(self) -> Floats:
        """(polygon, 2) means of the corners."""
        return np.asarray(np.nanmean(self.corners, axis=1))

    def at_corners(self, nodal: Floats) -> Floats:
        """(polygon, k) of nodal values (node,), linear along the edges that are cut."""
        a, b = nodal[self.ends[..., 0]], nodal[self.ends[..., 1]]
        return np.asarray(np.where(np.isfinite(self.corners[..., 0]), a + self.share * (b - a), np.nan))


def cut(
    ds: xr.Dataset, time: int, normal: str = "y", at: float = 0.0, rows: Ints | None = None, scale: float = 1.0
) -> Section:
    """Section of the solid elements by the material plane ``normal`` = ``at`` of the reference configuration,
    in its deformed place: models of one mesh are cut through the same material, wherever they moved.
    Displacements are drawn ``scale`` times as large."""
    from febkit.results.mesh import texts
    from febkit.solver import elements

    rows = np.arange(ds.sizes["element"]) if rows is None else rows
    X = np.asarray(ds["X"].values, dtype=float)
    x = X + scale * np.asarray(ds["displacement"][time].values, dtype=float) if "displacement" in ds else X
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
            hit, *corners = _polygons(X[nodes][:, :, n] - at, x[nodes][:, :, plane], edges, nodes)
            found.append((mine[hit], *corners))
    if not found:
        none = np.zeros(0, dtype=np.int64)
        return Section(np.zeros((0, 3, 2)), none, none, np.zeros((0, 3, 2), dtype=np.int64), np.zeros((0, 3)))
    width = max(f[1].shape[1] for f in found)
    hit = np.concatenate([f[0] for f in found])
    xy, ends, share = (np.concatenate([_wide(f[i], width, fill) for f in found])
                       for i, fill in ((1, np.nan), (2, 0), (3, np.nan)))  # fmt: skip
    return Section(xy, hit, part[rows[hit]], ends, share)


def _wide(a: Any, width: int, fill: float) -> Any:
    return np.pad(a, ((0, 0), (0, width - a.shape[1]), *[(0, 0)] * (a.ndim - 2)), constant_values=fill)


def _polygons(d: Floats, x: Floats, edges: Ints, nodes: Ints) -> tuple[Ints, Floats, Ints, Floats]:
    """Indices of the elements cut; corners (polygon, edge, 2), in order around each polygon, NaN last; the nodes that
    each lies between, and the share of the second.

    ``d`` (e, n) distance of the nodes from the plane, ``x`` (e, n, 2) their places in the picture.
    """
    d = np.where(d == 0, 1e-300, d)
    hit = np.flatnonzero((d.min(axis=1) < 0) & (d.max(axis=1) > 0))
    x, d, nodes = x[hit], d[hit], nodes[hit]
    a, b = d[:, edges[:, 0]], d[:, edges[:, 1]]
    crosses = a * b < 0
    with np.errstate(divide="ignore", invalid="ignore"):
        s = np.where(crosses, a / (a - b), np.nan)
    p = x[:, edges[:, 0]] * (1 - s)[..., None] + x[:, edges[:, 1]] * s[..., None]
    centre = np.nanmean(p, axis=1, keepdims=True)
    angle = np.arctan2(p[..., 1] - centre[..., 1], p[..., 0] - centre[..., 0])
    order = np.argsort(np.where(np.isnan(angle), np.inf, angle), axis=1)
    ends = np.take_along_axis(nodes[:, edges], order[..., None], axis=1)
    return hit, np.take_along_axis(p, order[..., None], axis=1), ends, np.take_along_axis(s, order, axis=1)


def sections(
    results: Mapping[str, tuple[xr.Dataset, Model | None]],
    field: str = "effective_strain",
    time: float | None = None,
    normal: str = "y",
    at: float = 0.0,
    parts: Sequence[str] | None = None,
    arrows: bool = True,
    title: str = "",
    limits: tuple[float, float] | None = None,
    window: tuple[float, float, float, float] | None = None,
    colours: str | None = None,
    scale: float = 1.0,
) -> Any:
    """Sections of several results side by side, one colour scale.

    results  label -> (result, model or None); the model gives flux and stress where the plotfile lacks them
    field    a plot variable, a component or principal value of it, or an element field (:func:`.quantity.quantity`);
             nodal ones are drawn linear between the corners of the section
    time     the last of the first result by default
    parts    parts shown; all by default. ``window``: (left, right, bottom, top) in the deformed plane
    colours  a colour map of matplotlib; ``limits`` its ends; ``scale`` of the displacements
    """
    if normal not in tuple(AXES):
        raise InputError(f"{normal!r} is no axis: x, y or z")
    cmap = canvas.colour_map(colours)
    if time is None:
        first = next(iter(results.values()))[0]
        time = float(first["time"].values[time_index(first, None)])
    made = [_prepare(ds, model, field, time, normal, at, parts, arrows, scale) for ds, model in results.values()]
    like = made[0].quantity
    if any(m.quantity.units != like.units for m in made):
        said = ", ".join(m.quantity.units or "unknown" for m in made)
        raise InputError(f"{field} is in different units: {said}")
    limits = limits or _limits(made, field)
    boxes = [window or _box(m.section) for m in made]
    figure, axes = _frame(boxes)
    for ax, box, m, (label, (ds, _)) in zip(axes[0], boxes, made, results.items()):
        picture = _draw(ax, m, normal, limits, box, cmap)
        ax.set_title(label)
        for axis, name in zip((ax.xaxis, ax.yaxis), (a for a in AXES if a != normal)):
            axis.set_label_text(canvas.labelled(name, canvas.unit_of(ds["X"])))
    figure.colorbar(picture, ax=list(axes[0]), label=like.label, shrink=0.85, extend=_beyond(made, limits))
    figure.suptitle(title or clock(next(iter(results.values()))[0], made[0].state))
    return figure


@dataclass(frozen=True, slots=True, eq=False)
class _Made:
    """A section with the values on it, by polygon (n,) or by corner (n, k), and the flux in its elements."""

    section: Section
    quantity: Quantity
    values: Floats
    flux: Floats | None
    state: int


def _limits(made: Sequence[_Made], field: str) -> tuple[float, float]:
    values = np.concatenate([m.values.ravel() for m in made])
    values = values[np.isfinite(values)]
    if not len(values):
        raise InputError(f"{field} has no value on what is shown")
    low, high = (float(q) for q in np.quantile(values, (0.01, 0.99)))
    return (low, high) if high - low > 1e-12 * max(abs(low), abs(high)) else widened(low)


def widened(value: float) -> tuple[float, float]:
    """Ends of colours around a value that is the same everywhere."""
    by = 0.05 * abs(value) or 1.0
    return value - by, value + by


def _beyond(made: Sequence[_Made], limits: tuple[float, float]) -> str:
    """Which ends of the bar values lie beyond, by more than rounding."""
    low = min(float(np.nanmin(m.values)) for m in made)
    high = max(float(np.nanmax(m.values)) for m in made)
    slack = 1e-6 * (limits[1] - limits[0])
    below, above = low < limits[0] - slack, high > limits[1] + slack
    return "both" if below and above else "min" if below else "max" if above else "neither"


def _frame(boxes: Sequence[tuple[float, float, float, float]]) -> tuple[Any, Any]:
    """Axes as wide as what they show is beside its height."""
    aspect = max((b[1] - b[0]) / max(b[3] - b[2], 1e-300) for b in boxes)
    wide = float(np.clip(2.6 * aspect, 2.0, 5.0))
    figure = canvas.blank(wide * len(boxes) + 1.6, float(np.clip(wide / aspect, 1.2, 4.0)) + 1.1)
    with canvas.style():
        return figure, figure.subplots(1, len(boxes), squeeze=False)


def _prepare(
    ds: xr.Dataset,
    model: Model | None,
    field: str,
    time: float,
    normal: str,
    at: float,
    parts: Sequence[str] | None,
    arrows: bool,
    scale: float,
) -> _Made:
    """The section, and the values and flux of its elements."""
    from febkit.metrics.selection import part_rows

    k = time_index(ds, time)
    q = quantity(ds, field, model)
    rows = (
        np.arange(ds.sizes["element"])
        if parts is None
        else np.unique(np.concatenate([part_rows(ds, p) for p in parts]))
    )
    section = cut(ds, k, normal, at, rows, scale)
    if not len(section.rows):
        raise InputError(f"the plane {normal} = {at:g} cuts no element of these parts")
    near = rows[section.rows]
    if q.place == "node":
        values = section.at_corners(q.state(k))
    elif q.place == "element":
        values = q.state(k, near)
    elif q.place == "domain":
        values = q.state(k)[section.parts]
    else:
        raise InputError(f"{q.name} lives on neither nodes nor elements")
    return _Made(section, q, values, _flux(ds, model, k, near) if arrows else None, k)


def _flux(ds: xr.Dataset, model: Model | None, k: int, near: Ints) -> Floats | None:
    """(n, 3) flux of the fluid in elements; None where there is none to be had."""
    f = element_fields(ds.isel(time=[k]), {"cut": near}, model, ["fluid_flux"])
    if "fluid_flux" not in f:
        return None
    return np.asarray(f["fluid_flux"].values[0, np.searchsorted(f["element_row"].values, near)])


def _draw(
    ax: Any,
    made: _Made,
    normal: str,
    limits: tuple[float, float],
    box: tuple[float, float, float, float],
    cmap: Any,
) -> Any:
    plane = [i for i in range(3) if AXES[i] != normal]
    picture = _colours(ax, made, cmap, limits)
    if made.flux is not None:
        _arrows(ax, made.section.centres(), made.flux[:, plane], box)
    _outlines(ax, made.section)
    ax.set_xlim(box[0], box[1])
    ax.set_ylim(box[2], box[3])
    ax.set_aspect("equal")
    return picture


def _colours(ax: Any, made: _Made, cmap: Any, limits: tuple[float, float]) -> Any:
    """Polygons of one colour each, or triangles whose colours run from corner to corner."""
    from matplotlib.collections import PolyCollection

    polygons = made.section.polygons()
    options: dict[str, Any] = {"cmap": cmap, "clim": limits, "rasterized": len(polygons) > _MANY}
    if made.values.ndim == 1:
        picture = PolyCollection(polygons, array=made.values, edgecolors="face", linewidths=0.2, **options)
        return ax.add_collection(picture)
    known = np.isfinite(made.section.corners[..., 0])
    point = np.cumsum(known).reshape(known.shape) - 1
    whole = known[:, 1:-1] & known[:, 2:]
    fan = np.stack([np.broadcast_to(point[:, :1], whole.shape), point[:, 1:-1], point[:, 2:]], axis=-1)[whole]
    x, y = made.section.corners[known].T
    return ax.tripcolor(x, y, fan, made.values[known], shading="gouraud", **options)


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
    # dark with a light rim: seen on every colour, and on white
    ax.quiver(*centre[pick].T, *v.T, color="black", scale=n * 1.1, width=0.005, headwidth=4.5, edgecolor="white",
              linewidth=0.4, zorder=3)  # fmt: skip


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
    for colour, width in (("white", 1.8), ("black", 0.7)):
        ax.add_collection(LineCollection(lines, colors=colour, linewidths=width))
