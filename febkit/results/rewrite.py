"""Writes a dataset of results, or a plotfile that is already there, as a plotfile."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

import numpy as np

from febkit.files import keep_apart
from febkit.model import InputError

from . import mesh as meshes
from .fields import Places
from .xplt.reader import PlotFile
from .xplt.records import DomainHead, MeshOutline, PlotMesh, PlotVariable
from .xplt.writer import PlotWriter

if TYPE_CHECKING:
    import xarray as xr

Path = str | os.PathLike[str]


def write(
    ds: xr.Dataset, path: Path, *, version: int | None = None, compress: bool | None = None, overwrite: bool = True
) -> None:
    """Write a dataset of the shape ``febkit.results.open`` gives as a plotfile.

    Variables that FEBio has no storage for (other dimensions) are left out and named in a warning; new
    variables by node or element are stored as float, vec3f, mat3fs or mat3f by their component dimension.
    """
    m = meshes.plot_mesh(ds)
    variables, names, left = _dictionary(ds)
    if left:
        import warnings

        warnings.warn(f"a plotfile cannot hold {', '.join(left)}: left out", stacklevel=2)
    writer = PlotWriter(
        path,
        m,
        variables,
        version=_version(version or int(ds.attrs.get("febio_version", 0x35))),
        compress=bool(ds.attrs.get("febio_compression", 0)) if compress is None else compress,
        software=ds.attrs.get("software", "febkit"),
        units=ds.attrs.get("unit_system"),
        author=ds.attrs.get("author"),
        live=False,
        overwrite=overwrite,
    )
    places = Places(_outline(m), lambda: m)
    with writer:
        for t in range(ds.sizes["time"]):
            data = {i: _regions(ds[n], v, t, places) for i, (n, v) in enumerate(zip(names, variables))}
            writer.state(
                float(ds["time"].values[t]),
                {i: d for i, d in data.items() if d},
                int(ds["state_status"].values[t]) if "state_status" in ds else 0,
                ds["element_state"][t].values if "element_state" in ds else None,
                ds["object_state"].values[t].tobytes() if "object_state" in ds else b"",
            )


def copy(
    source: Path, target: Path, *, version: int | None = None, compress: bool | None = None, overwrite: bool = True
) -> None:
    """Rewrite a plotfile value for value, mesh changes included."""
    keep_apart([("plotfile", target, None)], [("plotfile", source, None)])
    with PlotFile(source) as f:
        h = f.header
        kept = [i for i, v in enumerate(f.variables) if v.section != "material"]
        with PlotWriter(
            target,
            f.mesh(0),
            [f.variables[i] for i in kept],
            version=_version(version or h.version),
            compress=bool(h.compression) if compress is None else compress,
            software=h.software or None,
            units=h.units,
            author=h.author or None,
            live=False,
            overwrite=overwrite,
        ) as w:
            current = 0
            for t, s in enumerate(f.states):
                if max(s.mesh, 0) != current:
                    current = s.mesh
                    w.mesh(f.mesh(current))
                data: dict[str | int, Any] = {}
                for k, i in enumerate(kept):
                    found = dict(f.regions(i, t))
                    if found:
                        data[k] = found
                flags = _flags(f, t)
                try:
                    w.state(f.time(t), data, f.status(t), flags, f.objects(t))
                except ValueError as e:  # surfaces may be padded beyond their mesh; what is written may not
                    raise InputError(f"damaged state at t = {f.time(t):g}: {e}", f.container.where) from None


def _flags(f: PlotFile, t: int) -> np.ndarray | None:
    """Flags of the elements as the file has them: one each, or none at all."""
    flags = f.element_state(t)
    n = f.outline(max(f.states[t].mesh, 0)).n_elements
    if flags is not None and len(flags) not in (0, n):
        raise InputError(f"damaged state: flags of {len(flags)} elements where the mesh has {n}", f.container.where)
    return flags


def _outline(m: PlotMesh) -> MeshOutline:
    heads = [DomainHead(d.type, d.part_id, d.name, len(d.element_ids)) for d in m.domains]
    sets = (m.surfaces, m.node_sets, m.element_sets, m.parts, m.facet_sets, m.edges)
    return MeshOutline(len(m.node_ids), heads, *sets, m.objects)


def _version(v: int) -> int:
    """Versions below 0x30 are written as 0x35."""
    return v if 0x30 <= v <= 0x35 else 0x35


_TYPES = {(): "float", ("xyz",): "vec3f", ("voigt",): "mat3fs", ("principal",): "mat3fd",
          ("tensor",): "mat3f", ("voigt4",): "tens4fs"}
_NEW = {("node",): ("node", "node"), ("element",): ("domain", "item"), ("domain",): ("domain", "region"),
        ("element", "local"): ("domain", "mult"), ("facet",): ("surface", "item"), (): ("global", "region")}
_STATE_DATA = {"state_status", "element_state", "object_state"}


def _dictionary(ds: xr.Dataset) -> tuple[list[PlotVariable], list[str], list[str]]:
    """The variables a plotfile can hold, in the file's order, and those it cannot."""
    found: list[tuple[int, PlotVariable, str]] = []
    left = []
    for key in ds.data_vars:
        name = str(key)
        if name in _STATE_DATA:
            continue
        v = _variable(ds[name], name)
        if v is None:
            left.append(name)
        else:
            found.append((int(ds[name].attrs.get("febio_index", 1 << 30)), v, name))
    found.sort(key=lambda f: f[0])
    return [v for _, v, _ in found], [n for _, _, n in found], left


