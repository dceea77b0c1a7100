"""What a study of many depths, or of several sizes of the cells' model, found: maps and tables of its dataset."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from febkit.metrics.cells import METRICS
from febkit.metrics.tables import Table, heading, short

from .plan import CONTROL, Place, Plan

if TYPE_CHECKING:
    import xarray as xr

DEPTHS = 3  # depths from which on there is something to draw over


def deep(ds: xr.Dataset) -> bool:
    """Do the points of a gathered dataset lie at several depths?"""
    return "depth" in ds.coords and len(np.unique(ds["depth"].values)) >= DEPTHS


def parts(ds: xr.Dataset) -> Iterator[tuple[str, str, xr.Dataset]]:
    """(case, hand-off, their metrics), those that hold something."""
    for case in ds["case"].values:
        for method in ds["handoff"].values:
            own = ds.sel(case=case, handoff=method)
            if bool(np.isfinite(own[_six(ds)[0]]).any()):
                yield str(case), str(method), own


def _six(ds: xr.Dataset) -> list[str]:
    return [m for m in METRICS if m in ds]


def moments(ds: xr.Dataset, ramp: float | None) -> list[float]:
    """Times to show: the ramp's end (or the first after the start), one between, the last."""
    t = np.asarray(ds["time"].values, dtype=float)
    first = float(t[np.abs(t - ramp).argmin()]) if ramp is not None else float(t[min(1, len(t) - 1)])
    between = t[(t > first) & (t < t[-1])]
    middle = (
        [float(between[np.abs(np.log(between / np.sqrt(max(first, 1e-30) * t[-1]))).argmin()])]
        if len(between)
        else []
    )
    return list(dict.fromkeys([first, *middle, float(t[-1])]))


def depth_figures(ds: xr.Dataset, ramp: float | None, folder: Path) -> Iterator[Path]:
    """Profiles over depth and maps over time and depth, of each case and hand-off."""
    from febkit import plots

    if not deep(ds):
        return
    for case, method, own in parts(ds):
        if method == CONTROL:
            continue
        for v in range(own.sizes.get("variant", 1)):
            one, suffix = (own.isel(variant=v), f"_{v + 1}") if "variant" in own.dims else (own, "")
            one, name = one.load(), f"{case}_{method.replace('/', '-').replace(' ', '_')}{suffix}.png"
            title = f"{case}, {method if not method[0].isdigit() else f'order {method}'}"
            title += f", {one['variant'].item()}" if suffix else ""
            path = folder / f"depth_profiles_{name}"
            plots.save(
                plots.profiles(
                    one, moments(ds, ramp), _six(ds), f"{title}: median, range over seeds and cells"
                ),
                path,
            )
            yield path
            path = folder / f"depth_map_{name}"
            plots.save(plots.depth_map(one, _six(ds), f"{title}: median over seeds and cells"), path)
            yield path


def depth_table(ds: xr.Dataset) -> Iterator[Table]:
    """Median [least, greatest] over seeds and cells at the last time, a row for each point."""
    if not deep(ds):
        return
    for case, method, own in parts(ds):
        if method == CONTROL:
            continue
        rows: list[list[object]] = []
        for k in np.argsort(own["depth"].values, kind="stable")[:200]:
            one = own.isel(point=int(k), time=-1)
            where = ", ".join(f"{float(x):.4g}" for x in one["position"].values)
            row: list[object] = [f"{float(one['depth']):.3f}", where]
            row += [str(one["zone"].item())] if "zone" in one.coords else []
            rows.append([*row, *(_said(one[m].values) for m in _six(ds))])
        head = ["depth", "x, y, z", *(["zone"] if "zone" in own.coords else [])]
        t = float(own["time"][-1])
        title = f"{case} {method}: over depth at t = {t:.4g}, median [least, greatest] over seeds and cells"
        yield Table(title, [*head, *(heading(m, _unit(own, m)) for m in _six(ds))], rows)


def _unit(ds: xr.Dataset, m: str) -> str:
    return str(ds[m].attrs.get("units", ""))


def _said(v: Any) -> str:
    v = np.asarray(v, dtype=float)
    v = v[np.isfinite(v)]
    return f"{np.median(v):.3g} [{v.min():.3g}, {v.max():.3g}]" if len(v) else "-"


# ---- variants: the size of the cells' model --------------------------------------------------------


def size_tables(
    plan: Plan, ds: xr.Dataset, agreed: Mapping[Place, xr.Dataset], ramp: float | None
) -> Iterator[Table]:
    """A row for each variant: metrics at the ramp's end and the last time, the error to the control."""
    if "variant" not in ds.dims:
        return
    for case, method, own in parts(ds):
        for t in (moments(ds, ramp)[0], float(ds["time"][-1])):
            at = own.sel(time=t, method="nearest")
            rows = [
                [v.name, *_size(at[_six(ds)[0]].isel(variant=k), plan.study.cells(0, k).get("edge"))]
                + [_said(at[m].isel(variant=k).values) for m in _six(ds)]
                for k, v in enumerate(plan.study.variants)
            ]
            title = f"{case} {method}: variants at t = {t:.4g}, median [least, greatest] over points, seeds and cells"
            yield Table(
                title, ["", "cells", "per volume", *(heading(m, _unit(own, m)) for m in _six(ds))], rows
            )
    if agreed:
        rows = []
        for case, method in dict.fromkeys((p.case, p.method) for p in agreed):
            for k, v in enumerate(plan.study.variants):
                mine = [a for p, a in agreed.items() if (p.case, p.method, p.variant) == (case, method, k)]
                if mine:
                    errors = [
                        np.mean([float(a["nrms"].sel(metric=m)) for a in mine if m in a["metric"]])
                        for m in _six(ds)
                    ]
                    rows.append([f"{case} {method}", v.name, *(f"{e:.3f}" for e in errors)])
        title = "Variants: RMS difference to the control over the control's range, mean over seeds"
        yield Table(title, ["", "variant", *(short(m) for m in _six(ds))], rows)


def _size(at: xr.DataArray, edge: object) -> tuple[str, str]:
    """Number of cells that were measured, over points and seeds, and how many in a unit of volume."""
    there = np.isfinite(at.transpose("cell", ...).values).sum(axis=0).ravel()
    found = sorted({int(n) for n in there if n})
    ends = [found[0], found[-1]] if len(found) > 1 else found
    volume = float(edge) ** 3 if isinstance(edge, int | float) else 0.0
    return " to ".join(map(str, ends)), " to ".join(f"{n / volume:.4g}" for n in ends) if volume else ""


def size_figures(plan: Plan, ds: xr.Dataset, ramp: float | None, folder: Path) -> Iterator[Path]:
    """Metrics against the first number that tells the variants apart, hand-offs beside the control."""
    from febkit import plots

    along = next((str(c) for c in ds.coords if str(c).startswith("variant_")), None)
    if "variant" not in ds.dims or along is None:
        return
    for case in plan.study.cases:
        shown = {
            m if not m[0].isdigit() else f"order {m}": own.load() for c, m, own in parts(ds) if c == case
        }
        for word, t in (("ramp", moments(ds, ramp)[0]), ("end", float(ds["time"][-1]))):
            if shown:
                path = folder / f"variants_{case}_{word}.png"
                title = f"{case}, t = {t:.4g}: median, range over points, seeds and cells"
                plots.save(plots.sizes(shown, along, t, _six(ds), title), path)
                yield path
