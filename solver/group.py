"""A block at work: its integration points, stresses and element matrices.

Elements are cut into chunks small enough for the cache; a chunk goes through kinematics, material and
assembly in turn, so that no material needs to know an element, nor an element a material.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import elements
from .kernels import biphasic, projection, solid
from .law import PoreCollapse
from .points import Points
from .problem import Block
from .solids import history
from .state import State

Floats = NDArray[np.float64]
_NONE = np.zeros((0, 0))
VOIGT = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))


class ElementFailure(RuntimeError):
    """An element that cannot go on; the message names it, its part and why."""


class NegativeJacobian(ElementFailure):
    """An element turned inside out; ``element`` is its label, ``part`` its block."""

    def __init__(self, element: int, part: str) -> None:
        self.element, self.part = element, part
        super().__init__(f"element {element} of part {part!r} turned inside out (negative Jacobian)")


@dataclass(slots=True)
class Chunk:
    lo: int
    hi: int
    points: Points


class Group:
    """Element arrays of one block. m elements, g integration points, n nodes per element."""

    def __init__(self, block: Block, X: Floats, chunk: int = 256) -> None:
        self.block = block
        e = elements.get(block.element, block.rule)
        self.element = e
        self.shell = block.element.startswith("shell_")
        self.alphaf = 1.0  # weight of the step's end in its internal forces, where the pressure goes by the end alone
        self.N, self.dN = np.ascontiguousarray(e.N), np.ascontiguousarray(e.dN)
        self.conn = np.ascontiguousarray(block.conn, dtype=np.int32)
        m, g = len(self.conn), len(e.weights)
        self.m, self.g, self.n = m, g, self.conn.shape[1]
        self.columns = 4 if block.mixture is not None else 3
        self.iJ0, self.wJ0 = np.empty((m, g, 3, 3)), np.empty((m, g))
        if solid.reference(X, self.conn, self.dN, np.ascontiguousarray(e.weights), self.iJ0, self.wJ0):
            first = int(np.flatnonzero((self.wJ0 <= 0).any(axis=1))[0])
            raise NegativeJacobian(int(block.ids[first]), block.name)
        self.F = np.tile(np.eye(3), (m, g, 1, 1))
        self.J = np.ones((m, g))
        self.s = np.zeros((m, g, 6))
        if block.mixture is not None:
            self.Jp = np.ones((m, g))
            self.pgp = _NONE  # pressures at the last converged state, for the projection alone
            self.pg, self.gp, self.w = np.zeros((m, g)), np.zeros((m, g, 3)), np.zeros((m, g, 3))
            self.supply = np.zeros((m, g)) if block.mixture.supply is not None else _NONE
            self.steady_pressure: Floats | None = None  # coefficient of the projection (m,)
        if block.formulation == "three-field":
            self.eJ, self.ep, self.Lk = np.ones(m), np.zeros(m), np.zeros(m)
        self.Xg = np.einsum("ga,eai->egi", self.N, X[self.conn]).reshape(-1, 3)
        self.chunks = self._cut(chunk)
        self.set_history(history.initial(block.solid, m * g))
        self._grows = history.grows(block.solid)

    def _axes(self) -> Floats | None:
        Q = self.block.axes
        if Q is None:
            return None
        return np.repeat(Q, self.g, axis=0) if Q.ndim == 3 else Q.reshape(-1, 3, 3)

    def _cut(self, size: int) -> list[Chunk]:
        F, J, g, Q = self.F.reshape(-1, 3, 3), self.J.reshape(-1), self.g, self._axes()
        pieces, out = max(1, -(-self.m // size)), []
        for i in range(pieces):
            lo, hi = self.m * i // pieces, self.m * (i + 1) // pieces
            q = slice(lo * g, hi * g)
            pts = Points(F[q], J[q], self.Xg[q], np.repeat(np.arange(lo, hi), g))
            pts.Q = None if Q is None else np.ascontiguousarray(Q[q])
            out.append(Chunk(lo, hi, pts))
        return out

    def points(self) -> Points:
        """All integration points of the block as one batch (views)."""
        pts = Points(self.F.reshape(-1, 3, 3), self.J.reshape(-1), self.Xg, np.repeat(np.arange(self.m), self.g))
        pts.Q, pts.old, pts.new = self._axes(), self.old, self.new
        return pts

    def set_history(self, old: Floats) -> None:
        """Take ``old`` (m g, h) as the history of the last converged state."""
        self.old, self.new = old, old.copy()
        for c in self.chunks:
            q = slice(c.lo * self.g, c.hi * self.g)
            c.points.old, c.points.new = self.old[q], self.new[q]

    def named(self, e: PoreCollapse) -> ElementFailure:
        """Which element of which part a law failed in."""
        return ElementFailure(f"element {self.block.ids[e.element]} of part {self.block.name!r}: {e}")

    # ---- update -----------------------------------------------------------------------------------
    def update(self, c: Chunk, state: State, u: Floats, drive: list | None = None) -> None:
        """Kinematics and stresses of a chunk at displacements u (node, 3). Raises NegativeJacobian."""
        bad = solid.kinematics(c.lo, c.hi, u, self.conn, self.dN, self.iJ0, self.F, self.J)
        if bad >= 0:
            raise NegativeJacobian(int(self.block.ids[bad]), self.block.name)
        try:
            self._update_chunk(c, state, drive)
        except PoreCollapse as e:
            raise self.named(e) from None

    def end_pressure(self, u: Floats) -> None:
        """Three-field shells: the pressure goes by the mean relative volume at the step's end (FEBio 4.11)."""
        F, J = np.empty_like(self.F), np.empty_like(self.J)
        solid.kinematics(0, self.m, u, self.conn, self.dN, self.iJ0, F, J)
        self.eJ[:] = (self.wJ0 * J).sum(axis=1) / self.wJ0.sum(axis=1)
        law: Any = self.block.solid
        before = self.ep.copy()
        self.ep[:] = law.pressure(np.repeat(self.eJ, self.g), self.points())[:: self.g] + self.Lk / self.eJ
        self.s[..., :3] += (self.ep - before)[:, None, None]

    def conserve(self, u: Floats, u_old: Floats, dt: float) -> None:
        """Correct the midpoint stress so that its power is the change of strain energy over the step.

        s += D ((W - W_old) / (J dt) - s : D) / (D : D), D the rate of deformation at the midpoint. Gonzalez,
        Comput Methods Appl Mech Engrg 190 (2000); FEBio does so where alpha_f = 1/2.
        """
        end, J = np.empty_like(self.F), np.empty_like(self.J)
        start = np.empty_like(self.F)
        W = []
        for at, F in ((u_old, start), (u, end)):
            solid.kinematics(0, self.m, at, self.conn, self.dN, self.iJ0, F, J)
            pts = self.points()
            pts.F, pts.J = F.reshape(-1, 3, 3), J.reshape(-1).copy()
            W.append(np.broadcast_to(self.block.solid.energy(pts), (self.m * self.g,)).reshape(self.J.shape))
        L = (end - start) @ np.linalg.inv(self.F) / dt
        D = np.stack([L[..., i, j] + L[..., j, i] for i, j in VOIGT], axis=-1) * 0.5
        twice = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])
        D2 = (D * D * twice).sum(axis=-1)
        power = (self.s * D * twice).sum(axis=-1)
        gap = (W[1] - W[0]) / (dt * self.J) - power
        moving = D2 > np.finfo(float).eps  # noqa: SIM300
        self.s += D * np.where(moving, gap / np.where(moving, D2, 1.0), 0.0)[..., None]

    def _update_chunk(self, c: Chunk, state: State, drive: list | None) -> None:
        pts, block = c.points, self.block
        pts.t, pts.dt = state.time, state.dt
        s = self.s[c.lo : c.hi].reshape(-1, 6)
        s[:] = 0.0
        if block.formulation == "three-field":
            self._three_field_stress(c, s)
        else:
            block.solid.stress(pts, s, None)
        if block.mixture is not None:
            self._update_fluid(c, state, drive)

    def _three_field_stress(self, c: Chunk, s: Floats) -> None:
        law, e = self.block.solid, slice(c.lo, c.hi)
        w = self.wJ0[e]
        self.eJ[e] = (w * self.J[e]).sum(axis=1) / w.sum(axis=1)
        law.dev(c.points, s, None)  # type: ignore[attr-defined]
        p = self._of_mean(law.pressure, c)  # type: ignore[attr-defined]
        # the multiplier acts through h(J) = ln J, h' = 1/J (FEBio's augmented Lagrangian)
        self.ep[e] = p + self.Lk[e] / self.eJ[e]
        s[:, :3] += np.repeat(self.ep[e], self.g)[:, None]

    def _of_mean(self, law: Callable[[Floats, Points], Floats], c: Chunk) -> Floats:
        """A volumetric law at the element-mean relative volumes of a chunk."""
        return law(np.repeat(self.eJ[c.lo : c.hi], self.g), c.points)[:: self.g]

    def _update_fluid(self, c: Chunk, state: State, drive: list | None) -> None:
        mix, pts = self.block.mixture, c.points
        assert mix is not None and state.p is not None
        biphasic.pressures(
            c.lo, c.hi, self.conn, self.N, self.dN, self.iJ0, self.F, self.J,
            np.ascontiguousarray(state.d[:, 3]), self.pg, self.gp,
        )  # fmt: skip
        k = self.permeability(c)[0]
        b = np.zeros((0, 3)) if not drive else self._drive(c, drive)
        biphasic.flux(c.lo, c.hi, k, self.gp, b, self.w)
        if mix.supply is not None:
            q = np.zeros(pts.n)
            mix.supply.supply(pts, self.pg[c.lo : c.hi].reshape(-1), q, None, None)
            self.supply[c.lo : c.hi] = q.reshape(-1, self.g)

    def _drive(self, c: Chunk, drive: list) -> Floats:
        mix = self.block.mixture
        assert mix is not None
        b = np.zeros((c.points.n, 3))
        for load in drive:
            b += load.force(c.points)
        return b * mix.fluid_density(c.points.t, c.points.X, c.points.e)[:, None]

    def permeability(self, c: Chunk, tangent: bool = False) -> tuple[Floats, Floats | None]:
        mix, pts = self.block.mixture, c.points
        assert mix is not None
        k = np.zeros((pts.n, 6))
        dk = np.zeros((pts.n, 6, 6)) if tangent and mix.permeability.strain_dependent else None
        phi = mix.phi0(pts.t, pts.X, pts.e)
        mix.permeability.permeability(pts, phi, k, dk)
        return k, dk

    def supply_tangent(self, c: Chunk) -> tuple[Floats, Floats, Floats]:
        """Solvent supply of a chunk's points, and its derivatives by strain and pressure."""
        mix, pts = self.block.mixture, c.points
        assert mix is not None and mix.supply is not None
        rate, dE, dp = np.zeros(pts.n), np.zeros((pts.n, 6)), np.zeros(pts.n)
        mix.supply.supply(pts, self.pg[c.lo : c.hi].reshape(-1), rate, dE, dp)
        return rate, dE, dp

    def dilatation_modulus(self, c: Chunk) -> Floats:
        """Bulk modulus (element,) of a three-field chunk, with the multiplier's share."""
        e = slice(c.lo, c.hi)
        k = self._of_mean(self.block.solid.bulk, c) - self.Lk[e] / self.eJ[e] ** 2  # type: ignore[attr-defined]
        return k / self.alphaf

    def stabilise(self, tau: float) -> None:
        """Steady the pressure by projection (:mod:`.kernels.projection`), c from the moduli at rest."""
        q = self.m * self.g
        pts = Points(np.tile(np.eye(3), (q, 1, 1)), np.ones(q), self.Xg, np.repeat(np.arange(self.m), self.g))
        pts.Q, pts.old, pts.new = self._axes(), self.old, self.new.copy()
        s, C = np.zeros((q, 6)), np.zeros((q, 6, 6))
        self.block.solid.stress(pts, s, C)
        diagonal = C[:, range(6), range(6)].reshape(self.m, self.g, 6).mean(axis=1)
        shear, aggregate = diagonal[:, 3:].mean(axis=1), diagonal[:, :3].mean(axis=1)
        self.pgp = np.zeros((self.m, self.g))
        self.steady_pressure = tau * np.maximum(0.5 / shear, 3.0 / aggregate)

    # ---- residual ---------------------------------------------------------------------------------
    def residual(self, lo: int, hi: int, state: State, R: Floats, steady: bool) -> None:
        """Subtract internal forces of elements lo:hi from R (node, column)."""
        if self.block.mixture is None:
            solid.internal_force(lo, hi, self.conn, self.dN, self.iJ0, self.wJ0, self.F, self.J, self.s, R)
        else:
            biphasic.internal_force(
                lo, hi, self.conn, self.N, self.dN, self.iJ0, self.wJ0, self.F, self.J, self.Jp,
                self.s, self.pg, self.w, self.supply, state.dt, steady, R,
            )  # fmt: skip
            if self.steady_pressure is not None and not steady:
                projection.force(
                    lo, hi, self.conn, self.N, self.wJ0, self.steady_pressure, self.pg, self.pgp, R
                )

    # ---- steps ------------------------------------------------------------------------------------
    def begin_step(self, state: State) -> None:
        """The present state becomes the last converged one; memory is made ready for a step."""
        if self.block.mixture is not None:
            self.Jp = self.J.copy()
            if self.steady_pressure is not None:
                self.pgp = self.pg.copy()
        if self.new.shape[1]:
            self.old[:] = self.new
            if not self._grows:
                return
            pts = self.points()
            pts.t, pts.dt = state.time, state.dt
            self.set_history(history.begin(self.block.solid, pts))

    def snapshot(self) -> dict[str, Floats]:
        """What a failed step must give back."""
        names = ["J", "F", "s"]
        names += ["Jp", "pg", "gp", "w"] if self.block.mixture is not None else []
        names += ["eJ", "ep", "Lk"] if self.block.formulation == "three-field" else []
        return {n: getattr(self, n).copy() for n in names} | {"history": self.new.copy()}

    def restore(self, saved: dict[str, Floats]) -> None:
        for name, value in saved.items():
            if name != "history":
                getattr(self, name)[...] = value
        history.layout(self.block.solid)
        self.set_history(saved["history"].copy())

    def augment(self, done: int) -> tuple[bool, float, float]:
        """One augmentation of the element pressures: (converged, norm, relative change).

        lambda += k ln J with k the bulk modulus (FEBio theory manual, augmented Lagrangian).
        """
        a = self.block.augment
        if a is None:
            return True, 0.0, 0.0
        k = self.block.solid.k(0.0, self.Xg[:: self.g], np.arange(self.m))  # type: ignore[attr-defined]
        new = self.Lk + k * np.log(self.eJ)
        n0, n1 = float(np.linalg.norm(self.Lk)), float(np.linalg.norm(new))
        change = abs((n1 - n0) / n1) if n1 > 1e-10 else 0.0
        converged = change < a.tolerance and done >= a.least
        converged = converged or (a.most > 0 and a.most <= done)
        if not converged:
            self.Lk[:] = new
        return converged, n1, change
