"""The results of a sweep as one dataset."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from febkit.model import InputError

from .design import Range
from .runs import NOT_RUN, Found

if TYPE_CHECKING:
    import xarray as xr

Floats = NDArray[np.float64]


class Swept:
    """What :func:`febkit.sweep` gives back.

    dataset: each observable (sample, time); coordinates over the samples: the parameters, ``reason`` why one failed, ""
    where it did not, ``seconds`` and ``iterations``. Where times differ between samples (sample, state), with their
    ``time``.
    """

    def __init__(self, dataset: xr.Dataset, parameters: Sequence[str], design: str, seed: int) -> None:
        self.dataset, self.parameters = dataset, list(parameters)
        self.design, self.seed = design, seed

    @property
    def failed(self) -> dict[int, str]:
        """Why samples failed, by their number."""
        reasons = self.dataset["reason"].values
        return {int(k): str(reasons[k]) for k in np.flatnonzero(reasons != "")}

    def __bool__(self) -> bool:
        return not self.failed

    def __repr__(self) -> str:
        n, failed = self.dataset.sizes["sample"], len(self.failed)
        return f"{n} samples of {', '.join(self.parameters)}: {n - failed} solved, {failed} failed"

    def sobol(self) -> xr.Dataset:
        """Sobol indices of each observable, first order and total, over time: see :func:`.sensitivity.indices`."""
        from .sensitivity import indices

        if self.design != "saltelli":
            raise InputError(f'Sobol indices need design="saltelli", not {self.design!r}')
        return indices(self.dataset, self.parameters, self.seed)


def gathered(found: Sequence[Found], over: Sequence[Range], points: Floats, attrs: dict[str, Any]) -> xr.Dataset:
    """One dataset of runs at ``points``, those that are missing as not run."""
    import xarray as xr

    all_of = [*found, *(Found(reason=NOT_RUN) for _ in range(len(points) - len(found)))]
    good = [f for f in all_of if not f.reason]
    units = good[0].units if good else {}
    one = len({len(f.times) for f in good}) <= 1 and all(_near(f.times, good[0].times) for f in good)
    states = max((len(f.times) for f in good), default=0)
    out = xr.Dataset(coords={"sample": np.arange(len(points))}, attrs=attrs)
    out = out.assign_coords({r.path: ("sample", points[:, k]) for k, r in enumerate(over)})
    out = out.assign_coords(
        reason=("sample", np.array([f.reason for f in all_of], dtype=str)),
        seconds=("sample", np.array([f.seconds for f in all_of])),
        iterations=("sample", np.array([f.iterations for f in all_of])),
    )
    if one:
        out = out.assign_coords(time=("time", good[0].times if good else np.zeros(0)))
    else:
        out = out.assign_coords(time=(("sample", "state"), _padded([f.times for f in all_of], states)))
    out["time"].attrs |= {"units": units["time"]} if "time" in units else {}
    for name, first in (good[0].values if good else {}).items():
        rows = [f.values.get(name, np.zeros(0)) for f in all_of]
        own = {"long_name": name} | ({"units": units[name]} if name in units else {})
        if first.ndim:
            out[name] = (("sample", "time" if one else "state"), _padded(rows, states), own)
        else:
            out[name] = ("sample", np.array([v if v.ndim == 0 else np.nan for v in rows], dtype=float), own)
    return out


def _near(a: Floats, b: Floats) -> bool:
    """The same times, to what a plotfile holds."""
    return bool(np.allclose(a, b, rtol=1e-6, atol=0.0))


def _padded(rows: Sequence[Floats], n: int) -> Floats:
    out = np.full((len(rows), n), np.nan)
    for k, v in enumerate(rows):
        out[k, : v.size] = v
    return out
