"""Volume-weighted quantiles, means and extremes of any plot variable over any part."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from febkit import units
from febkit.model import InputError
from febkit.results.mesh import local_mean

from . import groups as grouping
from . import tensors
from .selection import _named, part_rows

if TYPE_CHECKING:
    import xarray as xr

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# scalars of a symmetric tensor (6, e) or vector (3, e), by the word after the colon in "stress:effective"
TENSOR: dict[str, Callable[[Floats], Floats]] = {
    "effective": tensors.effective,
    "max_difference": tensors.max_difference,
    "first": lambda s: np.asarray(tensors.principal(s)[0]),
    "second": lambda s: np.asarray(tensors.principal(s)[1]),
    "third": lambda s: np.asarray(tensors.principal(s)[2]),
    "mean": lambda s: np.asarray((s[0] + s[1] + s[2]) / 3),
}
QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95)


def weighted_quantiles(values: Floats, weights: Floats, q: Sequence[float] | Floats) -> Floats:
    """Quantiles of values (e,) with weights (e,): the inverse of the weighted distribution, each element at
    the middle of its weight, linear in between."""
    order = np.argsort(values)
    w = weights[order]
    at = (np.cumsum(w) - 0.5 * w) / w.sum()
    return np.asarray(np.interp(q, at, values[order]))


def summarize(
    ds: xr.Dataset, variable: str, parts: Sequence[str] | None = None, quantiles: Sequence[float] = QUANTILES
) -> xr.Dataset:
    """Deformed-volume-weighted mean, quantiles and extremes (part, time) of a plot variable.

    variable   name in the dataset; "name:component" for one component of a vector or tensor, or
               "name:magnitude", and for symmetric tensors "name:effective", ":first" ... (:data:`TENSOR`)
    parts      parts or element sets; all parts by default

    Element values come from element data as they are, from nodal data as the mean over the element's
    nodes, from element-node data likewise. Units are those of the variable, but kPa for stresses and pressures.
    """
    found = summary(ds, variable, parts, quantiles)
    unit = str(found["mean"].attrs.get("units", ""))
    if units.measures(unit, "kPa"):
        scale = units.factor(unit, "kPa")
        for key, v in found.data_vars.items():
            found[key] = (v * scale).assign_attrs(v.attrs | {"units": "kPa"})
    return found


def summary(
    ds: xr.Dataset, variable: str, parts: Sequence[str] | None = None, quantiles: Sequence[float] | Floats = QUANTILES
) -> xr.Dataset:
    """What :func:`summarize` gives, stresses too in the units of the variable."""
    import xarray as xr

    name, _, word = variable.partition(":")
    if name not in ds:
        raise InputError(f"the result has no {name!r}; it has {', '.join(map(str, ds.data_vars))}")
    known = _named(ds)
    chosen = list(parts) if parts is not None else list(known) or [""]
    n, q = ds.sizes["time"], np.asarray(quantiles, dtype=float)
    mean, least, greatest = np.full((3, len(chosen), n), np.nan)
    quant = np.full((len(chosen), n, len(q)), np.nan)
    for i, part in enumerate(chosen):
        rows = part_rows(ds, part) if part else np.arange(ds.sizes["element"])
        volume = _volumes(ds, rows)
        for t in range(n):
            v = _scalar(ds, name, word, t, rows)
            ok = np.isfinite(v)
            if not ok.any():
                continue
            v, w = v[ok], volume[t][ok]
            mean[i, t], least[i, t], greatest[i, t] = (v * w).sum() / w.sum(), v.min(), v.max()
            quant[i, t] = weighted_quantiles(v, w, q)
    dims = ("part", "time")
    attrs = {"variable": variable} | {k: ds[name].attrs[k] for k in ("units",) if k in ds[name].attrs}
    return xr.Dataset(
        {
            "mean": (dims, mean, attrs),
            "least": (dims, least, attrs),
            "greatest": (dims, greatest, attrs),
            "quantiles": ((*dims, "quantile"), quant, attrs),
        },
        coords={"part": chosen, "time": ds["time"].variable, "quantile": q},
        attrs={"weights": "deformed volume"} | {k: ds.attrs[k] for k in ("unit_system",) if k in ds.attrs},
    )


def mean(ds: xr.Dataset, variable: str, part: str | None = None) -> xr.DataArray:
    """(time[, component]) deformed-volume-weighted mean of a variable, or of a component or scalar of it ("name:word"),
    over a part or element set, all elements by default; elements without a value do not count."""
    import xarray as xr

    name, _, word = variable.partition(":")
    rows = part_rows(ds, part) if part else np.arange(ds.sizes["element"])
    volume, v, out = _volumes(ds, rows), ds[name], []
    for t in range(ds.sizes["time"]):
        state = v.isel(time=t) if "time" in v.dims else v
        a = _by_element(ds, state, rows)
        a = scalar_of(name, word, state, a) if word else a
        w = volume[t].reshape(-1, *[1] * (a.ndim - 1)) * np.isfinite(a)
        with np.errstate(invalid="ignore"):
            out.append((np.where(w > 0, a, 0.0) * w).sum(axis=0) / w.sum(axis=0))
    rest = () if word else tuple(d for d in v.dims if d not in ("time", "node", "element", "local"))
    coords = {"time": ds["time"]} | {d: ds[d] for d in rest if d in ds.coords}
    attrs = {k: v.attrs[k] for k in ("units", "long_name") if k in v.attrs}
    return xr.DataArray(np.array(out), dims=("time", *rest), coords=coords, name=name, attrs=attrs)


def _volumes(ds: xr.Dataset, rows: Ints) -> Floats:
    """(time, e) deformed volumes of solid elements."""
    groups = grouping.make(ds, rows, np.zeros(len(rows), dtype=np.int64))
    out = np.empty((ds.sizes["time"], len(rows)))
    order = np.argsort(rows)
    for t in range(ds.sizes["time"]):
        u = (
            np.asarray(ds["displacement"][t].values, dtype=float)
            if "displacement" in ds
            else np.zeros(ds["X"].shape)
        )
        for g in groups:
            out[t, order[np.searchsorted(rows[order], g.rows)]] = g.at(u).volume
    return out


def _scalar(ds: xr.Dataset, name: str, word: str, t: int, rows: Ints) -> Floats:
    """(e,) one number per element."""
    v = ds[name].isel(time=t) if "time" in ds[name].dims else ds[name]
    return scalar_of(name, word, v, _by_element(ds, v, rows))


def _by_element(ds: xr.Dataset, v: xr.DataArray, rows: Ints) -> Floats:
    """(e[, component]) values of a state by element: nodal ones by their mean."""
    a = np.asarray(v.values, dtype=float)
    if "element" in v.dims:
        a = a[rows]
        if "local" in v.dims:
            a = local_mean(a, v.dims.index("local"))
    elif "node" in v.dims:
        conn = np.asarray(ds["connectivity"].values)[rows]
        inside = (conn >= 0).reshape(*conn.shape, *([1] * (a.ndim - 1)))
        a = np.where(inside, a[conn], 0).sum(axis=1) / inside.sum(axis=1)
    else:
        raise InputError(f"{v.name} lives on neither nodes nor elements")
    return a


def scalar_of(name: str, word: str, v: xr.DataArray, a: Floats) -> Floats:
    """(e,) of values (e[, component]) of ``v``: the component or scalar that ``word`` names."""
    if a.ndim == 1:
        return a
    return _component(name, word, str(v.dims[-1]), a.T, [str(c) for c in v[v.dims[-1]].values])


def _component(name: str, word: str, dim: str, a: Floats, labels: list[str]) -> Floats:
    if word in labels:
        return np.asarray(a[labels.index(word)])
    if word == "magnitude" and dim != "voigt":
        return np.asarray(np.sqrt((a**2).sum(axis=0)))
    if dim == "voigt" and word in TENSOR:
        return np.asarray(TENSOR[word](a))
    choices = [*labels, *(TENSOR if dim == "voigt" else ["magnitude"])]
    rest = ", ".join(choices[1:])
    raise InputError(f'say which component of {name}: "{name}:{choices[0]}", or one of {rest}')
