"""Values of a result at any points, by the shape functions of the elements that hold them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from febkit.model import InputError


def probe(ds: xr.Dataset, points: Any, variables: Sequence[str] | None = None) -> xr.Dataset:
    """Nodal and element variables (time, point[, component]) at points (m, 3) of the reference configuration.

    v(X) = sum_a N_a(r) v_a with X = sum_a N_a(r) X_a; element variables are those of the element, values at an
    element's nodes are interpolated like nodal ones.
    """
    from febkit.coupling.field import Field, solid_blocks
    from febkit.coupling.location import locate, require_inside
    from febkit.coupling.shapes import shape

    at = np.atleast_2d(np.asarray(points, dtype=float))
    if at.ndim != 2 or at.shape[1] != 3 or not np.isfinite(at).all():
        raise InputError("points are rows of three finite numbers")
    blocks = solid_blocks(ds)
    if not blocks:
        raise InputError("the result holds no solid elements")
    X = np.asarray(ds["X"].values, dtype=float)
    field = Field(X, blocks, np.zeros(1), np.zeros((1, *X.shape)), node_ids=np.asarray(ds["node_id"].values))
    where = locate(field, at)
    require_inside(field, at, where)
    width = max(b.conn.shape[1] for b in blocks)
    nodes, weights = np.zeros((len(at), width), dtype=np.int64), np.zeros((len(at), width))
    rows = np.zeros(len(at), dtype=np.int64)
    for k, b in enumerate(blocks):
        mine = np.flatnonzero(where.block == k)
        if len(mine):
            n = b.conn.shape[1]
            nodes[mine, :n] = b.conn[where.element[mine]]
            weights[mine, :n] = shape(b.type, where.r[mine], 0)
            rows[mine] = b.index[where.element[mine]]
    return _values(ds, at, nodes, weights, rows, variables)


def _values(
    ds: xr.Dataset, at: np.ndarray, nodes: np.ndarray, weights: np.ndarray, rows: np.ndarray,
    variables: Sequence[str] | None,
) -> xr.Dataset:  # fmt: skip
    used, inverse = np.unique(nodes, return_inverse=True)
    inverse = inverse.reshape(nodes.shape)
    data: dict[str, Any] = {}
    for name, v in ds.data_vars.items():
        if variables is not None and name not in variables:
            continue
        rest = tuple(d for d in v.dims if d not in ("time", "node", "element", "local"))
        dims = ("time", "point", *rest)
        if v.dims[:2] == ("time", "node") and v.dtype.kind == "f":
            a = np.asarray(v.isel(node=used).values, dtype=float)
            data[str(name)] = (dims, np.einsum("pn,tpn...->tp...", weights, a[:, inverse]), v.attrs)
        elif v.dims[:3] == ("time", "element", "local") and v.dtype.kind == "f":
            a = np.asarray(v.isel(element=rows).values, dtype=float)
            w = weights[:, : a.shape[2]]
            a = np.where((w == 0).reshape(1, *w.shape, *[1] * (a.ndim - 3)), 0.0, a)
            data[str(name)] = (dims, np.einsum("pn,tpn...->tp...", w, a), v.attrs)
        elif v.dims[:2] == ("time", "element"):
            data[str(name)] = (dims, np.asarray(v.isel(element=rows).values), v.attrs)
        elif variables is not None:
            raise InputError(f"{name} lives on neither nodes nor elements")
    parts = {d: ds[d] for n in data for d in data[n][0] if d in ds.coords and d != "time"}
    coords = {"time": ds["time"], "X": (("point", "xyz"), at, ds["X"].attrs), "xyz": ["x", "y", "z"],
              "element_id": ("point", np.asarray(ds["element_id"].values)[rows])}  # fmt: skip
    return xr.Dataset(data, coords=coords | parts, attrs={k: ds.attrs[k] for k in ("unit_system",) if k in ds.attrs})
