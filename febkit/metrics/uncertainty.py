"""What the estimated error of a hand-off makes of the metrics of the cells that it drives.

    <metric>_uncertainty = S e,    S = max_t |metric| / max_t strain,    e = sqrt(e_strain^2 + d^2),
    dd/dt = (a e_grad_p / H - d) / tau,    tau = a^2 / (H k)

e_strain is the estimated error of the strain handed over. That of the pressure's gradient strains the solid by
a e_grad_p / H across half the box's edge a once fluid has moved, which takes the time tau; H and k are the tissue's
aggregate modulus and permeability, by its own balances. S, one number for each cell and metric, is how a metric answers
to the strain handed over: a secant over the history of this very result.

Of the mass exchange, a rate, it is rho V S_V (e_strain / (t + tau) + d / tau): a strain that came about in the time t,
and one that does in tau; S_V is that of the volumetric strain.

An estimate, and no bound: of the error of the hand-off alone, not of the cell model's own mesh, nor of what soft cells
do to the tissue around them. docs/handoff.md compares it with true errors.
"""

from __future__ import annotations

from dataclasses import dataclass
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
FORMULA = "max |metric| / max strain handed over * sqrt(e_strain^2 + d^2), see febkit.metrics.uncertainty"
OF_RATES = "rho V max |volumetric strain| / max strain handed over * (e_strain / (t + tau) + d / tau)"


@dataclass(frozen=True, slots=True, eq=False)
class Strains:
    """Errors of the strain over ``times`` (t,): ``surface``, handed over, and ``drag``, by the pressure's gradient.

    ``delay`` is the time in which fluid moves across the box, ``scale`` the largest strain handed over, ``lacking``
    what is not known.
    """

    times: Floats
    surface: Floats
    drag: Floats
    delay: float
    scale: float
    lacking: str = ""

    @classmethod
    def of(cls, found: xr.Dataset) -> Strains:
        """Of an estimate (febkit.coupling.estimate)."""
        t, e = (np.asarray(found[n].values, dtype=float) for n in ("time", "strain_error"))
        scale = float(found["strain_scale"].max())
        H, k = (float(found[n]) if n in found else np.nan for n in ("modulus", "permeability"))
        if "grad_p_error" not in found or not (H > 0 and k > 0):
            return cls(t, e, np.zeros_like(e), 0.0, scale, "the error of the pressure, which is not known")
        half = 0.5 * float(np.ptp(found["box"].values, axis=0).max())
        push, delay = half / H * found["grad_p_error"].values, half**2 / (H * k)
        drag = np.zeros_like(e)
        for n in range(1, len(t)):
            left = np.exp(-(t[n] - t[n - 1]) / delay)
            drag[n] = left * drag[n - 1] + (1.0 - left) * push[n]
        return cls(t, e, drag, delay, scale)

    def at(self, times: Floats) -> tuple[Floats, Floats]:
        """``surface`` and ``drag`` at other times; nan before and after those of the estimate."""
        return (np.interp(times, self.times, self.surface, left=np.nan, right=np.nan),
                np.interp(times, self.times, self.drag, left=np.nan, right=np.nan))


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
    strains = Strains.of(opened(error))
    times = np.asarray(data["time"].values, dtype=float)
    surface, drag = strains.at(times)
    for name in (n for n in BY_STRAIN if n in data and strains.scale > 0):
        _put(data, name, _answer(data, name, strains)[:, None] * np.hypot(surface, drag), FORMULA)
    if "volumetric_strain_uncertainty" in data:
        with np.errstate(divide="ignore", invalid="ignore"):
            rate = surface / (times + strains.delay) + (drag / strains.delay if strains.delay else 0.0)
        moved = density * data["volume"].values[:, :1] * _answer(data, "volumetric_strain", strains)[:, None]
        for name in (n for n in RATES if n in data):
            _put(data, name, moved * np.where(np.isfinite(rate), rate, np.nan), OF_RATES)
    unknown = [str(n) for n in data if data[n].dims[:2] == ("cell", "time") and f"{n}_uncertainty" not in data
               and not str(n).endswith("_uncertainty")]  # fmt: skip
    said = ["estimated from the error of the hand-off alone, no bound; not of the cell model's own mesh"]
    said += [f"without {strains.lacking}"] if strains.lacking else []
    said += [f"not known of {', '.join(unknown)}"] if unknown else []
    return data.assign_attrs(uncertainty="; ".join(said))


def _answer(data: xr.Dataset, name: str, strains: Strains) -> Floats:
    """Largest value of a metric over times by the largest strain handed over (cell,)."""
    values = np.abs(data[name].values)
    return np.asarray(values.max(axis=1, initial=0.0, where=np.isfinite(values)) / strains.scale)


def _put(data: xr.Dataset, name: str, values: Floats, formula: str) -> None:
    long_name = data[name].attrs.get("long_name", name)
    about = {"long_name": f"uncertainty of {long_name} by the hand-off", "formula": formula}
    data[f"{name}_uncertainty"] = (("cell", "time"), values,
                                   about | {k: v for k, v in data[name].attrs.items() if k == "units"})
