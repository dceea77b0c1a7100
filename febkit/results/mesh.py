"""The mesh behind a dataset of results: nodes, element blocks, sets and surfaces."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from febkit.model import InputError

from .xplt.records import PlotDomain, PlotMesh, PlotSurface

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True, slots=True, eq=False)
class ResultBlock:
    """Elements of one type and part; ``where`` is their place along the element dimension."""

    type: str
    part: str
    element_ids: np.ndarray
    conn: np.ndarray  # (element, local) 0-based node indices
    where: slice

    def __iter__(self) -> Any:
        """(type, part, element ids, conn, slice)."""
        return iter((self.type, self.part, self.element_ids, self.conn, self.where))


@dataclass(frozen=True, slots=True, eq=False)
class ResultMesh:
    """Ids are the file's labels; node sets and surfaces hold 0-based indices, element sets ids."""

    node_ids: np.ndarray
    X: np.ndarray  # (node, 3) reference coordinates
    blocks: list[ResultBlock]
    node_sets: Mapping[str, np.ndarray]
    element_sets: Mapping[str, np.ndarray]
    surfaces: Mapping[str, np.ndarray]  # (facet, local) node indices padded with -1


_NEEDED = ("node_id", "X", "element_id", "part", "element_type", "connectivity")


def check(ds: xr.Dataset) -> None:
    """Say so where a dataset has lost its mesh, as ds[["name"]] loses it."""
    lost = [n for n in _NEEDED if n not in ds]
    if lost:
        how = "drop variables with drop_vars, which keeps the mesh"
        raise InputError(f"the dataset has no {', '.join(lost)}: {how}")


def of(ds: xr.Dataset) -> ResultMesh:
    """The mesh of a dataset that ``febkit.results.open`` made, or that was read back from NetCDF."""
    check(ds)
    return ResultMesh(
        node_ids=ds["node_id"].values,
        X=ds["X"].values,
        blocks=_blocks(ds),
        node_sets=node_sets(ds),
        element_sets=_members(ds, "element_set_members"),
        surfaces=surfaces(ds),
    )


def texts(ds: Any, key: str) -> list[str]:
    """An attribute that is a list of names; NetCDF gives a list of one back as one string."""
    value = ds.attrs.get(key, [])
    return [value] if isinstance(value, str) else [str(v) for v in value]


def numbers(ds: Any, key: str) -> list[int]:
    """An attribute that is a list of integers; NetCDF gives arrays and single numbers back."""
    return [int(v) for v in np.atleast_1d(ds.attrs.get(key, []))]


def widths() -> dict[str, int]:
    """Nodes of each element type."""
    from .xplt import tags

    return dict(tags.ELEMENT_TYPES)


def _blocks(ds: xr.Dataset) -> list[ResultBlock]:
    """Runs of equal part and type along the element dimension."""
    part, kind = ds["part"].values, ds["element_type"].values
    parts, types = texts(ds, "parts"), texts(ds, "element_types")
    conn, ids = ds["connectivity"].values, ds["element_id"].values
    change = np.flatnonzero((np.diff(part) != 0) | (np.diff(kind) != 0)) + 1
    edges = [0, *change.tolist(), len(part)] if len(part) else []
    nodes = widths()
    out = []
    for a, b in pairwise(edges):
        t = types[kind[a]]
        out.append(ResultBlock(t, parts[part[a]], ids[a:b], conn[a:b, : nodes[t]], slice(a, b)))
    return out


def node_sets(ds: xr.Dataset) -> dict[str, np.ndarray]:
    """Rows of the nodes of each node set."""
    return _members(ds, "node_set_members")


def surfaces(ds: xr.Dataset) -> dict[str, np.ndarray]:
    """(facet, local) rows of nodes of each surface, padded with -1."""
    return dict(_facets(ds, "facets"))


def _members(ds: xr.Dataset, key: str) -> dict[str, np.ndarray]:
    if key not in ds:
        return {}
    parts = np.split(ds[key].values, np.cumsum(numbers(ds[key], "sizes"))[:-1])
    return dict(zip(texts(ds[key], "names"), parts))


def _facets(ds: xr.Dataset, key: str) -> list[tuple[str, np.ndarray]]:
    if key not in ds:
        return []
    v = ds[key]
    rows = np.split(v.values, np.cumsum(numbers(v, "sizes"))[:-1])
    return [(n, r[:, :w]) for n, r, w in zip(texts(v, "names"), rows, numbers(v, "widths"))]


def plot_mesh(ds: xr.Dataset) -> PlotMesh:
    """The mesh as a plotfile states it."""
    check(ds)
    parts, sizes = texts(ds, "parts"), numbers(ds, "part_sizes")
    named = numbers(ds, "part_named") or [1] * len(parts)
    owners = numbers(ds, "part_materials") or list(range(1, len(parts) + 1))
    types, kind = texts(ds, "element_types"), ds["element_type"].values
    ids, conn, nodes = ds["element_id"].values, ds["connectivity"].values, widths()
    domains, at = [], 0
    for name, n, has_name, owner in zip(parts, sizes, named, owners):
        t = types[kind[at]]
        rows = slice(at, at + n)
        domains.append(PlotDomain(t, owner, name if has_name else None, ids[rows], conn[rows, : nodes[t]]))
        at += n
    if not sizes:  # no plotfile's dataset: a domain for each run of one part and type
        owner_of = dict(zip(parts, owners))
        domains = [PlotDomain(b.type, owner_of[b.part], b.part, b.element_ids, b.conn) for b in _blocks(ds)]
    facet_sets: list[PlotSurface] | None = [PlotSurface(n, r) for n, r in _facets(ds, "facet_set_facets")]
    if not facet_sets and not ("facets" in ds and ds["facets"].attrs.get("no_facet_sets")):
        facet_sets = None
    return PlotMesh(
        node_ids=ds["node_id"].values,
        X=ds["X"].values,
        domains=domains,
        surfaces=[PlotSurface(n, r) for n, r in _facets(ds, "facets")],
        node_sets=_members(ds, "node_set_members"),
        element_sets=_members(ds, "element_set_members"),
        parts=list(zip(numbers(ds, "material_ids"), texts(ds, "materials"))),
        facet_sets=facet_sets,
        edges=[PlotSurface(n, r) for n, r in _facets(ds, "edge_lines")],
        objects=ds["objects"].values.tobytes() if "objects" in ds else b"",
    )


def local_mean(a: np.ndarray, axis: int = 1) -> np.ndarray:
    """Mean over the nodes of an element or facet that have a value; NaN where none has."""
    known = ~np.isnan(a)
    with np.errstate(invalid="ignore"):
        return np.asarray(np.where(known, a, 0).sum(axis=axis) / known.sum(axis=axis))
