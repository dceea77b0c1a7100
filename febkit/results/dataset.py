"""A plotfile as an xarray.Dataset whose variables are decoded when touched.

Dimensions: ``time``, ``node``, ``element`` (both labelled by the file's ids: ``ds.sel(node=13)`` is FEBio's node 13,
``ds.isel(node=12)`` the thirteenth of the file), ``local`` (nodes of an element), components ``xyz``, ``voigt``
(xx yy zz xy yz xz), ``tensor`` (row-major), ``principal``, ``voigt4``; ``domain`` for one value per domain;
``facet``, ``facet_local``, ``surface``, ``surface_node`` for surfaces; ``edge_*`` for edges; ``solute`` and
``solid_bound`` for arrays over the species of a mixture, with their names as coordinates, also where there is one.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
import xarray as xr
from xarray.backends import BackendArray
from xarray.core import indexing

from febkit import units
from febkit.model import InputError

from .fields import Field, Places, components, species
from .variables import unit_symbol
from .xplt.reader import PlotFile
from .xplt.records import MeshOutline, PlotSurface, PlotVariable
from .xplt.source import Held

if TYPE_CHECKING:
    from collections.abc import Hashable



Make = Callable[[], np.ndarray]


class Frames(Protocol):
    """Arrays of one shape, one a state."""

    shape: tuple[int, ...]
    dtype: Any

    def frame(self, t: int) -> np.ndarray: ...

    def fill(self, t: int, out: np.ndarray) -> None: ...


class FrameArray(BackendArray):
    """(time, *frame) decoded on indexing; only the states asked for are read."""

    def __init__(self, frames: Frames, n: int) -> None:
        self.frames = frames
        self.shape = (n, *frames.shape)
        self.dtype = np.dtype(frames.dtype)

    def __getitem__(self, key: indexing.ExplicitIndexer) -> Any:
        return indexing.explicit_indexing_adapter(key, self.shape, indexing.IndexingSupport.OUTER, self._get)

    def _get(self, key: tuple[Any, ...]) -> np.ndarray:
        when, inner = key[0], key[1:]
        whole = all(isinstance(k, slice) and k == slice(None) for k in inner)
        one = self._whole if whole else self._picker(inner)
        if isinstance(when, (int, np.integer)):
            return one(int(when))
        times = np.arange(self.shape[0])[when]
        if whole:
            out = np.empty((len(times), *self.shape[1:]), self.dtype)
            for k, t in enumerate(times):
                self.frames.fill(int(t), out[k, ...])
            return out
        if not len(times):
            pick = _outer(inner, self.shape[1:])
            return np.empty((0, *np.empty(self.shape[1:], np.bool_)[pick].shape), self.dtype)
        return np.stack([one(int(t)) for t in times])

    def _whole(self, t: int) -> np.ndarray:
        return np.require(self.frames.frame(t), self.dtype, "W")

    def _picker(self, inner: tuple[Any, ...]) -> Callable[[int], np.ndarray]:
        """What picks items of a state; of few items of a large state without the rest of it."""
        pick, n = getattr(self.frames, "rows", None), self.shape[1]
        if pick is not None and all(isinstance(k, slice) and k == slice(None) for k in inner[1:]):
            if isinstance(inner[0], (int, np.integer)):
                one = np.array([int(inner[0]) % n])
                return lambda t: np.require(pick(t, one)[0], self.dtype, "W")
            rows = np.arange(n)[inner[0]]
            if not isinstance(inner[0], slice) or _FEW * len(rows) < n:
                return lambda t: np.require(pick(t, rows), self.dtype, "W")
        key = _outer(inner, self.shape[1:])
        return lambda t: np.array(self.frames.frame(t)[key], self.dtype)


_FEW = 4  # times fewer items than there are, that a slice of them is picked by rows


def _outer(key: tuple[Any, ...], shape: tuple[int, ...]) -> tuple[Any, ...]:
    """Orthogonal indexing as numpy does it; integers drop their axis."""
    arrays = [k for k in key if isinstance(k, np.ndarray)]
    if len(arrays) < 2 and not (arrays and any(isinstance(k, (int, np.integer)) for k in key)):
        return key
    full = [np.arange(n)[k] if isinstance(k, slice) else np.atleast_1d(k) for k, n in zip(key, shape)]
    grid = list(np.ix_(*full))
    drop = tuple(i for i, k in enumerate(key) if isinstance(k, (int, np.integer)))
    return tuple(np.squeeze(np.broadcast_arrays(*grid)[i], axis=drop) for i in range(len(grid)))


class MeshArray(BackendArray):
    """An array of the mesh, made when touched."""

    def __init__(self, shape: tuple[int, ...], dtype: np.dtype, make: Make) -> None:
        self.shape, self.dtype, self.make = shape, dtype, make

    def __getitem__(self, key: indexing.ExplicitIndexer) -> Any:
        return indexing.explicit_indexing_adapter(
            key, self.shape, indexing.IndexingSupport.OUTER_1VECTOR, self._get
        )

    def _get(self, key: tuple[Any, ...]) -> np.ndarray:
        whole = self.make() if all(self.shape) else np.empty(self.shape, self.dtype)
        return np.asarray(whole[key], self.dtype)


def _held(f: PlotFile, array: FrameArray | MeshArray) -> Any:
    """What a variable holds: an array that is read when touched, or at once where all of the file is in memory."""
    if not isinstance(f.container.data, Held):
        return indexing.LazilyIndexedArray(array)
    whole = array._get((slice(None),) * len(array.shape))
    return whole if whole.flags.writeable else whole.copy()


class ElementStates:
    """Flags of the elements, 1 where an element is active, as frames."""

    def __init__(self, f: PlotFile, states: np.ndarray, n: int) -> None:
        self.file, self.states = f, states
        self.shape: tuple[int, ...] = (n,)
        self.dtype: Any = np.uint32

    def frame(self, t: int) -> np.ndarray:
        flags = self.file.element_state(int(self.states[t]))
        if flags is None or not len(flags):  # FEBio lists none for some meshes of shells: all are active
            return np.ones(self.shape, np.uint32)
        if len(flags) != self.shape[0]:
            say = f"damaged state: flags of {len(flags)} elements where the mesh has {self.shape[0]}"
            raise InputError(say, self.file.container.where)
        return flags

    def fill(self, t: int, out: np.ndarray) -> None:
        out[...] = self.frame(t)


class ObjectStates:
    """Bytes of the objects' values, as frames."""

    def __init__(self, f: PlotFile, states: np.ndarray, n: int) -> None:
        self.file, self.states = f, states
        self.shape: tuple[int, ...] = (n,)
        self.dtype: Any = np.uint8

    def frame(self, t: int) -> np.ndarray:
        raw = self.file.objects(int(self.states[t]))
        if len(raw) != self.shape[0]:
            say = f"damaged state: {len(raw)} bytes of objects where the first state has {self.shape[0]}"
            raise InputError(say, self.file.container.where)
        return np.frombuffer(raw, np.uint8)

    def fill(self, t: int, out: np.ndarray) -> None:
        out[...] = self.frame(t)


