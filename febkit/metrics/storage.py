"""How fast the solid gives room to fluid at the integration points: div v of the step that ends at a state."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .flux import gradient
from .kinematics import Group, State

if TYPE_CHECKING:
    import xarray as xr

    from febkit.model import Model

    from .sources import Sources

Floats = NDArray[np.float64]
# (g, e) div v at the points of a group, in the state there
Rate = Callable[[Group, State], Floats]
WAYS = {
    "step": "(1 - J_before / J) / dt over the solved step, its length told by the plotfile's velocity",
    "velocity": "div of the plotfile's nodal velocity, the states not being one step apart",
    "interval": "(1 - J_before / J) / dt over the interval between states, right where every solved step is written",
    "steady": "none, the analysis is steady",
    "unknown": "left out where no state comes before",
}
SAME = 1e-3  # displacement over an interval and velocity times it that differ by less are those of one step


@dataclass(slots=True, eq=False)
class Storage:
    """div v = (1 - J_before / J) / dt, as backward Euler has it in the pressure equation (FEBio Theory Manual).

    A plotfile need not hold the state before the last solved step. Nodal velocity, (u - u_before) / dt of that step,
    tells whether it does, and its divergence stands in where it does not (off by the step's strain, relatively).
    """

    sources: Sources
    times: Floats
    velocity: str | None
    steady: bool
    used: Counter[str] = field(default_factory=Counter)
    _before: tuple[int, Floats] | None = None

    @classmethod
    def make(cls, ds: xr.Dataset, sources: Sources) -> Storage | None:
        """None where some steps of the model are steady and some are not."""
        kinds = set() if sources.model is None else steady_steps(sources.model)
        if len(kinds) > 1:
            sources.notes.add("mass_exchange_rate", "missing: the model has steady and transient steps")
            return None
        nodal = (v for v in ("nodal_velocity", "velocity") if v in ds and "node" in ds[v].dims)
        return cls(sources, np.asarray(ds["time"].values, dtype=float), next(nodal, None), kinds == {True})

    def at(self, u: Floats, t: int) -> Rate:
        """The rate at time index ``t``, where displacements are ``u`` (N, 3)."""
        way, data, dt = self._way(u, t)
        self.used[way] += 1
        self._before = t, u
        if way in ("steady", "unknown"):
            return lambda g, s: np.zeros(s.J.shape)
        if way == "velocity":
            return lambda g, s: sum(gradient(g, s, g.positions(data)[i])[i] for i in range(3))
        return lambda g, s: (1 - g.at(data).J / s.J) / dt

    def _way(self, u: Floats, t: int) -> tuple[str, Floats, float]:
        """One of :data:`WAYS`; the displacements (N, 3) before, or velocities, that it needs; the time between."""
        if self.steady:
            return "steady", u, 0.0
        dt = self.times[t] - self.times[t - 1] if t else 0.0
        v = None if self.velocity is None else self.sources.nodal(self.velocity, t)
        if dt > 0:
            before = self._before[1] if self._before and self._before[0] == t - 1 else self.sources.displacement(t - 1)
            moved = u - before
            if v is None or (moved.any() and not v.any()):  # not written, or not by this solver's equations
                return "interval", before, dt
            slack = SAME * np.abs(moved).max() + 4 * np.finfo(np.float32).eps * np.abs(u).max()
            if np.abs(v * dt - moved).max() <= slack:
                return "step", u - v * dt, dt  # single precision rounds the step here, not the positions
        return ("unknown", u, 0.0) if v is None else ("velocity", v, 0.0)

    def said(self) -> str:
        """How div v was had, and at how many times."""
        return "; ".join(f"{WAYS[w]} (at {n} of {sum(self.used.values())} times)" for w, n in self.used.items())


def steady_steps(model: Model) -> set[bool]:
    """Whether the steps of a model are steady states: {False}, {True} or both."""
    controls = [s.control for s in model.steps if s.control is not None]
    usual = "transient" if model.module == "biphasic" else "static"
    return {c.str("analysis", usual).lower() in ("steady-state", "static", "0") for c in controls}
