"""How well a model agrees with its control: eq 20, Bland-Altman, ranks and Fisher's z.

Every function takes datasets (cell, time) of :func:`febkit.metrics.cell_metrics`, control first.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from febkit import units
from febkit.model import InputError
from febkit.results.subsets import state_at

from . import osmotic
from .cells import METRICS
from .ranks import spearman

if TYPE_CHECKING:
    import xarray as xr

Floats = NDArray[np.float64]
KEYS = ("rms", "range", "nrms", "bias", "lower", "upper", "outside", "n")
FISHER = 6  # values from which on Fisher's z is of use
MOMENTS = ("instantaneous", "steady", "peak")


def align(control: xr.Dataset, test: xr.Dataset, rtol: float = 1e-4) -> tuple[xr.Dataset, xr.Dataset]:
    """Both datasets at the cells and the times they share (times within ``rtol``: plotfiles hold float32).

    The test's values come in the control's units; metrics of each solute stand for themselves.
    Raises InputError where only one of the two names its units.
    """
    control, test = osmotic.split(control), osmotic.split(in_units_of(control, test))
    shared = [c for c in control["cell"].values if c in set(test["cell"].values)]
    if not shared:
        raise InputError("the two results share no cell name")
    a, b = control.sel(cell=shared), test.sel(cell=shared)
    ta, tb = np.asarray(a["time"].values, float), np.asarray(b["time"].values, float)
    near = np.abs(ta[:, None] - tb[None]).argmin(axis=1)
    keep = np.abs(ta - tb[near]) <= rtol * np.maximum(np.abs(ta), 1e-3)
    if not keep.any():
        raise InputError("the two results share no time")
    a, b = a.isel(time=np.flatnonzero(keep)), b.isel(time=near[keep])
    return a, b.assign_coords(time=a["time"].values)


def in_units_of(control: xr.Dataset, test: xr.Dataset) -> xr.Dataset:
    """The metrics of ``test`` in the units of those of ``control``."""
    out = test
    for name in [n for n in test.data_vars if n in control]:
        a, b = (str(ds[name].attrs.get("units", "")) for ds in (control, test))
        if a == b:
            continue
        if not a or not b:
            known, plain = ("control", "test") if a else ("test", "control")
            raise InputError(
                f"{name} of the {known} is in {a or b}, that of the {plain} in units that nobody named: say which "
                "with --units, or units= of febkit.open_results"
            )
        scaled = (test[name] * units.factor(b, a)).assign_attrs(test[name].attrs | {"units": a})
        out = out.assign({name: scaled})
    return out


def _moved(a: xr.Dataset, b: xr.Dataset) -> tuple[xr.Dataset, xr.Dataset]:
    """Both without t = 0, the reference state, where two models cannot differ."""
    later = np.asarray(a["time"].values, dtype=float) > 0
    return (a.isel(time=later), b.isel(time=later)) if later.any() else (a, b)


def usual(ds: xr.Dataset) -> list[str]:
    """What is compared where nothing is named: the study's six, and what cells of a mixture hold, solute by solute."""
    return [m for m in (*METRICS, *osmotic.names(ds)) if m in ds]


def _metrics(a: xr.Dataset, b: xr.Dataset, metrics: Sequence[str] | None) -> list[str]:
    names = [m for m in (metrics or usual(a)) if m in a and m in b]
    if not names:
        raise InputError("the two results share no metric")
    return names


def _differences(a: xr.DataArray, b: xr.DataArray) -> Floats:
    return np.asarray(b.values - a.values, dtype=float)


def compare(control: xr.Dataset, test: xr.Dataset, metrics: Sequence[str] | None = None) -> xr.Dataset:
    """RMS difference over all cells and times (eq 20), over the control's range, and limits of agreement.

    Result (metric): rms, range = max - min of the control, nrms = rms/range, bias, lower, upper = bias -+
    1.96 s of the differences (test - control), outside = values outside the limits, n = values compared.
    The reference state, t = 0, does not count: 11 cells at the study's 29 later times are n = 319.
    """
    import xarray as xr

    a, b = _moved(*align(control, test))
    names = _metrics(a, b, metrics)
    rows: dict[str, list[float]] = {k: [] for k in KEYS}
    for m in names:
        d, c = _differences(a[m], b[m]), a[m].values
        rms, span = float(np.sqrt(np.nanmean(d**2))), float(np.nanmax(c) - np.nanmin(c))
        bias, s = float(np.nanmean(d)), float(np.nanstd(d, ddof=1)) if d.size > 1 else 0.0
        lower, upper = bias - 1.96 * s, bias + 1.96 * s
        count = int(np.isfinite(d).sum())
        outside = int(np.sum((d < lower) | (d > upper)))
        values = (rms, span, rms / span if span else np.nan, bias, lower, upper, outside, count)
        for key, value in zip(rows, values):
            rows[key].append(value)
    ds = xr.Dataset({k: ("metric", v) for k, v in rows.items()}, coords={"metric": names})
    ds["outside"], ds["n"] = ds["outside"].astype(int), ds["n"].astype(int)
    ds = ds.assign_coords(units=("metric", [a[m].attrs.get("units", "") for m in names]))
    ds.attrs["formula"] = "rms = sqrt(mean (test - control)^2) over cells and times (eq 20)"
    return ds


