"""Results as a series for ParaView: one .vtu per state and a .pvd that lists them with their times."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.sax.saxutils import quoteattr

import numpy as np

from febkit.files import may_write, put, written
from febkit.model import InputError, Where

from . import mesh as meshes
from .cells import KEPT, MESHIO, ORDER, SURFACE_TYPES

if TYPE_CHECKING:
    import meshio
    import xarray as xr

Path_ = str | os.PathLike[str]
_NOT_FIELDS = {"state_status", "object_state"}


def write_series(
    datasets: Sequence[xr.Dataset] | xr.Dataset,
    path: Path_,
    *,
    variables: Sequence[str] | None = None,
    deformed: bool = False,
    progress: Callable[[int, int], None] | None = None,
    overwrite: bool = True,
) -> list[Path]:
    """Write every state of one dataset, or of one per mesh, beside ``path`` (.pvd or .vtu).

    Points are reference coordinates, or current ones where ``deformed``. Nodal values become point data;
    element values cell data; values at the nodes of elements their mean by element; one value per domain
    is repeated on its elements. Surfaces with data make a second file per state, part 1 of the series. Each file is
    written whole or not at all, the list of them at the end. Raises InputError where there is a file of one of their
    names and ``overwrite`` is False.
    """
    many = [datasets] if not isinstance(datasets, Sequence) else list(datasets)
    path = Path(path)
    if path.suffix.lower() not in (".pvd", ".vtu"):
        raise InputError("a series for ParaView ends in .pvd or .vtu", Where(str(path)))
    n = sum(ds.sizes["time"] for ds in many)
    digits = max(4, len(str(n)))
    for name in (f"{path.stem}.pvd", *(f"{path.stem}_{k:0{digits}d}.vtu" for k in range(n))):
        may_write(path.with_name(name), overwrite)
    entries: list[tuple[float, int, Path]] = []
    k = 0
    for ds in many:
        plan = Plan(ds, variables, deformed)
        for t in range(ds.sizes["time"]):
            time = float(ds["time"].values[t])
            for part, m in enumerate(plan.state(t)):
                tail = f"_{k:0{digits}d}" + ("_surfaces" if part else "")
                file = path.with_name(path.stem + tail + ".vtu")
                # plain binary: as small as the floats are, and several times faster than packed
                with written(file, overwrite) as whole:
                    m.write(whole, file_format="vtu", compression=None)
                entries.append((time, part, file))
            k += 1
            if progress:
                progress(k, n)
    put(path.with_suffix(".pvd"), _pvd(entries).encode(), overwrite)
    return [path.with_suffix(".pvd"), *(f for _, _, f in entries)]


def _pvd(entries: Sequence[tuple[float, int, Path]]) -> str:
    rows = [
        f'    <DataSet timestep="{time!r}" part="{part}" file={quoteattr(file.name)}/>'
        for time, part, file in entries
    ]
    text = ['<?xml version="1.0"?>', '<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">',
            "  <Collection>", *rows, "  </Collection>", "</VTKFile>", ""]
    return "\n".join(text)


class Plan:
    """What does not change from state to state: cells, ids, which variables go where."""

    def __init__(self, ds: xr.Dataset, variables: Sequence[str] | None, deformed: bool) -> None:
        self.ds = ds
        self.X = ds["X"].values.astype(np.float32)
        self.cells, self.rows = cells(ds)
        names = [str(n) for n in ds.data_vars if str(n) not in _NOT_FIELDS]
        if variables is not None:
            missing = [v for v in variables if v not in names]
            if missing:
                raise InputError(f"no variable {missing[0]!r}; there are {', '.join(names)}")
            names = list(variables)
        dims = {n: ds[n].dims[1:2] for n in names if ds[n].dims[:1] == ("time",)}
        self.nodal = [n for n, d in dims.items() if d == ("node",)]
        self.element = [n for n, d in dims.items() if d in (("element",), ("domain",))]
        self.facet = [n for n, d in dims.items() if d in (("facet",), ("surface",))]
        self.deformed = deformed and "displacement" in ds
        self.part = ds["part"].values
        self.fixed_cell = {"element_id": ds["element_id"].values, "part": self.part}
        self.surfaces = _surface_cells(ds) if self.facet else None

    def state(self, t: int) -> list[meshio.Mesh]:
        """The mesh of one state, and that of its surfaces where they have data."""
        import meshio

        X = self.X
        if self.deformed:
            X = X + self.ds["displacement"][t].values
        point = {n: _table(self.ds[n][t].values) for n in self.nodal}
        cell: dict[str, np.ndarray] = dict(self.fixed_cell)
        cell |= {n: self._by_element(n, t) for n in self.element}
        split = {n: [a[r] for r in self.rows] for n, a in cell.items()}
        point["node_id"] = self.ds["node_id"].values
        out = [meshio.Mesh(X, self.cells, point_data=point, cell_data=split)]
        if self.surfaces is not None:
            blocks, rows, owner = self.surfaces
            data = {"surface": owner, **{n: self._by_facet(n, t, owner) for n in self.facet}}
            out.append(
                meshio.Mesh(X, blocks, cell_data={n: [a[r] for r in rows] for n, a in data.items()})
            )
        return out

    def _by_element(self, name: str, t: int) -> np.ndarray:
        a = self.ds[name][t]
        if a.dims[0] == "domain":
            return _table(a.values[self.part])
        if "local" in a.dims:
            return _table(meshes.local_mean(a.values).astype(np.float32))
        return _table(a.values)

    def _by_facet(self, name: str, t: int, owner: np.ndarray) -> np.ndarray:
        a = self.ds[name][t]
        if a.dims[0] == "surface":
            return _table(a.values[owner])
        if "facet_local" in a.dims:
            valid = self.ds["facets"].values >= 0
            values = a.values
            values = np.where(valid.reshape(valid.shape + (1,) * (values.ndim - 2)), values, np.nan)
            return _table(meshes.local_mean(values).astype(np.float32))
        return _table(a.values)


def _table(a: np.ndarray) -> np.ndarray:
    """(item,) or (item, component)."""
    return a if a.ndim < 3 else a.reshape(len(a), -1)


def cells(ds: xr.Dataset) -> tuple[list[tuple[str, np.ndarray]], list[slice]]:
    """meshio's cell blocks of a dataset and the elements each holds."""
    out, rows = [], []
    for b in meshes.of(ds).blocks:
        conn = b.conn[:, : KEPT.get(b.type, b.conn.shape[1])]
        order = ORDER.get(b.type)
        out.append((MESHIO[b.type], conn[:, order] if order else conn))
        rows.append(b.where)
    return out, rows


Facets = tuple[list[tuple[str, np.ndarray]], list[np.ndarray], np.ndarray]


def _surface_cells(ds: xr.Dataset) -> Facets | None:
    """Facets of all surfaces by type, the rows of each, and the surface of each facet."""
    if "facets" not in ds:
        return None
    v: Any = ds["facets"]
    owner = np.repeat(np.arange(len(meshes.texts(v, "names"))), meshes.numbers(v, "sizes"))
    facets = v.values
    counts = (facets >= 0).sum(axis=1)
    blocks, rows = [], []
    for n in np.unique(counts):
        if n in SURFACE_TYPES:
            at = np.flatnonzero(counts == n)
            blocks.append((MESHIO[SURFACE_TYPES[n]], facets[at, :n]))
            rows.append(at)
    return blocks, rows, owner