def _variable(a: xr.DataArray, name: str) -> PlotVariable | None:
    known = a.attrs.get("febio_type")
    if known is not None:
        return PlotVariable(
            a.attrs["febio_name"], a.attrs["febio_section"], known, a.attrs["febio_format"],
            int(a.attrs.get("febio_array_size", 0)), a.attrs.get("febio_units"),
            tuple(meshes.texts(a, "febio_array_names")),
        )
    dims = tuple(str(d) for d in a.dims)
    if not dims or dims[0] != "time" or a.dtype.kind not in "fiu":
        return None
    if dims[-1] in ("solute", "solid_bound") and dims[1:-1] in _NEW:
        names = tuple(str(n) for n in a[dims[-1]].values) if dims[-1] in a.coords else ()
        return PlotVariable(name.replace("_", " "), *_of(dims[1:-1], "array"), a.sizes[dims[-1]], None, names)
    component = tuple(d for d in dims[1:] if (d,) in _TYPES)
    lead = dims[1 : len(dims) - len(component)]
    if component not in _TYPES or lead not in _NEW:
        return None
    return PlotVariable(name.replace("_", " "), *_of(lead, _TYPES[component]))


def _of(lead: tuple[str, ...], kind: str) -> tuple[str, str, str]:
    """Section, type and format of a variable with these leading dimensions."""
    section, fmt = _NEW[lead]
    return section, kind, fmt


def _regions(a: xr.DataArray, v: PlotVariable, t: int, p: Places) -> dict[int, np.ndarray]:
    """The regions of one state; a region without a single number is left out."""
    values = np.asarray(a[t].values, np.float32)
    if v.section in ("node", "global"):
        return {} if values.size and np.isnan(values).all() else {0: values}
    listed = meshes.numbers(a, "febio_regions")
    out = {}
    for i in range(p.count(v.section)):
        part = _region(values, v, i, p, "domain_node" in a.dims)
        if part.size and not np.isnan(part).all() and (not listed or i + 1 in listed or t):
            out[i + 1] = part
    return out


def _region(values: np.ndarray, v: PlotVariable, i: int, p: Places, apart: bool) -> np.ndarray:
    if v.format == "region":
        return np.asarray(values[i])
    if v.format == "node":
        at = p.nodes("domain", i) if v.section == "domain" and not apart else p.region_nodes(v.section)[i]
        return np.asarray(values[at])
    rows = np.asarray(values[p.items(v.section)[i]])
    if v.format == "item":
        return rows
    if v.section == "domain":
        return rows[:, : p.local("domain", i)]
    nodes = p.surfaces(v.section)[i].rows()
    own: np.ndarray = rows[:, : nodes.shape[1]].copy()
    own[nodes < 0] = 0  # FEBio pads facets with zeros
    return own