def build(f: PlotFile, mesh: int = 0, apart: bool = False) -> xr.Dataset:
    """The dataset of one mesh of a plotfile and the states that live on it."""
    states = np.array([i for i, s in enumerate(f.states) if max(s.mesh, 0) == mesh], dtype=int)
    outline = f.outline(mesh)
    places = Places(outline, partial(f.mesh, mesh))
    coords, attrs = _coords(f, mesh, states)
    coords |= _sets(outline)
    data: dict[Hashable, xr.Variable] = {}
    for i, v in enumerate(f.variables):
        if v.section == "material":  # of versions below 8; FEBio never wrote data there
            continue
        field = Field(f, states, i, v, places, apart)
        name = _free(variable_name(v.name), v.section, {*data, *coords})
        dims, extra = _dims(v, name, apart, coords)
        data[name] = xr.Variable(("time", *dims), _held(f, FrameArray(field, len(states))), _attrs(f, v, i, field))
        coords |= {k: c for k, c in extra.items() if k not in coords}
    coords |= _shared(f, places, apart)
    _states(f, states, outline, data)
    ds = xr.Dataset(data, coords, attrs)
    ds.encoding["source"] = str(f.container.path)
    ds.set_close(f.close)
    name_units(ds, f.header.units)
    return ds


def name_units(ds: xr.Dataset, system: str | None) -> None:
    """Name the system of a dataset, ``attrs["unit_system"]``, and the units of all that it holds, ``attrs["units"]``.

    Pure numbers have the unit "1" in any system; nothing else has one where the system is not known.
    """
    known = units.system(system)
    if system:
        ds.attrs["unit_system"] = system
    symbols = {"time": "t", "X": "L"}
    for name, v in ds.variables.items():
        symbol = v.attrs.get("febio_units") or unit_symbol(v.attrs.get("febio_name", "")) or symbols.get(str(name), "")
        unit = "1" if symbol == "1" else known.of(symbol) if known else ""
        if unit:
            v.attrs["units"] = unit
        elif "febio_name" in v.attrs:
            v.attrs.pop("units", None)


