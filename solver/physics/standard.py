"""A solid in displacements alone: integral of stress times virtual strain."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..fields import DISPLACEMENT, Field
from ..kernels import blocks, solid, variations
from ..points import VOIGT, Points
from ..record import variable_record
from ..tangent import upper_blocks
from . import register
from .base import Floats, Physics, Work

if TYPE_CHECKING:
    from ..changes import Changes
    from ..group import Chunk, Group
    from ..state import State
    from ..tangent import Target, Workspace


_NONE, _NONES, _FLAT = np.zeros((0, 0)), np.zeros((0, 0, 0)), np.zeros((0, 6))


class StandardWork(Work):
    """s (m, g, 6): Cauchy stress of the solid."""

    memory: ClassVar[tuple[str, ...]] = ("s",)
    held: ClassVar[Mapping[str, str]] = {"s": "stress"}

    def __init__(self, group: Group, physics: Physics) -> None:
        super().__init__(group, physics)
        self.s = np.zeros((group.m, group.g, 6))

    def symmetric(self, steady: bool) -> bool:
        return self.group.block.solid.symmetric

    @property
    def recalls(self) -> bool:
        return type(self) is not StandardWork

    # ---- stress -----------------------------------------------------------------------------------
    def update(self, c: Chunk, state: State, drive: list[Any]) -> None:
        c.points.t, c.points.dt = state.time, state.dt
        s = self.s[c.lo : c.hi].reshape(-1, 6)
        s[:] = 0.0
        self.stress(c, s)

    def stress(self, c: Chunk, s: Floats) -> None:
        """Add the solid's stress at a chunk's points to s (n, 6)."""
        self.group.block.solid.stress(c.points, s, None)

    def moduli(self, c: Chunk, s: Floats, C: Floats) -> None:
        self.group.block.solid.stress(c.points, s, C)

    def tangents(self, pts: Points) -> list[tuple[str, Floats]]:
        C = np.zeros((pts.n, 6, 6))
        self.group.block.solid.stress(pts, np.zeros((pts.n, 6)), C)
        return [("stress", C)]

    def bulk(self, c: Chunk) -> Floats | None:
        """Moduli (element,) of element-mean pressures, where the elements have any."""
        return None

    def end(self, state: State, alphaf: float) -> None:
        if alphaf == 0.5:
            self._conserve(state.u, state.u_old, state.dt)

    def _conserve(self, u: Floats, u_old: Floats, dt: float) -> None:
        """Correct the midpoint stress so that its power is the change of strain energy over the step.

        s += D ((W - W_old) / (J dt) - s : D) / (D : D), D the rate of deformation at the midpoint. Gonzalez,
        Comput Methods Appl Mech Engrg 190 (2000); FEBio does so where alpha_f = 1/2.
        """
        g = self.group
        end, J = np.empty_like(g.F), np.empty_like(g.J)
        start = np.empty_like(g.F)
        W = []
        for at, F in ((u_old, start), (u, end)):
            g.deform(at, F, J)
            pts = g.points()
            pts.F, pts.J = F.reshape(-1, 3, 3), J.reshape(-1).copy()
            W.append(np.broadcast_to(g.block.solid.energy(pts), (g.m * g.g,)).reshape(g.J.shape))
        L = (end - start) @ np.linalg.inv(g.F) / dt
        D = np.stack([L[..., i, j] + L[..., j, i] for i, j in VOIGT], axis=-1) * 0.5
        twice = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])
        D2 = (D * D * twice).sum(axis=-1)
        power = (self.s * D * twice).sum(axis=-1)
        gap = (W[1] - W[0]) / (dt * g.J) - power
        moving = D2 > np.finfo(float).eps  # noqa: SIM300
        self.s += D * np.where(moving, gap / np.where(moving, D2, 1.0), 0.0)[..., None]

    # ---- residual and tangent ---------------------------------------------------------------------
    def residual(self, lo: int, hi: int, state: State, R: Floats, steady: bool) -> None:
        g = self.group
        solid.internal_force(lo, hi, g.conn, g.dN, g.iJ0, g.wJ0, g.F, g.J, self.s, state.layout.u(R))

    def tangent(self, c: Chunk, state: State, target: Target, work: Workspace, steady: bool) -> None:
        q = (c.hi - c.lo) * self.group.g
        s, C = work.zeros("s", q, 6), work.zeros("C", q, 6, 6)
        c.points.t, c.points.dt = state.time, state.dt
        self.moduli(c, s, C)
        bulk = self.bulk(c)
        for lo, hi, e, p in self.group.pieces(c):
            self._add(lo, hi, s[p], C[p], None if bulk is None else bulk[e].copy(), target, work)

    def _add(
        self, lo: int, hi: int, s: Floats, C: Floats, bulk: Floats | None, target: Target, work: Workspace
    ) -> None:  # fmt: skip
        """The tangents of elements lo:hi."""
        g, n = self.group, hi - lo
        if g.block.solid.symmetric:
            B, U = upper_blocks(g, lo, hi, s, C, work)
            if bulk is None and target.pat.symmetric:
                target.add_blocks(g, lo, hi, B, U)
                return
            K = work.take("K", n, 3 * g.n, 3 * g.n)
            blocks.expand(n, B, U, False, K)
        else:
            K = work.take("K", n, 3 * g.n, 3 * g.n)
            solid.stiffness(lo, hi, *g.geometry, s.reshape(-1, g.g, 6), C.reshape(-1, g.g, 6, 6), K)
        if bulk is not None:
            self.dilate(lo, hi, bulk, K)
        target.add(g, lo, hi, K)

    def dilate(self, lo: int, hi: int, bulk: Floats, K: Floats) -> None:
        """Add what element-mean pressures add to the matrices K of elements lo:hi."""

    # ---- small changes ----------------------------------------------------------------------------
    @property
    def varies(self) -> bool:
        own = type(self) is StandardWork and not self.group.shell
        return own and all(m.consistent for m in self.group.block.solid.walk())

    def vary(
        self, c: Chunk, state: State, changes: Changes, R: Floats, work: Workspace, steady: bool
    ) -> None:  # fmt: skip
        g, q = self.group, c.points.n
        s, C = work.zeros("s", q, 6), work.zeros("C", q, 6, 6)
        c.points.t, c.points.dt = state.time, state.dt
        self.moduli(c, s, C)
        ds = self.stresses(c, s, changes, work)
        variations.forces(g.n, g.g, False)(
            c.lo, c.hi, g.conn, g.dN, g.N, g.iJ0, g.wJ0, g.F, g.J, s, C, _NONE, _NONES, _FLAT, _NONES, state.dt,
            steady, changes.D, changes.which, ds, _NONES, _NONES, R,
        )  # fmt: skip

    def stresses(self, c: Chunk, s: Floats, changes: Changes, work: Workspace) -> Floats:
        """What other laws and histories change of stresses s (n, 6) of a chunk (k, n, 6)."""
        out = work.zeros("ds", len(changes.others), len(s), 6)
        for ds, (w, stressed, _) in zip(out, changes.others):
            if stressed:
                w.group.block.solid.stress(w.here(c), ds, None)
                ds -= s
        return out

    def here(self, c: Chunk) -> Points:
        """The group's own points of a chunk of another one, deformed as those are."""
        own = self.group.chunks[c.number].points
        return own.but(F=c.points.F, J=c.points.J, t=c.points.t, dt=c.points.dt)

    outputs = {"stress": lambda w: w.s, "solid stress": lambda w: w.s}


@variable_record
class Standard(Physics):
    """The displacement formulation, of a block's solid."""

    name: ClassVar[str] = "standard"
    work: ClassVar[type[Work]] = StandardWork

    @property
    def fields(self) -> tuple[Field, ...]:
        return (DISPLACEMENT,)


register(Standard, "standard")
