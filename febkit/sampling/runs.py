"""A model solved at points of its parameters, one after the other in this process."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from febkit.model import InputError
from febkit.observe import Observable, observables

if TYPE_CHECKING:
    from febkit.modelling import Model

Floats = NDArray[np.float64]
FOUND = "found.npz"
NOT_RUN = "not run"


@dataclass(slots=True)
class Found:
    """What one run gave: observables by name, at ``times`` or one number each; ``reason``: why it gave nothing."""

    times: Floats = field(default_factory=lambda: np.zeros(0))
    values: dict[str, Floats] = field(default_factory=dict)
    units: dict[str, str] = field(default_factory=dict)
    reason: str = ""
    seconds: float = 0.0
    iterations: int = 0


def solved(
    model: Model, paths: Sequence[str], points: Floats, chosen: Mapping[str, Observable],
    variables: Sequence[str] | None, at: Sequence[float] | None, threads: int,
) -> Iterator[Found]:  # fmt: skip
    """What each point gives; a run that fails says why and stops nothing. Raises KeyboardInterrupt."""
    m = model.copy()
    for row in points:
        start, result = time.perf_counter(), None
        try:
            for path, value in zip(paths, row):
                m[path] = float(value)
            result = m.solve(variables=variables, at=at, threads=threads, warn=lambda _: None)
            if result.interrupted:
                raise KeyboardInterrupt
            found = _observed(result.dataset, chosen) if result else Found(reason=result.reason)
        except InputError as e:
            found = Found(reason=str(e))
        found.iterations = result.totals.iterations if result is not None else 0
        found.seconds = round(time.perf_counter() - start, 4)
        yield found


def _observed(ds: Any, chosen: Mapping[str, Observable]) -> Found:
    out = Found(np.asarray(ds["time"].values, dtype=float))
    if "units" in ds["time"].attrs:
        out.units["time"] = ds["time"].attrs["units"]
    for name, o in chosen.items():
        v = o(ds)
        if v.dims not in ((), ("time",)):
            raise InputError(f"{name} lives on {', '.join(map(str, v.dims))}: a sweep keeps numbers over time")
        out.values[name] = np.asarray(v.values, dtype=float)
        if "units" in v.attrs:
            out.units[name] = v.attrs["units"]
    return out


# ---- a batch of them, as a step of a study ---------------------------------------------------------


def batch(model: str, params: Mapping[str, Any], folder: Path) -> None:
    """Solve the points of a batch and keep what they give in ``folder``; ``model``: a .feb file."""
    from febkit import process

    process.keep_freed_memory()
    chosen = observables(params["observe"])
    rest = params["variables"], params["at"], params["threads"]
    save(folder / FOUND, list(solved(held(model), params["paths"], np.array(params["points"]), chosen, *rest)))


@lru_cache(maxsize=1)
def held(path: str) -> Model:
    """The model of a file; kept, with what its next solve finds, while this process gets batches of the same."""
    from febkit.modelling import Model

    return Model.read(path)


def save(path: Path, found: Sequence[Found]) -> None:
    names = sorted({n for f in found for n in f.values})
    states = max((len(f.times) for f in found), default=0)
    times, values = np.full((len(found), states), np.nan), np.full((len(names), len(found), states), np.nan)
    for k, f in enumerate(found):
        times[k, : len(f.times)] = f.times
        for i, n in enumerate(names):
            values[i, k, : len(f.times)] = f.values.get(n, np.nan)
    more = [{"units": f.units, "reason": f.reason, "seconds": f.seconds, "iterations": f.iterations} for f in found]
    np.savez(path, times=times, values=values, names=np.array(names, dtype=str), more=np.array(json.dumps(more)))


def load(path: Path) -> list[Found]:
    with np.load(path) as z:
        times, values, names = z["times"], z["values"], z["names"].tolist()
        more = json.loads(str(z["more"]))
    out = []
    for k, rest in enumerate(more):
        n = int(np.isfinite(times[k]).sum())
        own = {} if rest["reason"] else {name: values[i, k, :n] for i, name in enumerate(names)}
        out.append(Found(times[k, :n], own, **rest))
    return out