def variable_name(name: str) -> str:
    """FEBio's name, or its alias after "=", as a Python and NetCDF name."""
    return re.sub(r"\W+", "_", name.split("=")[-1].strip()).strip("_") or "unnamed"


def _free(name: str, section: str, taken: set[Any]) -> str:
    if name not in taken:
        return name
    tries = (f"{name}_{section}", *(f"{name}_{section}_{i}" for i in range(2, len(taken) + 3)))
    return next(t for t in tries if t not in taken)


def _attrs(f: PlotFile, v: PlotVariable, index: int, field: Field) -> dict[str, Any]:
    out: dict[str, Any] = {
        "febio_name": v.name, "febio_section": v.section, "febio_type": v.type, "febio_format": v.format,
        "febio_index": index,
    }
    if v.n:
        out["febio_array_size"] = v.n
    if v.array_names:
        out["febio_array_names"] = list(v.array_names)
    if v.units:
        out["febio_units"] = v.units
    with_data = field.regions_with_data() if len(field.states) else []
    if v.section not in ("node", "global") and with_data:
        out["febio_regions"] = with_data
    return out


def _dims(
    v: PlotVariable, name: str, apart: bool, known: Mapping[Hashable, Any]
) -> tuple[tuple[str, ...], dict[str, xr.Variable]]:
    """Dimensions after time, and coordinates that these bring; ``known`` are those of the variables before."""
    lead = _LEADS[v.section, v.format]
    if apart and (v.section, v.format) == ("domain", "node"):
        lead = ("domain_node",)
    dim, labels = components(v)
    if dim:
        return (*lead, dim), {dim: xr.Variable((dim,), list(labels))}
    kind = species(v)
    if v.type == "array vec3f" or (v.type == "array" and (v.n > 1 or kind)):
        own = kind or f"{name}_item"
        names = list(v.array_names) if len(v.array_names) == v.n else []
        if kind and not names:
            names = [f"{kind.replace('_', ' ')} {k}" for k in range(1, v.n + 1)]
        if kind and kind in known and list(known[kind].values) != names:  # of another model: not the same species
            own = f"{name}_item"
        extra = {own: xr.Variable((own,), names)} if names else {}
        if v.type == "array vec3f":
            extra["xyz"] = xr.Variable(("xyz",), ["x", "y", "z"])
            return (*lead, own, "xyz"), extra
        return (*lead, own), extra
    return lead, {}


