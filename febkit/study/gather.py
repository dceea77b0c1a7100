"""A study's results as one dataset, and where it stands."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from febkit.model import InputError

from .plan import CONTROL, Place, Plan
from .store import Store
from .work import AGREEMENT, METRICS

if TYPE_CHECKING:
    import xarray as xr

BLOCK = 64  # results that are held at once while all are written
Found = Iterable[tuple[Place, "xr.Dataset"]]


class Finished(Mapping[Place, "xr.Dataset"]):
    """Metrics there are, by place, in the units of the first; each is read when asked for, the last ones are kept.

    Raises InputError where some results name their units and some do not.
    """

    def __init__(self, plan: Plan) -> None:
        store = Store(plan.study.folder)
        self._path = {p: store.path(s.key) / METRICS for p, s in plan.metrics.items() if store.has(s.key)}
        self._kept: dict[Place, xr.Dataset] = {}
        self._first: xr.Dataset | None = None

    def __getitem__(self, place: Place) -> xr.Dataset:
        import xarray as xr

        from febkit.metrics.agreement import in_units_of

        if place in self._kept:
            return self._kept[place]
        path = self._path[place]
        if self._first is None and place != (first := next(iter(self._path))):
            self._first = self[first]
        with xr.open_dataset(path, engine="netcdf4") as ds:
            own = ds.load()
        self._first = own if self._first is None else self._first
        while len(self._kept) >= BLOCK:
            del self._kept[next(iter(self._kept))]
        self._kept[place] = in_units_of(self._first, own)
        return self._kept[place]

    def __iter__(self) -> Iterator[Place]:
        return iter(self._path)

    def __len__(self) -> int:
        return len(self._path)

    def __contains__(self, place: object) -> bool:
        return place in self._path

    def survey(self) -> tuple[list[Any], list[Place]]:
        """Names of all cells, and a place for each variable that there is; a look at each file, no values."""
        import netCDF4

        cells: dict[Any, None] = {}
        of: dict[str, Place] = {}
        for place, path in self._path.items():
            with netCDF4.Dataset(path) as f:
                cells.update(dict.fromkeys(f["cell"][:].tolist()))
                for name in f.variables:
                    of.setdefault(name, place)
        return list(cells), list(dict.fromkeys(of.values()))


def finished(plan: Plan) -> Iterator[tuple[Place, xr.Dataset]]:
    """Metrics there are, by place, one after the other: :class:`Finished`."""
    yield from Finished(plan).items()


def results(plan: Plan, found: Found | None = None) -> xr.Dataset:
    """All metrics (case, handoff, point, cell, time); NaN where a step has not been done.

    ``found``: those of :func:`finished`, where they are at hand.

    Where [cell] has a list of seeds, (case, handoff, point, seed, cell, time); with [variants] there is a dimension
    ``variant`` before the cells. Coordinates of points: ``position``, ``x``, ``y``, ``z`` and, where they are known,
    ``depth`` (normalised, from the tissue's top) and ``zone``. Times are those of the first result; cells those of all.
    In memory: :func:`write_results` makes the same as a file, whatever its size.
    """
    import xarray as xr

    found = list(finished(plan) if found is None else found)
    coords = coordinates(plan)
    if not found:
        return xr.Dataset(coords=coords)
    cells = dict.fromkeys(c for _, ds in found for c in ds["cell"].values.tolist())
    out = _empty([ds for _, ds in found], list(cells), coords)
    for place, ds in found:
        at = _at(plan, place)
        for name, v in _own(out, ds):
            out[name].values[at] = v
    return out


def require_results(plan: Plan) -> None:
    """Raises InputError where nothing of a study is measured."""
    store = Store(plan.study.folder)
    if not any(store.has(s.key) for s in plan.metrics.values()):
        raise InputError(f"nothing of the study {plan.study.name!r} is measured yet; run it first")


def write_results(plan: Plan, path: str | Path) -> int:
    """:func:`results` as a NetCDF file, place by place: no more than some results are in memory at once.

    Returns how many results there are in it. Raises InputError where there are none.
    """
    import netCDF4

    from febkit.files import written
    from febkit.results.netcdf import unwritten

    require_results(plan)
    found = Finished(plan)
    cells, places = found.survey()
    shape = _empty([found[p] for p in places], cells, coordinates(plan), held=False)
    head, bare = len(plan_dims(plan)), [str(v) for v in shape.data_vars]
    with written(path) as part:
        try:
            shape.drop_vars(bare).to_netcdf(part, engine="netcdf4")
            with netCDF4.Dataset(part, "a") as f:
                _declare(f, shape, head)
                for place, ds in found.items():
                    for name, v in _own(shape, ds):
                        f[name][_at(plan, place)] = v
        except RuntimeError as e:  # what the library makes of a full disk
            raise unwritten(path, e) from None
    return len(found)


def _declare(f: Any, shape: xr.Dataset, head: int) -> None:
    """The variables of a file that is written piece by piece; a chunk holds the points of one case and hand-off."""
    for d, n in shape.sizes.items():
        if d not in f.dimensions:
            f.createDimension(d, n)
    for name, v in shape.data_vars.items():
        chunk = [1, 1, *(min(n, BLOCK) for n in v.shape[2:head]), *v.shape[head:]]
        made = f.createVariable(name, "f8", v.dims, fill_value=np.nan, chunksizes=chunk)
        made.setncatts({k: a for k, a in v.attrs.items() if k != "_FillValue"})


def plan_dims(plan: Plan) -> list[str]:
    """Dimensions of the dataset that say where in the study a value stands."""
    study = plan.study
    more = (["seed"] if study.seeds != (None,) else []) + (["variant"] if len(study.variants) > 1 else [])
    return ["case", "handoff", "point", *more]


def coordinates(plan: Plan) -> dict[str, Any]:
    """Coordinates along :func:`plan_dims`, and those of the points."""
    study = plan.study
    values: dict[str, Any] = {
        "case": list(study.cases),
        "handoff": ([CONTROL] if study.control else []) + [m.name for m in study.methods],
        "point": np.arange(len(study.points)),
        "seed": list(study.seeds),
        "variant": [v.name for v in study.variants],
    }
    at = np.array(study.points, dtype=float)
    out = {d: values[d] for d in plan_dims(plan)}
    out["position"] = (("point", "xyz"), at)
    out |= {k: ("point", at[:, i]) for i, k in enumerate("xyz")}
    depths = study.depths or _depths(plan)
    if depths:
        text = {"long_name": "normalised depth", "comment": "0 at the top of the tissue, 1 at its bottom"}
        out["depth"] = ("point", np.array(depths), text)
    if study.zones:
        out["zone"] = ("point", [study.zones[k].name for k in study.zone_of])
    for table in ("cell", "tissue") if "variant" in out else ():
        for name in getattr(study.variants[0], table):
            own = [getattr(v, table)[name] for v in study.variants]
            if all(isinstance(x, int | float) and not isinstance(x, bool) for x in own):
                out[f"variant_{name}" if table == "cell" else f"variant_{table}_{name}"] = ("variant", own)
    return out


def _depths(plan: Plan) -> tuple[float, ...]:
    """Depths of points that are listed, where there are several and the tissue tells."""
    from febkit.model import Where

    from .depth import columns, placed
    from .points import Points

    study = plan.study
    if len(study.points) == 1:
        return ()
    where = Where(str(study.file))
    try:
        return placed(Points(study.points), columns(study.every_tissue(), where), where)[1]
    except InputError:  # a point outside fails where its series is made, and is named there
        return ()


def _at(plan: Plan, place: Place) -> tuple[int, ...]:
    study = plan.study
    index = {
        "case": study.cases.index(place.case),
        "handoff": (int(study.control) + [m.name for m in study.methods].index(place.method))
        if place.method != CONTROL
        else 0,
        "point": place.point,
        "seed": place.seed,
        "variant": place.variant,
    }
    return tuple(index[d] for d in plan_dims(plan))


def _own(out: xr.Dataset, ds: xr.Dataset) -> Iterator[tuple[str, np.ndarray]]:
    """Values of one result by variable, at the cells and times of all."""
    for name, v in out.data_vars.items():
        if name in ds:
            own = ds[name].transpose(*v.dims[v.ndim - ds[name].ndim :])
            own = own.reindex(cell=out["cell"]) if "cell" in own.dims else own
            yield str(name), _at_times(own, out["time"].values)


def _at_times(v: xr.DataArray, times: np.ndarray) -> np.ndarray:
    """Values at ``times``, NaN where a result has no such time (to single precision)."""
    if "time" not in v.dims:
        return v.values
    own = v["time"].values
    near = np.abs(own[None] - times[:, None]).argmin(axis=1)
    ok = np.abs(own[near] - times) <= 1e-4 * np.maximum(np.abs(times), 1e-3)
    a = np.moveaxis(v.values, v.dims.index("time"), -1)[..., near]
    return np.moveaxis(np.where(ok, a, np.nan), -1, v.dims.index("time"))


def _empty(
    found: list[xr.Dataset], cells: list[Any], coords: dict[str, Any], held: bool = True
) -> xr.Dataset:
    """A dataset of NaN with the variables of all results; of no memory where its values are not to be ``held``."""
    import xarray as xr

    first, data = found[0], {}
    dims = [d for d in coords if d in ("case", "handoff", "point", "seed", "variant")]
    before = tuple(len(coords[d]) for d in dims)
    inner = {"cell": len(cells), "time": first.sizes["time"]}
    for ds in found:
        for name, v in ds.data_vars.items():
            if name not in data and v.dtype.kind in "fiub":
                shape = (*before, *(inner.get(str(d), n) for d, n in v.sizes.items()))
                values = np.full(shape, np.nan) if held else np.broadcast_to(np.nan, shape)
                data[name] = ((*dims, *v.dims), values, v.attrs)
    own = {k: first[k] for k in first.coords if k not in ("cell", *coords) and "cell" not in first[k].dims}
    return xr.Dataset(data, coords={**coords, "cell": cells, **own}, attrs=first.attrs)


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
