"""Which parameter makes how much of an observable's variance: Sobol indices, by SALib."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from febkit.model import InputError

if TYPE_CHECKING:
    import xarray as xr

Floats = NDArray[np.float64]


def _problem(names: list[str]) -> dict[str, Any]:
    return {"num_vars": len(names), "names": names, "bounds": [[0.0, 1.0]] * len(names)}


def _salib(name: str) -> Any:
    from importlib import import_module

    try:
        return import_module(f"SALib.{name}.sobol")
    except ImportError:
        raise InputError('Sobol indices need SALib: pip install "febkit[sensitivity]"') from None


def saltelli(k: int, samples: int, seed: int) -> Floats:
    """Points (samples (k + 2), k) of the unit cube. Saltelli et al, Comput Phys Commun 181 (2010)."""
    with warnings.catch_warnings():  # of numbers that are no power of two
        warnings.simplefilter("ignore", UserWarning)
        problem = _problem([str(i) for i in range(k)])
        made = _salib("sample").sample(problem, samples, calc_second_order=False, seed=seed)
    return np.asarray(made)


def indices(ds: xr.Dataset, parameters: list[str], seed: int) -> xr.Dataset:
    """Sobol indices of each observable of a swept dataset, over time, and half-widths of their 95 % intervals.

    <name> (index, parameter[, time]), index "first" (the parameter alone) and "total" (with all that it does together
    with others), and <name> confidence likewise; NaN where the observable does not vary.
    """
    import xarray as xr

    analyse, out = _salib("analyze").analyze, dict[str, Any]()
    for name, v in ds.data_vars.items():
        rows = v.values.reshape(len(v), -1)
        if not np.isfinite(rows).all():
            raise InputError(f"{name}: samples failed, and indices need all of them")
        found = np.full((2, 2, len(parameters), rows.shape[1]), np.nan)
        for t in np.flatnonzero(np.ptp(rows, axis=0) > 0):
            s = analyse(_problem(parameters), rows[:, t], calc_second_order=False, seed=seed)
            found[:, :, :, t] = [[s["S1"], s["ST"]], [s["S1_conf"], s["ST_conf"]]]
        dims = ("index", "parameter", *v.dims[1:])
        shape = (2, len(parameters), *v.shape[1:])
        out |= {f"{name}{more}": (dims, a.reshape(shape)) for more, a in zip(("", " confidence"), found)}
    coords: dict[str, Any] = {"index": ["first", "total"], "parameter": parameters}
    return xr.Dataset(out, coords | ({"time": ds["time"]} if "time" in ds.dims else {}))