_LEADS: dict[tuple[str, str], tuple[str, ...]] = {
    **{("node", k): ("node",) for k in ("node", "item", "mult", "region")},
    **{("global", k): () for k in ("node", "item", "mult", "region")},
    ("domain", "node"): ("node",), ("domain", "item"): ("element",),
    ("domain", "mult"): ("element", "local"), ("domain", "region"): ("domain",),
    ("surface", "node"): ("surface_node",), ("surface", "item"): ("facet",),
    ("surface", "mult"): ("facet", "facet_local"), ("surface", "region"): ("surface",),
    ("edge", "node"): ("edge_node",), ("edge", "item"): ("edge_line",),
    ("edge", "mult"): ("edge_line", "edge_local"), ("edge", "region"): ("edge",),
}


def short_times(times: np.ndarray) -> np.ndarray:
    """float64 times with the fewest digits that give the file's float32: 0.1, not 0.10000000149."""
    return np.array([float(str(t)) for t in times.astype(np.float32)], np.float64)


def _coords(f: PlotFile, mesh: int, states: np.ndarray) -> tuple[dict[Hashable, Any], dict[str, Any]]:
    o = f.outline(mesh)
    names, sizes = o.part_names, [d.count for d in o.domains]
    types = list(dict.fromkeys(d.type for d in o.domains))
    kinds = np.array([types.index(d.type) for d in o.domains], np.int32)
    n, e = o.n_nodes, o.n_elements
    width = max((d.width for d in o.domains), default=0)

    def later(dims: tuple[str, ...], shape: tuple[int, ...], kind: str, make: Make) -> Any:
        return xr.Variable(dims, _held(f, MeshArray(shape, np.dtype(kind), make)))

    coords: dict[Hashable, Any] = {
        "time": xr.Variable(("time",), short_times(f.times[states])),
        "xyz": xr.Variable(("xyz",), ["x", "y", "z"]),
        "node": xr.Variable(("node",), f.node_ids(mesh), {"long_name": "id of the node"}),
        "element": xr.Variable(("element",), f.element_ids(mesh), {"long_name": "id of the element"}),
        "node_id": later(("node",), (n,), "i4", partial(_node_ids, f, mesh)),
        "X": later(("node", "xyz"), (n, 3), "f4", partial(_reference, f, mesh)),
        "element_id": later(("element",), (e,), "i4", partial(_element_ids, f, mesh)),
        "part": later(("element",), (e,), "i4", partial(np.repeat, np.arange(len(names)), sizes)),
        "element_type": later(("element",), (e,), "i4", partial(np.repeat, kinds, sizes)),
        "connectivity": later(("element", "local"), (e, width), "i4", partial(_connectivity, f, mesh)),
    }
    coords["X"].attrs["long_name"] = "reference coordinates"
    coords["part"].attrs |= flags(names)
    coords["element_type"].attrs |= flags(types)
    attrs: dict[str, Any] = {"febio_version": f.version, "febio_compression": f.header.compression}
    for key, value in (
        ("parts", names), ("element_types", types), ("part_materials", [d.part_id for d in o.domains]),
        ("part_sizes", sizes), ("part_named", [int(d.name is not None) for d in o.domains]),
        ("materials", [n for _, n in o.parts]), ("material_ids", [i for i, _ in o.parts]),
        ("software", f.header.software), ("author", f.header.author),
    ):
        if value:
            attrs[key] = value
    return coords, attrs


def flags(meanings: Sequence[str]) -> dict[str, Any]:
    """Attributes that say what the codes 0, 1, ... of a variable mean, by the CF conventions."""
    words = [re.sub(r"\s+", "_", m) for m in meanings]
    return {"flag_values": list(range(len(words))), "flag_meanings": " ".join(words)}


# functions by name, so that lazy arrays travel to dask's workers
def _node_ids(f: PlotFile, mesh: int) -> np.ndarray:
    return f.mesh(mesh).node_ids


