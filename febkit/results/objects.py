"""Rigid bodies, connectors and springs of a run over time."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import xarray as xr

from .xplt.objects import ObjectState, PlotObject, read_section, read_state


def objects(ds: xr.Dataset) -> xr.Dataset:
    """Objects of a dataset of results, with dimensions (time, object): ``position``, ``rotation`` (quaternion
    x, y, z, w) and one variable per datum ("Force", "Moment", ...), NaN where an object has none of it."""
    if "objects" not in ds:
        return xr.Dataset()
    found = read_section(ds["objects"].values.tobytes())
    raw = ds["object_state"].values if "object_state" in ds else np.empty((0, 0), np.uint8)
    place = {(o.line, o.id): i for i, o in enumerate(found)}
    n = len(raw)
    data: dict[str, Any] = {
        "position": (("time", "object", "xyz"), _empty(n, len(found), 3)),
        "rotation": (("time", "object", "quaternion"), _empty(n, len(found), 4)),
    }
    for o in found:
        for v in o.data:
            dims = ("time", "object", "xyz") if v.values == 3 else ("time", "object")
            shape = (3,) if v.values == 3 else ()
            if v.values in (1, 3):
                data.setdefault(_name(v.name), (dims, _empty(n, len(found), *shape)))
    for t in range(n):
        for line, number, s in read_state(raw[t].tobytes()):
            if (line, number) in place:
                _store(data, found[place[line, number]], place[line, number], t, s)
    coords = {
        "time": ds["time"].values[:n],
        "object": [o.name for o in found],
        "object_kind": ("object", [o.tag for o in found]),
        "xyz": ["x", "y", "z"],
        "quaternion": ["x", "y", "z", "w"],
    }
    return xr.Dataset(data, coords)


def _empty(*shape: int) -> np.ndarray:
    return np.full(shape, np.nan, np.float32)


def _name(name: str) -> str:
    return re.sub(r"\W+", "_", name).strip("_")


def _store(data: dict[str, Any], o: PlotObject, row: int, t: int, s: ObjectState) -> None:
    data["position"][1][t, row] = s.position
    data["rotation"][1][t, row] = s.rotation
    for k, values in s.values.items():
        if k < len(o.data) and np.size(values) == o.data[k].values and _name(o.data[k].name) in data:
            target = data[_name(o.data[k].name)][1]
            target[t, row] = values if target.ndim == 3 else np.asarray(values).item()
