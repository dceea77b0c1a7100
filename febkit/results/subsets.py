"""Datasets of a part, a node set or a surface of a result: the same layout, fewer nodes and elements."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from febkit.model import InputError

from . import mesh as meshes

if TYPE_CHECKING:
    import xarray as xr

# attributes of a dataset that have an entry for each part
_PER_PART = ("parts", "part_materials", "part_sizes", "part_named")
_OF_ELEMENTS = {"time", "node", "element", "local", "domain"}


def state_at(times: Any, time: float | None, rtol: float, least: float) -> int:
    """The state at a time, within ``rtol`` of it or of ``least`` where that is more; the last where none is named."""
    t = np.asarray(times, dtype=float)
    if not len(t):
        raise InputError("the result holds no state")
    if time is None:
        return len(t) - 1
    k = int(np.abs(t - time).argmin())
    if abs(t[k] - time) > rtol * max(abs(time), least):
        raise InputError(f"no state at t = {time:g}; the nearest is {t[k]:g}")
    return k


def node_set(ds: xr.Dataset, name: str) -> np.ndarray:
    """Rows of the nodes of a node set, or of a surface. Raises InputError that names those there are."""
    sets = meshes.node_sets(ds)
    if name in sets:
        return sets[name]
    surfaces = meshes.surfaces(ds)
    if name in surfaces:
        return np.unique(surfaces[name][surfaces[name] >= 0])
    known = ", ".join([*sets, *surfaces]) or "none"
    raise InputError(f"no node set or surface is called {name!r}; the result has {known}")


def nodes_of(ds: xr.Dataset, rows: np.ndarray) -> xr.Dataset:
    """Nodal variables at these rows of nodes."""
    nodal = [n for n, v in ds.data_vars.items() if "node" in v.dims]
    keep = [n for n, v in ds.coords.items() if "node" in v.dims or n == "time" or n in _components(ds, nodal)]
    picked = ds[nodal].drop_vars([c for c in ds[nodal].coords if c not in keep])
    return picked.isel(node=rows)


def _components(ds: xr.Dataset, names: list[Any]) -> set[Any]:
    return {d for n in names for d in ds[n].dims}


def elements_of(ds: xr.Dataset, rows: np.ndarray) -> xr.Dataset:
    """These elements (rows, ascending), their nodes, and variables of both; sets and surfaces are left out."""
    meshes.check(ds)
    rows = np.sort(rows)
    conn = ds["connectivity"].values[rows]
    nodes = np.unique(conn[conn >= 0])
    part = ds["part"].values[rows]
    used, code = np.unique(part, return_inverse=True)
    data = [n for n, v in ds.data_vars.items() if {"node", "element", "domain"} & set(v.dims) or v.dims == ("time",)]
    kept = ds[data]
    shared = _components(ds, data) | _OF_ELEMENTS
    kept = kept.drop_vars([c for c, v in kept.coords.items() if not set(v.dims) <= shared])
    out = kept.isel(element=rows, node=nodes)
    if "domain" in out.dims:
        out = out.isel(domain=used)
    new = np.where(conn >= 0, np.searchsorted(nodes, conn), -1).astype(np.int32)
    out = out.assign_coords(
        connectivity=(("element", "local"), new, ds["connectivity"].attrs),
        part=("element", code.reshape(part.shape).astype(np.int32), ds["part"].attrs),
    )
    return _with_parts(out, ds, used, np.bincount(code.reshape(-1), minlength=len(used)))


def _with_parts(out: xr.Dataset, ds: xr.Dataset, used: np.ndarray, sizes: np.ndarray) -> xr.Dataset:
    """Attributes that list the parts, for those that are left."""
    from .dataset import flags

    attrs: dict[str, Any] = dict(ds.attrs)
    for key in _PER_PART:
        if key in attrs:
            values = np.atleast_1d(np.asarray(attrs[key], dtype=object))
            attrs[key] = [values[k] for k in used]
    attrs["part_sizes"] = [int(n) for n in sizes]
    out["part"].attrs = {**ds["part"].attrs, **flags(meshes.texts(ds, "parts") and list(map(str, attrs["parts"])))}
    return out.assign_attrs(attrs)


def surface(ds: xr.Dataset, name: str) -> xr.Dataset:
    """The facets of a surface, its nodes, and variables of both."""
    found = meshes.surfaces(ds)
    if name not in found:
        raise InputError(f"no surface is called {name!r}; the result has {', '.join(found) or 'none'}")
    at = list(found).index(name)
    start = sum(len(f) for f in list(found.values())[:at])
    facets = found[name]
    nodes = np.unique(facets[facets >= 0])
    data = [n for n, v in ds.data_vars.items() if {"facet", "surface"} & set(v.dims)]
    of_facets = ds[data].drop_vars([c for c, v in ds[data].coords.items() if not _shared(v.dims, ds, data)])
    if "facet" in of_facets.dims:
        of_facets = of_facets.isel(facet=slice(start, start + len(facets)))
    if "surface" in of_facets.dims:
        of_facets = of_facets.isel(surface=at)
    rows = np.where(facets >= 0, np.searchsorted(nodes, facets), -1).astype(np.int32)
    rows = np.pad(rows, ((0, 0), (0, ds["facets"].shape[1] - rows.shape[1])), constant_values=-1)
    out = nodes_of(ds, nodes).merge(of_facets.drop_vars("facets", errors="ignore"), combine_attrs="drop_conflicts")
    return out.assign_coords(facets=(("facet", "facet_local"), rows)).assign_attrs(nodes_of(ds, nodes).attrs)


def _shared(dims: Any, ds: xr.Dataset, names: list[Any]) -> bool:
    return set(dims) <= _components(ds, names)