def _reference(f: PlotFile, mesh: int) -> np.ndarray:
    return f.mesh(mesh).X


def _element_ids(f: PlotFile, mesh: int) -> np.ndarray:
    return f.mesh(mesh).element_ids()


def _connectivity(f: PlotFile, mesh: int) -> np.ndarray:
    return f.mesh(mesh).connectivity()


def _sets(m: MeshOutline) -> dict[Hashable, Any]:
    """Sets, one after the other in one array each; names and sizes in its attributes."""
    out: dict[Hashable, Any] = {}
    for key, sets in (("node_set", m.node_sets), ("element_set", m.element_sets)):
        if sets:
            members = [np.asarray(v, np.int32) for v in sets.values()]
            attrs = {"names": list(sets), "sizes": [len(a) for a in members]}
            out[f"{key}_members"] = xr.Variable((f"{key}_entry",), np.concatenate(members), attrs)
    lists: tuple[tuple[str, Sequence[PlotSurface], tuple[str, str]], ...] = (
        ("facets", m.surfaces, ("facet", "facet_local")),
        ("facet_set_facets", m.facet_sets or (), ("facet_set_facet", "facet_set_local")),
        ("edge_lines", m.edges, ("edge_line", "edge_local")),
    )
    for key, surfaces, dims in lists:
        if surfaces:
            out[key] = _facet_array(surfaces, dims)
    if m.facet_sets is not None and not m.facet_sets and m.surfaces:
        out["facets"].attrs["no_facet_sets"] = 1
    if m.objects:  # read by febkit.results.objects
        out["objects"] = xr.Variable(("object_byte",), np.frombuffer(m.objects, np.uint8))
    return out


def _facet_array(surfaces: Sequence[PlotSurface], dims: tuple[str, str]) -> xr.Variable:
    rows = [s.rows() for s in surfaces]
    width = max(r.shape[1] for r in rows)
    wide = [np.pad(r, ((0, 0), (0, width - r.shape[1])), constant_values=-1) for r in rows]
    attrs = {
        "names": [s.name for s in surfaces],
        "sizes": [len(r) for r in rows],
        "widths": [r.shape[1] for r in rows],
    }
    return xr.Variable(dims, np.concatenate(wide).astype(np.int32), attrs)


def _shared(f: PlotFile, p: Places, apart: bool) -> dict[Hashable, Any]:
    """Node indices behind the dimensions that list a region's nodes, where a variable uses them."""
    out: dict[Hashable, Any] = {}
    kinds = {(v.section, v.format) for v in f.variables}
    for section, used in (("domain", apart), ("surface", True), ("edge", True)):
        if used and (section, "node") in kinds:
            nodes = [p.nodes(section, i) for i in range(p.count(section))]
            flat = np.concatenate(nodes).astype(np.int32) if nodes else np.empty(0, np.int32)
            out[f"{section}_node_index"] = xr.Variable((f"{section}_node",), flat)
    return out


_ACTIVE = {"long_name": "state of the element", "flag_masks": [1], "flag_meanings": "active"}


def _states(f: PlotFile, states: np.ndarray, o: MeshOutline, data: dict[Hashable, xr.Variable]) -> None:
    """Status of each state and flags of the elements, where the file has them."""
    if not len(states):
        return
    layout = f.layout(int(states[0]))
    if layout.status >= 0:
        meaning = {"long_name": "how the step ended"} | flags(["converged", "new_mesh", "not_converged"])
        data["state_status"] = xr.Variable(("time",), f.statuses[states], meaning)
    if layout.flags is not None:
        active = _held(f, FrameArray(ElementStates(f, states, o.n_elements), len(states)))
        data["element_state"] = xr.Variable(("time", "element"), active, _ACTIVE)
    if layout.objects is not None and o.objects:
        values = _held(f, FrameArray(ObjectStates(f, states, layout.objects[1]), len(states)))
        data["object_state"] = xr.Variable(("time", "object_state_byte"), values)
