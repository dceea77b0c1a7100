"""A study's results as one dataset, and where it stands."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from .plan import CONTROL, Place, Plan
from .store import Store
from .work import AGREEMENT, METRICS

if TYPE_CHECKING:
    import xarray as xr


def finished(plan: Plan) -> Iterator[tuple[Place, xr.Dataset]]:
    """Metrics there are, by place, in the units of the first.

    Raises InputError where some results name their units and some do not.
    """
    import xarray as xr

    from febkit.metrics.agreement import in_units_of

    store = Store(plan.study.folder)
    first: xr.Dataset | None = None
    for where, step in plan.metrics.items():
        if store.has(step.key):
            with xr.open_dataset(store.path(step.key) / METRICS) as ds:
                own = ds.load()
            first = own if first is None else first
            yield where, in_units_of(first, own)


def results(plan: Plan, found: Iterable[tuple[Place, xr.Dataset]] | None = None) -> xr.Dataset:
    """All metrics (case, handoff, point, cell, time); NaN where a step has not been done.

    ``found``: those of :func:`finished`, where they are at hand.

    Where [cell] has a list of seeds, (case, handoff, point, seed, cell, time). Times are those of the first result.
    """
    import xarray as xr

    study = plan.study
    methods = ([CONTROL] if study.control else []) + [m.name for m in study.methods]
    coords: dict[str, Any] = {
        "case": list(study.cases),
        "handoff": methods,
        "point": np.arange(len(study.points)),
    }
    if study.seeds != (None,):
        coords["seed"] = list(study.seeds)
    out: xr.Dataset | None = None
    for place, ds in finished(plan) if found is None else found:
        if out is None:
            out = _empty(ds, coords)
        which = (place.point, place.seed)[: len(coords) - 2]
        at = (study.cases.index(place.case), methods.index(place.method), *which)
        for name in out.data_vars:
            if name in ds:
                own = ds[name].reindex(cell=out["cell"]).transpose(*out[name].dims[len(coords) :])
                out[name].values[at] = _at_times(own, out["time"].values)
    if out is None:
        return xr.Dataset(coords=coords)
    out = out.assign_coords(position=(("point", "xyz"), np.array(study.points, dtype=float)))
    out.attrs["study"] = study.name
    return out


def _at_times(v: xr.DataArray, times: np.ndarray) -> np.ndarray:
    """Values at ``times``, NaN where a result has no such time (to single precision)."""
    own = v["time"].values
    near = np.abs(own[None] - times[:, None]).argmin(axis=1)
    ok = np.abs(own[near] - times) <= 1e-4 * np.maximum(np.abs(times), 1e-3)
    a = np.moveaxis(v.values, v.dims.index("time"), -1)[..., near]
    return np.moveaxis(np.where(ok, a, np.nan), -1, v.dims.index("time"))


def _empty(ds: xr.Dataset, coords: dict[str, Any]) -> xr.Dataset:
    import xarray as xr

    shape = tuple(len(v) for v in coords.values())
    data = {
        name: ((*coords, *v.dims), np.full((*shape, *v.shape), np.nan), v.attrs)
        for name, v in ds.data_vars.items()
        if "cell" in v.dims
    }
    return xr.Dataset(
        data,
        coords={**coords, **{k: ds[k] for k in ("cell", "time", "xyz") if k in ds.coords}},
        attrs=ds.attrs,
    )


def agreements(plan: Plan) -> dict[Place, xr.Dataset]:
    """Agreement with the control by place."""
    import xarray as xr

    store = Store(plan.study.folder)
    out = {}
    for where, step in plan.agreement.items():
        if store.has(step.key):
            with xr.open_dataset(store.path(step.key) / AGREEMENT) as ds:
                out[where] = ds.load()
    return out


def status(plan: Plan) -> list[dict[str, Any]]:
    """One row per kind of step: done, failed and still to do, and the seconds done ones took."""
    store = Store(plan.study.folder)
    needed = plan.needed(store)
    counts: dict[str, Counter[str]] = {}
    seconds: Counter[str] = Counter()
    for key, step in plan.steps().items():
        c = counts.setdefault(step.kind, Counter())
        if store.has(key):
            c["done"] += 1
            seconds[step.kind] += store.record(key)["seconds"]
        elif key not in needed:
            c["done, files dropped"] += 1
        else:
            c["failed" if store.failure(key) else "to do"] += 1
    return [{"kind": k, **c, "seconds": round(seconds[k], 1)} for k, c in counts.items()]


def failures(plan: Plan) -> list[tuple[str, str]]:
    """(label, why) of the steps that failed last time."""
    store = Store(plan.study.folder)
    found = ((s.label, store.failure(k)) for k, s in plan.needed(store).items())
    return [(label, why) for label, why in found if why]
