"""Where stress and fluid flux come from: the plotfile, or the model's materials."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from numpy.typing import NDArray

from febkit.model import InputError, UnsupportedError, as_record

from . import behind, materials, mixtures, tensors
from .flux import darcy
from .kinematics import Group, State
from .solver_laws import SolverLaws

if TYPE_CHECKING:
    import xarray as xr

    from febkit.model import Component, Model

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
MIXED = (
    "fluid flux of the mixture at the integration points, from displacement, effective fluid pressure and effective "
    "concentrations"
)
# nodal variables, and what they are called at the back of shells
BACK = {
    "effective_fluid_pressure": "effective_shell_fluid_pressure",
    "effective_solute_concentration": "effective_shell_solute_concentration",
}
# effective stress (e,), or mean stress (6, e), of a group's elements at a state, time index
T = TypeVar("T")
EffectiveStress = Callable[[State, int], Floats]
# element-node flux (3, n, e) of a group at a state, time index
NodalFlux = Callable[[State, int], Floats]
# flux (3, g, e), and solvent supply (g, e), at a group's integration points
PointFlux = Callable[[State, int], Floats]
PointSupply = Callable[[State, int], Floats]


@dataclass(slots=True)
class Provenance:
    """Sentences for the user: how each thing was got, and what was missing."""

    notes: dict[str, set[str]] = field(default_factory=dict)

    def add(self, what: str, how: str) -> None:
        self.notes.setdefault(what, set()).add(how)

    def of(self, what: str) -> str:
        return "; ".join(sorted(self.notes.get(what, set())))


@dataclass(slots=True, eq=False)
class Reader:
    """An element variable at the rows its groups need, read once for each time they are measured at."""

    variable: xr.DataArray
    rows: Ints = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    _t: int = field(default=-1, init=False)
    _values: Floats = field(init=False)

    def of(self, rows: Ints) -> Callable[[int], Floats]:
        """(e, ...) values of these rows by index of time."""
        self.rows, self._t = np.union1d(self.rows, rows), -1
        return lambda t: self._at(t)[np.searchsorted(self.rows, rows)]

    def _at(self, t: int) -> Floats:
        if t != self._t:
            v = self.variable.isel(time=t, element=self.rows).values
            self._t, self._values = t, np.asarray(v, dtype=float)
        return self._values


@dataclass(slots=True, eq=False)
class Sources:
    """Chooses, for each group, the best source there is; ``notes`` tells which."""

    ds: xr.Dataset
    model: Model | None = None
    notes: Provenance = field(default_factory=Provenance)
    parts: dict[str, Component] = field(init=False)
    laws: SolverLaws | None = field(init=False)
    _behind: NDArray[np.bool_] | None = field(init=False)
    _readers: dict[str, Reader] = field(default_factory=dict, init=False)
    _frames: dict[str, tuple[int, Floats]] = field(default_factory=dict, init=False)

    def __post_init__(self) -> None:
        self.model = None if self.model is None else as_record(self.model)
        self.parts = materials.of_parts(self.model) if self.model is not None else {}
        self.laws = SolverLaws(self.model, self.ds) if self.model is not None else None
        self._behind = behind.back_nodes(self.ds)

    def displacement(self, t: int) -> Floats:
        """(N, 3) nodal displacements."""
        if "displacement" not in self.ds:
            raise InputError("the result holds no displacement: nothing can be measured without it")
        return self.nodal("displacement", t)

    def nodal(self, name: str, t: int) -> Floats:
        """(N, ...) nodal values; those of the last time are kept."""
        if name not in self._frames or self._frames[name][0] != t:
            self._frames[name] = t, np.asarray(self.ds[name][t].values, dtype=float)
        return self._frames[name][1]

    def at_nodes(self, name: str, group: Group, t: int) -> Floats:
        """(n, e, ...) nodal values of a group's elements; those behind a shell have what stands at its back."""
        v: Floats = self.nodal(name, t)[group.nodes]
        if self._behind is None or BACK.get(name) not in self.ds:
            return v
        at_back = self._behind[group.rows, : group.element.nodes].T
        if at_back.any():
            v[at_back] = self.nodal(BACK[name], t)[group.nodes[at_back]]
        return v

    def pressure(self, group: Group, t: int) -> Floats:
        """(n, e) effective fluid pressure at the nodes of a group's elements."""
        return self.at_nodes("effective_fluid_pressure", group, t)

    def _element(self, name: str, group: Group) -> Callable[[int], Floats]:
        """(e, ...) element values of a group by index of time."""
        return self._readers.setdefault(name, Reader(self.ds[name])).of(group.rows)

    def effective_stress(self, group: Group) -> EffectiveStress | None:
        """From the material at the integration points; else of the plotfile's element means."""
        what = "effective_stress"
        law, times = self._stress(group), np.asarray(self.ds["time"].values, dtype=float)
        if law is not None:
            self.notes.add(
                what, "recomputed at the integration points from displacement and the model's material"
            )
            return lambda s, t: group.mean(tensors.effective(law(s.F, s.J, times[t])))
        for name in ("stress", "solid_stress"):
            if name in self.ds:
                self.notes.add(
                    what, f"of the plotfile's element mean {name} (no material to recompute it from)"
                )
                v = self._element(name, group)
                return lambda s, t: tensors.effective(v(t).T)
        self.notes.add(what, "missing: no model was given and the plotfile has no stress")
        return None

    def mean_stress(self, group: Group) -> EffectiveStress | None:
        """(6, e) element mean Cauchy stress: from the material, else as the plotfile has it."""
        law, times = self._stress(group), np.asarray(self.ds["time"].values, dtype=float)
        if law is not None:
            self.notes.add("principal_stress", "mean of the material's stress at the integration points")
            return lambda s, t: group.mean(law(s.F, s.J, times[t]))
        for name in ("stress", "solid_stress"):
            if name in self.ds:
                self.notes.add("principal_stress", f"of the plotfile's element mean {name}")
                v = self._element(name, group)
                return lambda s, t: v(t).T
        return None

    def nodal_flux(self, group: Group) -> NodalFlux | None:
        """Plotfile's nodal fluid flux; else Darcy from pressure; else element means."""
        what = "mass_exchange_rate"
        if "nodal_fluid_flux" in self.ds:
            self.notes.add(what, "nodal fluid flux of the plotfile")
            v, n = self._element("nodal_fluid_flux", group), group.element.nodes
            return lambda s, t: v(t)[:, :n].transpose(2, 1, 0)
        mixed = self._mixture(group, what)
        if mixed is not None:
            self.notes.add(what, f"{MIXED}, extrapolated to nodes as FEBio does")
            return lambda s, t: group.to_nodes(mixed(s, t))
        law = self._permeability(group)
        if law is not None:
            self.notes.add(
                what,
                "-K grad p at the integration points from displacement, effective fluid "
                "pressure and the model's permeability, extrapolated to nodes as FEBio does",
            )
            points = self._flux(group, law)
            return lambda s, t: group.to_nodes(points(s, t))
        if "fluid_flux" in self.ds:
            self.notes.add(what, "the plotfile's element mean fluid flux, constant in each element")
            f, n = self._element("fluid_flux", group), group.element.nodes
            return lambda s, t: np.repeat(f(t).T[:, None], n, axis=1)
        self.notes.add(
            what, "missing: no fluid flux in the plotfile, no pressure with a model to get it from"
        )
        return None

    def point_flux(self, group: Group) -> PointFlux | None:
        """Darcy's flux at the integration points; :meth:`dry` where the material carries no fluid."""
        what, spec = "mass_exchange_rate", self.parts.get(group.material)
        if spec is not None and spec.child("permeability") is None:
            return self.dry
        if spec is not None and spec.type == "biphasic" and not self._driven(spec):
            law = self._permeability(group)
            if law is not None:
                self.notes.add(
                    what,
                    "-K grad p at the integration points from displacement, effective fluid pressure and the "
                    "model's permeability",
                )
                return self._flux(group, law)
        mixed = None if spec is None or self._driven(spec) else self._mixture(group, what)
        if spec is not None and mixed is not None and not (spec.child("reaction") or spec.child("solvent_supply")):
            self.notes.add(what, MIXED)
            return mixed
        self.notes.add(
            what,
            "missing: consistent exchange needs the effective fluid pressure and a model whose materials around "
            "the cells are biphasic, or have solutes and neither reactions nor solvent supply, without body forces on "
            "the fluid",
        )
        return None

    @staticmethod
    def dry(state: State, t: int) -> Floats:
        """No flux."""
        return np.zeros((3, *state.J.shape))

    def _driven(self, spec: Component) -> bool:
        """True where body loads act on the fluid of a biphasic material."""
        density = spec.child("fluid_density")
        if self.model is None or density is None or density.text.strip() in ("", "0", "0.0"):
            return False
        steps = (self.model.common, *self.model.steps)
        return any(c.tag == "body_load" for step in steps for c in step.loads)

    def supply(self, group: Group) -> PointSupply | None:
        """Solvent supply at the integration points, None where the material has none."""
        spec = self.parts.get(group.material)
        if spec is None or spec.child("solvent_supply") is None or self.laws is None:
            return None
        law = self.laws.supply(group)
        if law is None:
            return None
        times = np.asarray(self.ds["time"].values, dtype=float)
        return lambda s, t: law(
            s.F, s.J, group.at_points(self.pressure(group, t)), times[t]
        )

    def element_flux(self, group: Group) -> Callable[[State, int], Floats] | None:
        """(3, e) element mean fluid flux."""
        mixed = self._mixture(group, "fluid_flux")
        if mixed is not None:
            self.notes.add("fluid_flux", f"mean of the {MIXED}")
            return lambda s, t: group.mean(mixed(s, t))
        law = self._permeability(group)
        if law is not None:
            self.notes.add("fluid_flux", "mean of -K grad p at the integration points")
            points = self._flux(group, law)
            return lambda s, t: group.mean(points(s, t))
        if "fluid_flux" in self.ds:
            self.notes.add("fluid_flux", "fluid flux of the plotfile")
            f = self._element("fluid_flux", group)
            return lambda s, t: f(t).T
        return None

    def _mixture(self, group: Group, what: str) -> PointFlux | None:
        """Fluid flux (3, g, e) of a mixture with solutes, None where the part is none."""
        law = self._tried(lambda g: mixtures.make(self, g), group, what)
        return None if law is None else lambda s, t: law(s, t).flux

    def _stress(self, group: Group) -> materials.Stress | None:
        spec = self.parts.get(group.material)
        if spec is None or self.laws is None:
            return None
        return materials.stress(spec) or self._tried(self.laws.stress, group, "effective_stress")

    def _permeability(self, group: Group) -> materials.Permeability | None:
        spec = self.parts.get(group.material)
        if spec is None or self.laws is None or "effective_fluid_pressure" not in self.ds:
            return None
        if spec.child("permeability") is None or spec.type in mixtures.KINDS:
            return None
        return materials.permeability(spec) or self._tried(
            self.laws.permeability, group, "mass_exchange_rate"
        )

    def _tried(self, make: Callable[[Group], T], group: Group, what: str) -> T | None:
        try:
            return make(group)
        except UnsupportedError as e:
            self.notes.add(what, f"not from the model: {e}")
            return None

    def _flux(self, group: Group, law: materials.Permeability) -> Callable[[State, int], Floats]:
        """(3, g, e) Darcy flux at the points."""
        times = np.asarray(self.ds["time"].values, dtype=float)
        return lambda s, t: darcy(group, s, self.pressure(group, t), law, times[t])
