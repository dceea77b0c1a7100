"""Metrics over the depth of a tissue, with their spread over seeds and cells, and over the size of a model of cells."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from febkit.metrics.agreement import usual
from febkit.metrics.tables import with_unit
from febkit.model import InputError

from . import canvas

if TYPE_CHECKING:
    import xarray as xr

Floats = NDArray[np.float64]


def profiles(
    ds: xr.Dataset, times: Sequence[float], metrics: Sequence[str] | None = None, title: str = ""
) -> Any:
    """Axes for each metric: its median at some times against depth, and its range over all that share a depth.

    ds     metrics (point, cell, time) of one case and hand-off, also over seeds, with ``depth`` of the points
    times  times shown: the nearest in the dataset
    """
    names, depth = _names(ds, metrics), _depths(ds)
    at = [int(np.abs(ds["time"].values - t).argmin()) for t in times]
    figure, axes = canvas.grid(-(-len(names) // 3), min(3, len(names)), 2.9, 3.2, sharey=True)
    handles: list[Any] = []
    for ax, m in zip(axes.flat, names):
        v = _pooled(ds[m], ds["depth"].values, depth)  # (depth, time, all others)
        handles = []
        for k, i in enumerate(dict.fromkeys(at)):
            style = canvas.line_style(k)
            low, middle, high = _spread(v[:, i])
            ax.fill_betweenx(depth, low, high, color=style["color"], alpha=0.2, lw=0)
            handles += ax.plot(middle, depth, marker=".", ms=4, **style)
        ax.set_xlabel(canvas.label_of(ds[m], m))
        ax.axvline(0, color="0.7", lw=0.5, zorder=0)
        _zones(ax, ds)
    _finish(figure, axes, len(names))
    unit = canvas.unit_of(ds["time"])
    said = [f"t = {ds['time'].values[i]:.4g} {unit}".rstrip() for i in dict.fromkeys(at)]
    with canvas.style():
        figure.legend(handles, said, loc="outside lower center", ncols=len(said), frameon=False)
    figure.suptitle(title or "median, and range over seeds and cells")
    return figure


def depth_map(ds: xr.Dataset, metrics: Sequence[str] | None = None, title: str = "") -> Any:
    """Axes for each metric: its median over seeds and cells, in colour, over time and depth."""
    names, depth = _names(ds, metrics), _depths(ds)
    t = np.asarray(ds["time"].values, dtype=float)
    figure, axes = canvas.grid(-(-len(names) // 3), min(3, len(names)), 3.6, 2.9, sharey=True)
    for ax, m in zip(axes.flat, names):
        v = _spread(_pooled(ds[m], ds["depth"].values, depth))[1]  # (depth, time)
        shown = ax.pcolormesh(t, depth, v, shading="nearest", cmap=canvas.FIELD_COLOURS, rasterized=True)
        canvas.time_axis(ax, float(t.max()))
        with canvas.style():
            figure.colorbar(shown, ax=ax, label=canvas.label_of(ds[m], m), pad=0.02)
        ax.set_xlabel(with_unit("time", canvas.unit_of(ds["time"])))
        _zones(ax, ds, "white")
    _finish(figure, axes, len(names))
    figure.suptitle(title or "median over seeds and cells")
    return figure


def sizes(
    shown: Mapping[str, xr.Dataset],
    along: str,
    time: float,
    metrics: Sequence[str] | None = None,
    title: str = "",
) -> Any:
    """Axes for each metric: its median at a time against a number of the variants, and its range over seeds and cells.

    shown  label -> metrics (variant, cell, time), also over seeds, with the coordinate ``along`` of the variants
    """
    first = next(iter(shown.values()))
    names = _names(first, metrics)
    figure, axes = canvas.grid(-(-len(names) // 3), min(3, len(names)), 3.0, 2.4)
    i = int(np.abs(first["time"].values - time).argmin())
    width = 0.012 * float(np.ptp(first[along].values))
    for ax, m in zip(axes.flat, names):
        for k, (label, ds) in enumerate(shown.items()):
            v = ds[m].transpose("variant", "time", ...).values
            low, middle, high = _spread(v[:, i].reshape(len(v), -1))
            x = ds[along].values + width * (k - (len(shown) - 1) / 2)
            style = canvas.line_style(k)
            error = np.abs(np.stack([middle - low, high - middle]))
            ax.errorbar(x, middle, error, capsize=2, marker="o", ms=3, elinewidth=0.8, label=label, **style)
        ax.set_ylabel(canvas.label_of(first[m], m))
        ax.set_xlabel(along.removeprefix("variant_"))
    for ax in axes.flat[len(names) :]:
        ax.set_visible(False)
    handles, labels = axes.flat[0].get_legend_handles_labels()
    with canvas.style():
        figure.legend(handles, labels, loc="outside lower center", ncols=len(labels), frameon=False)
    unit = canvas.unit_of(first["time"])
    figure.suptitle(
        title or f"median and range over seeds and cells, t = {first['time'].values[i]:.4g} {unit}".rstrip()
    )
    return figure


def _names(ds: xr.Dataset, metrics: Sequence[str] | None) -> list[str]:
    names = [m for m in (metrics or usual(ds)) if m in ds]
    if not names:
        raise InputError(f"there are no metrics to draw; there is {', '.join(map(str, ds.data_vars))}")
    return names


def _depths(ds: xr.Dataset) -> Floats:
    """Depths that there are, each once, rising."""
    if "depth" not in ds.coords:
        raise InputError("the points of this dataset have no depth")
    return np.unique(np.asarray(ds["depth"].values, dtype=float))


def _pooled(v: xr.DataArray, depths: Floats, unique: Floats) -> Floats:
    """Values (depth, time, all others): points that share a depth, seeds, cells; NaN where there are fewer."""
    a = v.transpose("point", "time", ...).values
    a = a.reshape(*a.shape[:2], -1)
    groups = [np.concatenate(list(a[depths == d]), axis=-1) for d in unique]
    out = np.full((len(unique), a.shape[1], max(g.shape[-1] for g in groups)), np.nan)
    for k, g in enumerate(groups):
        out[k, :, : g.shape[-1]] = g
    return out


def _spread(v: Floats) -> tuple[Floats, Floats, Floats]:
    """Least, median and greatest over the last axis; NaN where there is nothing."""
    bare = np.asarray(np.isnan(v).all(axis=-1))
    full = np.where(bare[..., None], 0.0, v)
    found = np.nanmin(full, axis=-1), np.nanmedian(full, axis=-1), np.nanmax(full, axis=-1)
    low, middle, high = (np.where(bare, np.nan, x) for x in found)
    return low, middle, high


def _zones(ax: Any, ds: xr.Dataset, colour: str = "0.4") -> None:
    """A line between the points of one zone and the next."""
    if "zone" not in ds.coords:
        return
    order = np.argsort(ds["depth"].values, kind="stable")
    depth, zone = ds["depth"].values[order], ds["zone"].values[order]
    for k in np.flatnonzero(zone[1:] != zone[:-1]):
        ax.axhline((depth[k] + depth[k + 1]) / 2, color=colour, lw=0.8, ls=":")
    for name in dict.fromkeys(zone):
        from matplotlib.patheffects import withStroke

        edge = [withStroke(linewidth=1.5, foreground="black" if colour == "white" else "white")]
        where = {"path_effects": edge, "transform": ax.get_yaxis_transform(), "ha": "right", "va": "center"}
        ax.text(0.98, depth[zone == name].mean(), str(name), fontsize=7, color=colour, **where)


def _finish(figure: Any, axes: Any, used: int) -> None:
    for ax in axes.flat[used:]:
        ax.set_visible(False)
    for row in axes:
        row[0].set_ylabel("depth (top 0, bottom 1)")
    axes[0, 0].set_ylim(1, 0)