def bland_altman(control: xr.Dataset, test: xr.Dataset, metrics: Sequence[str] | None = None) -> xr.Dataset:
    """Per metric, cell and time: mean and difference (test - control), and whether it lies outside the
    95 % limits of agreement (bias -+ 1.96 s over all cells and times but t = 0). Result (metric, cell, time)."""
    import xarray as xr

    a, b = _moved(*align(control, test))
    names = _metrics(a, b, metrics)
    total = compare(a, b, names)
    d = np.stack([_differences(a[m], b[m]) for m in names])
    mean = np.stack([(a[m].values + b[m].values) / 2 for m in names])
    lower, upper = total["lower"].values[:, None, None], total["upper"].values[:, None, None]
    dims = ("metric", "cell", "time")
    return xr.Dataset(
        {
            "difference": (dims, d),
            "mean": (dims, mean),
            "outside": (dims, (d < lower) | (d > upper)),
            "bias": total["bias"],
            "lower": total["lower"],
            "upper": total["upper"],
        },
        coords={"metric": names, "cell": a["cell"].values, "time": a["time"].values},
    )


def at_moments(
    ds: xr.Dataset, instantaneous: float | None = None, metrics: Sequence[str] | None = None
) -> xr.Dataset:
    """Values (moment, cell) at "instantaneous" (0.1 s in the study), "steady" (the last time) and "peak"
    (the value of largest magnitude over time, with its sign)."""
    import xarray as xr

    t = np.asarray(ds["time"].values, dtype=float)
    first = 0.1 if instantaneous is None else instantaneous
    at = state_at(t, first, 1e-3, 1e-12)
    out = {}
    ds = osmotic.split(ds)
    for m in [m for m in (metrics or usual(ds)) if m in ds]:
        v = ds[m].transpose("cell", "time").values
        peak = v[np.arange(len(v)), np.nan_to_num(np.abs(v)).argmax(axis=1)]
        out[m] = (("moment", "cell"), np.stack([v[:, at], v[:, int(t.argmax())], peak]), ds[m].attrs)
    return xr.Dataset(out, coords={"moment": list(MOMENTS), "cell": ds["cell"].values})


def spread(
    ds: xr.Dataset, instantaneous: float | None = None, metrics: Sequence[str] | None = None
) -> xr.Dataset:
    """Median, least and greatest over the cells (metric, moment) at the study's three moments."""
    import xarray as xr

    v = at_moments(ds, instantaneous, metrics)
    names = [str(m) for m in v.data_vars]
    stack = np.stack([v[m].values for m in names])
    dims = ("metric", "moment")
    return xr.Dataset(
        {
            "median": (dims, np.median(stack, axis=2)),
            "least": (dims, stack.min(axis=2)),
            "greatest": (dims, stack.max(axis=2)),
        },
        coords={
            "metric": names,
            "moment": v["moment"].values,
            "units": ("metric", [v[m].attrs.get("units", "") for m in names]),
        },
    )


def rank_correlation(
    control: xr.Dataset,
    test: xr.Dataset,
    instantaneous: float | None = None,
    metrics: Sequence[str] | None = None,
) -> xr.Dataset:
    """Spearman's rho and its p (:func:`.ranks.spearman`) between control and test over the cells (metric, moment).

    NaN where one of the two does not vary between cells, or there are fewer than three of them.
    """
    import xarray as xr

    a, b = align(control, test)
    names = _metrics(a, b, metrics)
    va, vb = at_moments(a, instantaneous, names), at_moments(b, instantaneous, names)
    rho, p = np.full((2, len(names), len(MOMENTS)), np.nan)
    for i, m in enumerate(names):
        for j in range(len(MOMENTS)):
            rho[i, j], p[i, j] = spearman(va[m].values[j], vb[m].values[j])
    dims = ("metric", "moment")
    coords = {"metric": names, "moment": list(MOMENTS), "n": len(a["cell"])}
    return xr.Dataset({"rho": (dims, rho), "p": (dims, p)}, coords=coords)


def fisher_z(r1: Floats, r2: Floats, n1: int, n2: int) -> tuple[Floats, Floats]:
    """Fisher's z = (atanh r1 - atanh r2)/sqrt(1/(n1 - 3) + 1/(n2 - 3)) and its two-sided p-value.

    Source: Fisher, "On the probable error of a coefficient of correlation", Metron 1 (1921). NaN from fewer than six
    values, where z is far from normal (ranks of five: beyond its 5 % limit by chance in up to 24 % of cases). A rank
    correlation of +-1 has no finite transform: it counts as the next one below, 1 - 12 / (n^3 - n).
    """
    from scipy.stats import norm

    if min(n1, n2) < FISHER:
        return np.full(np.shape(r1), np.nan), np.full(np.shape(r1), np.nan)
    t1, t2 = (np.arctanh(np.clip(r, -_next(n), _next(n))) for r, n in ((r1, n1), (r2, n2)))
    z = np.where(np.equal(r1, r2), 0.0, (t1 - t2) / np.sqrt(1 / (n1 - 3) + 1 / (n2 - 3)))
    return z, 2 * norm.sf(np.abs(z))


def _next(n: int) -> float:
    """The largest rank correlation of n values below 1: two neighbours swapped."""
    return 1.0 - 12.0 / (n**3 - n)


def compare_orders(
    control: xr.Dataset, first: xr.Dataset, second: xr.Dataset, instantaneous: float | None = None
) -> xr.Dataset:
    """Rank correlations of two methods with one control, and Fisher's z between them (metric, moment)."""
    a, b = rank_correlation(control, first, instantaneous), rank_correlation(control, second, instantaneous)
    shared = [m for m in a["metric"].values if m in set(b["metric"].values)]
    a, b = a.sel(metric=shared), b.sel(metric=shared)
    z, p = fisher_z(a["rho"].values, b["rho"].values, int(a["n"]), int(b["n"]))
    out = a[["rho"]].rename(rho="rho_first").assign(rho_second=b["rho"])
    return out.assign(z=(a["rho"].dims, z), p=(a["rho"].dims, p))
