"""What the estimated error of a hand-off makes of the metrics of the cells that it drives.

    e(t) = sqrt(e_strain^2 + (a e_grad_p / H)^2),    <metric>_uncertainty = S e,    S = max_t |metric| / max_t strain

e_strain is the estimated error of the strain handed over; e_grad_p that of the pressure's gradient, which strains the
solid by a e_grad_p / H across half the box's edge a, H the tissue's aggregate modulus. S, one number for each cell and
metric, is how a metric answers to the strain handed over: a secant over the history of this very result. Of the mass
exchange, a rate, the uncertainty is rho V S_V e / t: a strain error that came about in the time t, S_V that of the
volumetric strain.

An estimate, and no bound: of the error of the hand-off alone, not of the cell model's own mesh, nor of its being softer
than the tissue it stands in. docs/handoff.md compares it with true errors.
"""

from __future__ import annotations

from os import PathLike
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from febkit.model import InputError

if TYPE_CHECKING:
    import xarray as xr

Floats = NDArray[np.float64]

BY_STRAIN = ("aspect_ratio_change", "volumetric_strain", "effective_strain", "effective_stress", "max_shear_strain",
             "axes_ratio_change")  # fmt: skip
RATES = ("mass_exchange_rate", "volume_loss_rate")
FORMULA = "max |metric| / max strain handed over * sqrt(strain_error^2 + (a grad_p_error / modulus)^2)"
OF_RATES = "rho V max |volumetric strain| / max strain handed over * the same / t"


def opened(error: xr.Dataset | str | PathLike[str]) -> xr.Dataset:
    """The estimate of a hand-off's error over time. Raises InputError where it is none."""
    if isinstance(error, (str, PathLike)):
        from febkit.results import netcdf

        with netcdf.opened(error) as ds:
            error = ds.load()
    if "strain_error" not in error or error["strain_error"].dims != ("time",):
        raise InputError("the error of a hand-off must be what febkit.coupling.estimate gives: strain_error over time")
    return error


def add(data: xr.Dataset, error: xr.Dataset | str | PathLike[str], density: float) -> xr.Dataset:
    """Metrics with ``<metric>_uncertainty`` (cell, time); ``density`` in units of mass exchange times time per volume.

    ``attrs["uncertainty"]`` says what it is, and of which metrics it is not known. Times before and after those of the
    estimate have nan.
    """
    found = opened(error)
    times = np.asarray(data["time"].values, dtype=float)
    e, lacking = strain_error(found)
    at = np.interp(times, found["time"].values, e, left=np.nan, right=np.nan)
    top = float(found["strain_scale"].max())
    for name in BY_STRAIN:
        if name in data and top > 0:
            largest = np.abs(data[name].values).max(axis=1, initial=0.0, where=np.isfinite(data[name].values))
            _put(data, name, (largest / top)[:, None] * at, FORMULA)
    if "volumetric_strain_uncertainty" in data:
        moved = density * data["volume"].values[:, :1] * data["volumetric_strain_uncertainty"].values
        with np.errstate(divide="ignore", invalid="ignore"):
            rate = np.where(times > 0, moved / times, np.nan)
        for name in RATES:
            if name in data:
                _put(data, name, rate, OF_RATES)
    unknown = [str(n) for n in data if data[n].dims[:2] == ("cell", "time") and f"{n}_uncertainty" not in data
               and not str(n).endswith("_uncertainty")]  # fmt: skip
    said = ["estimated from the error of the hand-off alone, no bound; not of the cell model's own mesh"]
    said += [f"without {lacking}"] if lacking else []
    said += [f"not known of {', '.join(unknown)}"] if unknown else []
    return data.assign_attrs(uncertainty="; ".join(said))


def strain_error(found: xr.Dataset) -> tuple[Floats, str]:
    """e (t,) of an estimate, and what it lacks, in words."""
    e = found["strain_error"].values
    if "grad_p_error" not in found or not np.isfinite(float(found.get("modulus", np.nan))):
        return e, "the error of the pressure, which is not known"
    half = 0.5 * float(np.ptp(found["box"].values, axis=0).max())
    return np.hypot(e, half * found["grad_p_error"].values / float(found["modulus"])), ""


def _put(data: xr.Dataset, name: str, values: Floats, formula: str) -> None:
    long_name = data[name].attrs.get("long_name", name)
    about = {"long_name": f"uncertainty of {long_name} by the hand-off", "formula": formula}
    data[f"{name}_uncertainty"] = (("cell", "time"), values,
                                   about | {k: v for k, v in data[name].attrs.items() if k == "units"})
