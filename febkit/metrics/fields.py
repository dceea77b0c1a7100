"""Strain, stress and flux of every element, and the loop over time that cells are measured in."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from . import groups as grouping
from . import tensors
from .kinematics import Group, State
from .scale import Scale, unit_system
from .selection import Cells, select_cells
from .sources import Sources

if TYPE_CHECKING:
    import xarray as xr

    from febkit.model import Model

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# name -> unit kind, formula
FIELDS = {
    "volume": ("volume", "sum over integration points of w det(dx/dr)"),
    "effective_strain": ("", "sqrt(((E1-E2)^2 + (E2-E3)^2 + (E3-E1)^2)/2), mean over integration points"),
    "effective_stress": (
        "stress",
        "sqrt(((s1-s2)^2 + (s2-s3)^2 + (s3-s1)^2)/2), mean over integration points",
    ),
    "max_shear_strain": ("", "max |Ei - Ej| of the Green-Lagrange strain, mean over the integration points"),
    "principal_strain": ("", "principal values of the element's mean Green-Lagrange strain, largest first"),
    "principal_stress": ("stress", "principal values of the element's mean Cauchy stress, largest first"),
    "fluid_flux": ("flux", "-K grad p, mean over the integration points"),
}
COMPONENTS = ("principal_strain", "principal_stress", "fluid_flux")  # not scalar
SCALARS = ("effective_strain", "effective_stress", "max_shear_strain")


@dataclass(slots=True, eq=False)
class Sweep:
    """Visits every group at every time; computes an element value only once it is asked for."""

    ds: xr.Dataset
    groups: list[Group]
    sources: Sources
    gradients: bool = False
    _stress: dict[int, object] = field(default_factory=dict)

    def __iter__(self) -> Iterator[tuple[int, list[State]]]:
        for t in range(self.ds.sizes["time"]):
            u = self.sources.displacement(t)
            yield t, [g.at(u, self.gradients) for g in self.groups]

    def scalars(
        self, k: int, group: Group, state: State, t: int, wanted: Sequence[str] = SCALARS
    ) -> dict[str, Floats]:
        """Element values (e,) of those of :data:`SCALARS` that are wanted; stress left out where there is no source."""
        out: dict[str, Floats] = {}
        strains = {"effective_strain": tensors.effective, "max_shear_strain": tensors.max_difference}
        if any(n in wanted for n in strains):
            E = tensors.green_lagrange(state.F)
            out = {n: group.mean(scalar(E)) for n, scalar in strains.items() if n in wanted}
        if "effective_stress" not in wanted:
            return out
        if k not in self._stress:
            self._stress[k] = self.sources.effective_stress(group)
        law = self._stress[k]
        if law is not None:
            out["effective_stress"] = law(state, t)  # type: ignore[operator]
        return out


def element_fields(
    ds: xr.Dataset, where: Cells = None, model: Model | None = None, names: Sequence[str] | None = None
) -> xr.Dataset:
    """Element fields (time, element[, component]) of parts, sets or cells: see :data:`FIELDS`.

    ``where`` selects elements as ``cells`` of :func:`febkit.metrics.cell_metrics` does ("*" for all). Fields
    that lack a source are left out; ``attrs["how"]`` of each says how it was got. Units as those of cell_metrics:
    kPa, um^3 and um/s where the unit system is known.
    """
    names = tuple(names or FIELDS)
    pick = select_cells(ds, where, split=False)
    order = np.argsort(pick.rows)
    rows, owner = pick.rows[order], pick.owner[order]
    sources = Sources(ds, model)
    groups = grouping.make(ds, rows, owner, sources.parts or None)
    want_flux = "fluid_flux" in names
    sweep = Sweep(ds, groups, sources, gradients=want_flux)
    store = _Store(ds.sizes["time"], rows)
    flux = [sources.element_flux(g) if want_flux else None for g in groups]
    stress = [sources.mean_stress(g) if "principal_stress" in names else None for g in groups]
    for t, states in sweep:
        for k, (g, s) in enumerate(zip(groups, states)):
            values = sweep.scalars(k, g, s, t, names)
            if "volume" in names:
                values["volume"] = s.volume
            if "principal_strain" in names:
                values["principal_strain"] = tensors.principal(g.mean(tensors.green_lagrange(s.F)))
            for name, law in (("fluid_flux", flux[k]), ("principal_stress", stress[k])):
                if law is not None:
                    values[name] = law(s, t)
            if "principal_stress" in values:
                values["principal_stress"] = tensors.principal(values["principal_stress"])
            store.put(t, g.rows, values)
    return _dataset(ds, store, sources, Scale(unit_system(ds, model)))


class _Store:
    """Arrays (time, element[, component]) filled group by group."""

    def __init__(self, times: int, rows: Ints) -> None:
        self.rows, self.times = rows, times
        self.arrays: dict[str, Floats] = {}

    def put(self, t: int, rows: Ints, values: dict[str, Floats]) -> None:
        at = np.searchsorted(self.rows, rows)
        for name, v in values.items():
            if name not in self.arrays:
                self.arrays[name] = np.full((self.times, len(self.rows), *v.shape[:-1]), np.nan)
            self.arrays[name][t, at] = v.T


def _dataset(ds: xr.Dataset, store: _Store, sources: Sources, scale: Scale) -> xr.Dataset:
    import xarray as xr

    dims = {"principal_strain": ("principal",), "principal_stress": ("principal",), "fluid_flux": ("xyz",)}
    data = {}
    for name, values in store.arrays.items():
        kind, formula = FIELDS[name]
        attrs = {**scale.attrs(kind), "formula": formula}
        how = sources.notes.of(name)
        if how:
            attrs["how"] = how
        data[name] = (("time", "element", *dims.get(name, ())), values * scale.by(kind), attrs)
    coords: dict[str, object] = {"time": ds["time"], "element_row": ("element", store.rows)}
    if "element_id" in ds.variables:
        coords["element_id"] = ("element", np.asarray(ds["element_id"].values)[store.rows])
        coords["element"] = coords["element_id"]
    if "fluid_flux" in data:
        coords["xyz"] = ["x", "y", "z"]
    return xr.Dataset(data, coords=coords, attrs={"unit_system": scale.system.name} if scale.system else {})
