"""``ds.febkit``: what one asks of a result, in one line each."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from febkit.model import InputError

from . import subsets

if TYPE_CHECKING:
    import meshio

_REACTION = "reaction_forces"


@xr.register_dataset_accessor("febkit")  # type: ignore[no-untyped-call,unused-ignore]
class Results:
    """Questions to a dataset of :func:`febkit.open_results`. Names and ids are the file's, units the variable's."""

    def __init__(self, ds: xr.Dataset) -> None:
        self._ds = ds

    def part(self, name: str) -> xr.Dataset:
        """Elements and nodes of a part or element set, and all that the result holds of them."""
        from febkit.metrics.selection import part_rows

        return subsets.elements_of(self._ds, part_rows(self._ds, name))

    def node_set(self, name: str) -> xr.Dataset:
        """Nodal variables at the nodes of a node set or surface."""
        return subsets.nodes_of(self._ds, subsets.node_set(self._ds, name))

    def surface(self, name: str) -> xr.Dataset:
        """Facets and nodes of a surface, and the variables there."""
        return subsets.surface(self._ds, name)

    def node(self, number: int) -> xr.Dataset:
        """Nodal variables at FEBio's node of this id."""
        return subsets.nodes_of(self._ds, self._row("node", number)).squeeze("node")

    def element(self, number: int) -> xr.Dataset:
        """Variables of FEBio's element of this id."""
        row = self._row("element", number)
        return subsets.elements_of(self._ds, row).squeeze("element")

    def _row(self, kind: str, number: int) -> np.ndarray:
        ids = self._ds[f"{kind}_id"].values
        rows = np.flatnonzero(ids == number)
        if not len(rows):
            span = f": ids are {ids.min()} to {ids.max()}" if len(ids) else ""
            raise InputError(f"there is no {kind} {number}{span}")
        return rows[:1]

    def reaction(self, name: str) -> xr.DataArray:
        """(time, xyz) force that supports put on a node set or surface, or the force on a rigid part.

        It is minus the sum of the plotfile's reaction forces. Raises InputError where it has none.
        """
        ds = self._ds
        from .mesh import texts

        parts = texts(ds, "parts")
        if name in parts and "rigid_force" in ds:
            return ds["rigid_force"].isel(domain=parts.index(name))
        if _REACTION not in ds:
            raise InputError('the result has no reaction forces: add <var type="reaction forces"/> to its plotfile')
        rows = subsets.node_set(ds, name)
        out = -ds[_REACTION].isel(node=rows).astype(float).sum("node")
        return out.assign_attrs(ds[_REACTION].attrs | {"long_name": f"reaction force of {name}"})

    def principal(self, variable: str) -> xr.DataArray:
        """Principal values of a symmetric tensor, largest first, along ``principal`` 1, 2, 3."""
        from febkit.metrics.tensors import principal

        v, values = self._tensor(variable)
        dims = tuple(d for d in v.dims if d != "voigt")
        coords = _coords(v, dims) | {"principal": [1, 2, 3]}
        out = xr.DataArray(np.moveaxis(principal(values), 0, -1), coords, (*dims, "principal"), f"{variable}_principal")
        return out.assign_attrs(_kept(v, f"principal values of {variable}"))

    def von_mises(self, variable: str = "stress") -> xr.DataArray:
        """sqrt(((l1-l2)^2 + (l2-l3)^2 + (l3-l1)^2)/2) of a symmetric tensor."""
        from febkit.metrics.tensors import effective

        v, values = self._tensor(variable)
        dims = tuple(d for d in v.dims if d != "voigt")
        out = xr.DataArray(effective(values), dims=dims, name=f"{variable}_von_mises", coords=_coords(v, dims))
        return out.assign_attrs(_kept(v, f"von Mises value of {variable}"))

    def _tensor(self, variable: str) -> tuple[xr.DataArray, np.ndarray]:
        v = self._variable(variable)
        if "voigt" not in v.dims:
            tensors = [str(n) for n, x in self._ds.data_vars.items() if "voigt" in x.dims]
            say = f"{variable!r} is no symmetric tensor; those of this result: {', '.join(tensors) or 'none'}"
            raise InputError(say)
        return v, np.moveaxis(np.asarray(v.values, dtype=float), v.dims.index("voigt"), 0)

    def _variable(self, name: str) -> xr.DataArray:
        from .dataset import variable_name

        for key in (name, variable_name(name)):
            if key in self._ds.data_vars:
                return self._ds[key]
        raise InputError(f"the result has no {name!r}; it has {', '.join(map(str, self._ds.data_vars))}")

    def mean(self, variable: str, part: str | None = None) -> xr.DataArray:
        """(time[, component]) mean over the elements of a part or element set (all by default), weighted by their
        deformed volumes, of a variable ("stress", "stress:first") or an element field of :data:`febkit.metrics.FIELDS`,
        which needs displacements alone ("principal_strain:first")."""
        from febkit.metrics.summary import mean

        ds, scalar = self._of_elements(variable, part)
        return mean(ds, scalar, part)

    def quantile(self, variable: str, q: float | Sequence[float], part: str | None = None) -> xr.DataArray:
        """(time[, quantile]) quantiles over the elements of a part or element set (all by default), weighted by their
        deformed volumes, of a scalar or of a component: "stress:effective", "fluid_flux:z", "effective_strain"."""
        from febkit.metrics.summary import summary

        many = np.atleast_1d(np.asarray(q, dtype=float))
        if not ((many >= 0) & (many <= 1)).all():
            raise InputError(f"quantiles lie between 0 and 1, not at {q}")
        ds, scalar = self._of_elements(variable, part)
        found = summary(ds, scalar, [part or ""], many)
        out = found["quantiles"].isel(part=0, drop=True)
        return out if np.ndim(q) else out.isel(quantile=0)

    def _of_elements(self, variable: str, part: str | None) -> tuple[xr.Dataset, str]:
        """A dataset that holds the variable or element field that ``variable`` names, and its name there."""
        from febkit.metrics import FIELDS, element_fields
        from febkit.metrics.selection import part_rows

        head, colon, word = variable.partition(":")
        name, ds = head.strip().replace(" ", "_"), self._ds
        if name not in FIELDS or name in ds.data_vars:
            return ds, f"{self._variable(head).name}{colon}{word}"
        rows = part_rows(ds, part) if part else np.arange(ds.sizes["element"])
        found = element_fields(ds, {"asked": np.unique(rows)}, None, [name])
        if name not in found:
            raise InputError(f"{name} cannot be had from this result without its model: febkit.metrics.element_fields")
        v, rows = found[name], found["element_row"].values
        values = np.full((v.shape[0], ds.sizes["element"], *v.shape[2:]), np.nan)
        values[:, rows] = v.values
        labels = {"principal": ["first", "second", "third"]} if "principal" in v.dims else {}
        return ds.assign({name: (v.dims, values, v.attrs)}).assign_coords(labels), f"{name}{colon}{word}"

    def probe(self, points: Any, variables: Sequence[str] | None = None) -> xr.Dataset:
        """(time, point[, component]) values at points (m, 3) of the reference configuration: nodal variables by the
        shape functions of the element that holds the point, element variables of that element.

        Raises InputError that names the points outside.
        """
        from .probe import probe

        names = None if variables is None else [str(self._variable(v).name) for v in variables]
        return probe(self._ds, points, names)

    def deformed(self, time: float | None = None) -> xr.DataArray:
        """(node, xyz) positions at a time, the last by default."""
        ds = self._ds
        if "displacement" not in ds:
            raise InputError("the result has no displacement")
        x = ds["X"].astype(float) + ds["displacement"].isel(time=self._state(time)).astype(float)
        return x.rename("x").assign_attrs(ds["X"].attrs | {"long_name": "current coordinates"})

    def _state(self, time: float | None) -> int:
        """The state at a time, to single precision; the last where none is named."""
        t = np.asarray(self._ds["time"].values, dtype=float)
        return subsets.state_at(t, time, 1e-6, float(np.abs(t).max(initial=0.0)))

    def to_meshio(self, time: float | None = None, *, deformed: bool = False) -> meshio.Mesh:
        """The state at a time (the last by default) with its nodal and element data."""
        from .vtk import Plan

        return Plan(self._ds, None, deformed).state(self._state(time))[0]

    def to_pyvista(self, time: float | None = None, *, deformed: bool = False) -> Any:
        """The same as a pyvista.UnstructuredGrid (needs febkit[scenes])."""
        try:
            from pyvista import from_meshio  # type: ignore[attr-defined,unused-ignore]
        except ImportError:
            raise InputError('grids of pyvista need it: pip install "febkit[scenes]"') from None
        return from_meshio(self.to_meshio(time, deformed=deformed))

    def view(self, variable: str | None = None, **options: Any) -> Any:
        """A viewer in the browser, or in a notebook's cell: see :func:`febkit.view` (needs febkit[viewer])."""
        from importlib import import_module

        # by name, as febkit's lazy names are: the viewer stands above results
        return import_module("febkit.viewer").view(self._ds, variable, **options)

    def write_vtk(
        self, path: str | os.PathLike[str], *, variables: Sequence[str] | None = None, deformed: bool = False
    ) -> list[Path]:
        """All states as a series for ParaView, ``path`` its .pvd; the files written."""
        from .vtk import write_series

        names = None if variables is None else [str(self._variable(v).name) for v in variables]
        return write_series(self._ds, path, variables=names, deformed=deformed)


def _coords(v: xr.DataArray, dims: tuple[Any, ...]) -> dict[Any, Any]:
    """Coordinates of a variable that live on these dimensions."""
    return {k: c for k, c in v.coords.items() if set(c.dims) <= set(dims)}


def _kept(v: xr.DataArray, long_name: str) -> dict[str, Any]:
    return {"long_name": long_name} | {k: v.attrs[k] for k in ("units",) if k in v.attrs}
