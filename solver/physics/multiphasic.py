"""A porous solid, its fluid and solutes: displacement, effective fluid pressure and effective concentrations.

One physics for FEBio's biphasic-solute, triphasic and multiphasic materials: what differs between them is data
(:class:`..multiphasic.material.Mixture`). Backward Euler; FEBio theory manual, "Multiphasic" finite elements.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ..fields import DISPLACEMENT, PRESSURE, Field, concentration
from ..kernels.mixture import subtract
from ..kernels.mixture_tangent import add_pressure
from ..multiphasic.fields import Fields, Instant
from ..multiphasic.integrals import at_points, forces, matrices, operators
from ..multiphasic.material import Mixture
from ..multiphasic.solution import Solution
from ..multiphasic.tangent import point_tangent, pressure_slope
from ..points import Points
from ..solids.bound import Bound
from . import register
from .base import Floats, Physics, Work
from .standard import StandardWork
from .steadied import Steadied

if TYPE_CHECKING:
    from ..group import Chunk, Group
    from ..multiphasic.membrane import Faces
    from ..state import State
    from ..tangent import Target, Workspace

CACHE = 4 << 20  # bytes of point tangents at a time


class MultiphasicWork(StandardWork):
    """``at``: what the mixture keeps at the points (:class:`..multiphasic.fields.Fields`)."""

    def __init__(self, group: Group, physics: Multiphasic) -> None:
        super().__init__(group, physics)
        self.mix = physics.mixture
        self.at = Fields(self.mix, group.points())
        self.element = np.repeat(np.arange(group.m), group.g)
        self.started = False
        self.scalars = group.columns[DISPLACEMENT.width :]
        self.steadied = Steadied(group)
        self.faces: Faces | None = None
        if self.mix.membrane:
            from ..multiphasic.membrane import Faces

            self.faces = Faces(group)
        if any(isinstance(s, Bound) for s in group.block.solid.walk()):
            group.share(bound=self.at.bound)

    def symmetric(self, steady: bool) -> bool:
        return False

    def stabilise(self, tau: float) -> None:
        self.steadied.begin(tau)

    # ---- pieces -------------------------------------------------------------------------------------
    def _at(self, lo: int, hi: int, state: State) -> tuple[slice, Points]:
        """The points of elements lo:hi, as a slice of all and as a batch."""
        g = self.group
        q = slice(lo * g.g, hi * g.g)
        pts = Points(g.F.reshape(-1, 3, 3)[q], g.J.reshape(-1)[q], g.Xg[q], self.element[q])
        pts.t, pts.dt = state.time, state.dt
        pts.Q = self._axes(lo, hi)
        pts.extra = {k: v[q] for k, v in g.extra.items()}
        return q, pts

    def _axes(self, lo: int, hi: int) -> Floats | None:
        Q = self.group.block.axes
        if Q is None:
            return None
        return np.repeat(Q[lo:hi], self.group.g, axis=0) if Q.ndim == 3 else Q[lo:hi].reshape(-1, 3, 3)

    def _operators(self, lo: int, hi: int) -> Floats:
        g = self.group
        return operators(lo, hi, g.N, g.dN, g.iJ0, g.F, g.J)

    def _pieces(self, c: Chunk) -> Iterator[tuple[int, int]]:
        """Elements lo:hi of a chunk whose point tangents stay in the cache."""
        size = max(1, CACHE // (8 * 16 * len(self.group.columns) ** 2 * self.group.g))
        for lo in range(c.lo, c.hi, size):
            yield lo, min(lo + size, c.hi)

    # ---- update -------------------------------------------------------------------------------------
    def update(self, c: Chunk, state: State, drive: list[Any]) -> None:
        self._evaluate(c.lo, c.hi, state, Instant(state.dt, self.group.steady) if self.started else None)
        super().update(c, state, drive)
        self._remember(c)

    def _remember(self, c: Chunk) -> None:
        """Rate laws take what they remember of the state."""
        for law in (k for r in self.mix.reactions for k in r.rates if k.remembers):
            law.evaluated(c.points, self.at.memory[id(law)][c.lo * self.group.g : c.hi * self.group.g])

    def _evaluate(self, lo: int, hi: int, state: State, now: Instant | None) -> None:
        q, pts = self._at(lo, hi, state)
        nodal = state.d[:, self.scalars][self.group.conn[lo:hi]]
        if self.faces is not None and self.at.sides is not None:
            self.faces.see(slice(lo, hi), state, self.at.sides.part(q))
        self.at.update(q, pts, at_points(self._operators(lo, hi), nodal), now)

    # ---- residual and tangent -----------------------------------------------------------------------
    def residual(self, lo: int, hi: int, state: State, R: Floats, steady: bool) -> None:
        g = self.group
        q, pts = self._at(lo, hi, state)
        stress = self.at.stress(q, pts, self.s.reshape(-1, 6)[q], Instant(state.dt, steady))
        f = forces(self._operators(lo, hi), g.wJ0[lo:hi] * g.J[lo:hi], stress)
        subtract(lo, hi, g.conn, g.columns, f, R)
        if not steady:
            self.steadied.force(lo, hi, self._points(self.at.p), state.layout.scalar(R, PRESSURE.name))

    def tangent(self, c: Chunk, state: State, target: Target, work: Workspace, steady: bool) -> None:
        g = self.group
        s, C = work.zeros("s", c.points.n, 6), work.zeros("C", c.points.n, 6, 6)
        c.points.t, c.points.dt = state.time, state.dt
        self.moduli(c, s, C)
        now = Instant(state.dt, steady)
        for lo, hi in self._pieces(c):
            q, pts = self._at(lo, hi, state)
            A = point_tangent(self.at, q, pts, self.s.reshape(-1, 6)[q], C[(lo - c.lo) * g.g : (hi - c.lo) * g.g], now)
            K = matrices(self._operators(lo, hi), g.wJ0[lo:hi] * g.J[lo:hi], A)
            if not steady:
                self.steadied.tangent(lo, hi, K, 3 * g.n, 3 * g.n)
            if target.pat.symmetric:  # FEBio's symmetric stiffness of a mixture is the mean of the two triangles
                K = 0.5 * (K + K.transpose(0, 2, 1))
            target.add(g, lo, hi, K)

    # ---- steps --------------------------------------------------------------------------------------
    def start(self, state: State) -> None:
        if not self.started:
            self._evaluate(0, self.group.m, state, None)

    def begin_step(self, state: State) -> None:
        g = self.group
        _, pts = self._at(0, g.m, state)
        if not self.started:  # what the mixture is before its first step, by the parameters of that time
            end, state.time = state.time, state.time - state.dt
            self._evaluate(0, g.m, state, None)
            state.time = end
            self.started = True
        self.at.begin_step(pts)
        self.steadied.begin_step(self._points(self.at.p))

    def rates(self) -> list[tuple[Floats, Floats]]:
        return [*self.at.rates(), *self.steadied.rates(self._points(self.at.p))]

    def stages(self) -> None:
        self.at.stages()

    def hidden(self) -> list[Floats]:
        return [*self.at.bound.T, *([self.at.complex] if self.mix.binds else [])]

    def snapshot(self) -> dict[str, Floats]:
        own = {f"mixture {k}": v for k, v in self.at.snapshot().items()}
        return super().snapshot() | own | {"started": np.array(self.started)}

    def restore(self, saved: dict[str, Floats]) -> None:
        super().restore(saved)
        self.started = bool(saved["started"])
        self.at.restore({k.removeprefix("mixture "): v for k, v in saved.items() if k.startswith("mixture ")})

    # ---- what others ask ----------------------------------------------------------------------------
    def mass(self) -> tuple[Floats, Floats | None]:
        """None: FEBio's body loads pass over mixtures with solutes, whatever the densities."""
        return np.zeros((self.group.m, self.group.g)), None

    def permeability(self, pts: Points) -> Floats:
        k = np.zeros((pts.n, 6))
        self.mix.permeability.permeability(pts, self.mix.phi0(pts.t, pts.X, pts.e), k, None)
        return k

    def diffusivity(self, e: NDArray[np.int64], field: str) -> Floats | None:
        own = [concentration(s.index + 1).name for s in self.mix.solutes]
        if field not in own:
            return None
        g, i = self.group, own.index(field)
        pts = g.at_rest().some(e * g.g)
        phi0 = np.broadcast_to(self.mix.phi0(pts.t, pts.X, pts.e), (pts.n,))
        sol = Solution.at(self.mix.z, np.zeros((pts.n, len(own))), phi0)
        D = np.zeros((pts.n, 6))
        self.mix.solutes[i].diffusivity.diffusivity(pts, sol, i, D, None)
        return D * ((1.0 - phi0) * self.mix.solutes[i].solubility.solubility(pts, sol, i))[:, None]

    def osmosis(self, e: NDArray[np.int64]) -> tuple[Floats, Floats, NDArray[np.int64]]:
        sol, mix = self.at.solution(slice(None)), self.mix
        phi = np.broadcast_to(mix.osmotic_coefficient.coefficient(self.group.points(), sol), len(sol.c))
        means = mix.RT * self._points(phi)[e].mean(axis=1), self._points(self.at.kappa)[e].mean(axis=1)
        return *means, self.scalars[1:]

    def osmotic(self, e: NDArray[np.int64]) -> Floats:
        return np.asarray(self._points(self.at.pa - self.at.p)[e].mean(axis=1))

    def carried(self, e: NDArray[np.int64], field: str) -> Floats:
        i = [concentration(s.index + 1).name for s in self.mix.solutes].index(field)
        w, ca = (self._points(q)[e].mean(axis=1) for q in (self.at.w, self.at.ca[:, i]))
        return np.asarray(ca[:, None] * w)

    def mixture_tangent(self, e: NDArray[np.int64], state: State) -> Floats:
        g, q = self.group, e * self.group.g
        if not self.started:
            self._evaluate(0, g.m, state, None)
        s, C = np.zeros((g.m * g.g, 6)), np.zeros((g.m * g.g, 6, 6))
        g.block.solid.stress(g.points(), s, C)
        C = C[q]
        p, slope = self.pressure(g.points())
        add_pressure(C, p[q], slope[q])
        return C

    def pressure(self, pts: Points) -> tuple[Floats, Floats]:
        return self.at.pa, pressure_slope(self.at, pts)

    def _points(self, values: Floats) -> Floats:
        """Values (m g, ...) by element and point."""
        return values.reshape(self.group.m, self.group.g, *values.shape[1:])

    def total_stress(self) -> Floats:
        """Stress of the mixture (m, g, 6)."""
        s = self.s.copy()
        s[..., :3] -= self._points(self.at.pa)[..., None]
        return s

    def osmotic_coefficient(self, pts: Points) -> Floats:
        """At all points (m, g)."""
        phi = self.mix.osmotic_coefficient.coefficient(pts, self.at.solution(slice(None)))
        return self._points(np.broadcast_to(phi, (pts.n,)))

    def velocities(self) -> Floats:
        """j_i / c_i (m g, solute of the material, 3), zero where there is no solute."""
        c = self.at.ca[..., None]
        return np.divide(self.at.j, c, out=np.zeros_like(self.at.j), where=c > 0.0)

    def by_solute(self, values: Floats) -> Floats:
        """Values (m g, solute of the material, ...) for all solutes of the model, zero where the material has none."""
        return self._spread(values, [s.index for s in self.mix.solutes], self.mix.model_solutes)

    def by_bound(self, values: Floats) -> Floats | None:
        """Likewise for solid-bound molecules; None where the model has none."""
        if not self.mix.model_bound:
            return None
        return self._spread(values, [s.index for s in self.mix.solid_bound], self.mix.model_bound)

    def _spread(self, values: Floats, indices: list[int], n: int) -> Floats:
        out = np.zeros((len(values), n, *values.shape[2:]))
        out[:, indices] = values
        return self._points(out.reshape(len(values), -1))

    outputs = {
        **StandardWork.outputs,
        "stress": lambda w: w.total_stress(),
        "fluid pressure": lambda w: w._points(w.at.pa),
        "fluid flux": lambda w: w._points(w.at.w),
        "porosity": lambda w: w._points(np.maximum(1.0 - w.at.phi0 / w.at.J, 0.0)),
        "referential solid volume fraction": lambda w: w._points(w.at.phi0),
        "solute concentration": lambda w: w.by_solute(w.at.ca),
        "partition coefficient": lambda w: w.by_solute(w.at.kappa),
        "receptor-ligand concentration": lambda w: w._points(w.at.complex) if w.mix.neutral else None,
        "solute flux": lambda w: w.by_solute(w.at.j),
        "solute volumetric flux": lambda w: w.by_solute(w.velocities()),
        "electric potential": lambda w: w._points(w.at.electric_potential()),
        "current density": lambda w: w._points(w.at.current_density()),
        "fixed charge density": lambda w: w._points(w.at.cF),
        "referential fixed charge density": lambda w: w._points(w.at.referential_fixed_charge()),
        "osmolarity": lambda w: w._points(w.at.solution(slice(None)).osmolarity()),
        "sbm concentration": lambda w: w.by_bound(w.at.solution(slice(None)).bound_concentration(w.at.J)),
        "sbm referential apparent density": lambda w: w.by_bound(w.at.bound),
    }


@dataclass(eq=False)
class Multiphasic(Physics):
    """``mixture``: fluid, solutes and charges."""

    mixture: Mixture
    name: ClassVar[str] = "multiphasic"
    rates: ClassVar[bool] = True
    work: ClassVar[type[Work]] = MultiphasicWork

    @property
    def fields(self) -> tuple[Field, ...]:
        return DISPLACEMENT, PRESSURE, *(concentration(s.index + 1) for s in self.mixture.solutes)


register(Multiphasic, "multiphasic")
