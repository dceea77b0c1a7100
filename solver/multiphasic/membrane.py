"""Membranes: shells of a mixture that react with the mixtures on their two faces.

A reaction of supply zeta gives the face s (in front, behind) zeta yields_sk of solute k per area: over the points of
the shell, whose weights w through the thickness sum up to 2, R_ak = -dt sum M_a yields_sk / 2 zeta |a_s| w with the
shape functions M of the facet and the area vectors a_s = x,r x x,s of the face. FEBio has none of it in a steady state.
FEBio User Manual, "Membrane Reactions".
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..action import Action, Matrices
from ..fields import DISPLACEMENT, PRESSURE
from ..law import Floats
from ..points import Points
from .integrals import operators
from .sides import BACK, FRONT, Sides
from .solution import Solution

if TYPE_CHECKING:
    from ..group import Group
    from ..membrane_reactions.base import MembraneReaction
    from ..state import State

Ints = NDArray[np.int64]


class Faces:
    """The two faces of a group of shells: ``nodes`` (2, m, n) in front and behind, shape functions M (g, n) and their
    derivatives dM (g, n, 2) at the points."""

    def __init__(self, group: Group) -> None:
        n = group.n // 2
        back, front = group.conn[:, :n], group.conn[:, n:]
        self.nodes = np.stack([front, back]).astype(np.int64)
        self.M: Floats = group.N[:, :n] + group.N[:, n:]
        self.dM: Floats = (group.dN[:, :n] + group.dN[:, n:])[..., :2]
        self.w = np.asarray(group.element.weights)
        self._areas: Floats | None = None

    def tangents(self, x: Floats, side: int, e: slice = slice(None)) -> tuple[Floats, Floats]:
        """x,r and x,s (m, g, 3) of a face at nodal positions x."""
        at = x[self.nodes[side, e]]
        r, s = (np.einsum("ga,eai->egi", self.dM[..., k], at) for k in (0, 1))
        return r, s

    def area(self, x: Floats, side: int) -> tuple[Floats, Floats]:
        """|a| (m, g) of a face, a = x,r x x,s, and its derivatives by the face's nodes (m, g, n, 3)."""
        r, s = self.tangents(x, side)
        a = np.cross(r, s)
        size = np.linalg.norm(a, axis=-1)
        n = a / size[..., None]
        by_r, by_s = np.cross(s, n), np.cross(n, r)
        slope = by_r[:, :, None] * self.dM[None, :, :, :1] + by_s[:, :, None] * self.dM[None, :, :, 1:]
        return size, slope

    def reference(self, X: Floats) -> Floats:
        """|X,r x X,s| of the front (m, g)."""
        if self._areas is None:
            self._areas = np.linalg.norm(np.cross(*self.tangents(X, FRONT)), axis=-1)
        return self._areas

    def see(self, e: slice, state: State, into: Sides) -> None:
        """What is on both faces of the elements ``e`` into the sides at their points."""
        x, d = state.x, state.d[:, state.layout.concentrations]
        for side in (FRONT, BACK):
            c = np.einsum("ga,eak->egk", self.M, d[self.nodes[side, e]])
            into.c[:, side] = c.reshape(-1, c.shape[2])
        area = np.linalg.norm(np.cross(*self.tangents(x, FRONT, e)), axis=-1)
        into.strain[:] = (area / self.reference(state.X)[e]).ravel()
        h = np.linalg.norm(x[self.nodes[FRONT, e]] - x[self.nodes[BACK, e]], axis=-1)
        into.h[:] = (h @ self.M.T).ravel()


@dataclass(eq=False)
class MembraneFlux(Action):
    """What the reactions of the block ``number`` of shells exchange with its faces.

    ``meets`` (m, 2, M): the solutes of the model that the mixtures on the faces of each element have.
    """

    number: int
    meets: NDArray[np.bool_]
    _group: Group = field(init=False, repr=False)

    @property
    def symmetric(self) -> bool:
        return False

    def begin(self, state: State, groups: list[Group]) -> None:
        self._group = groups[self.number]
        self.faces = self._work.faces

    def cliques(self) -> list[Ints]:
        return [self._work.group.conn]

    @property
    def _work(self) -> Any:
        return self._group.physics

    @property
    def _reactions(self) -> tuple[MembraneReaction, ...]:
        out: tuple[MembraneReaction, ...] = self._work.mix.membrane
        return out

    def _now(self, state: State) -> tuple[Points, Solution]:
        pts = self._group.points()
        pts.t, pts.dt = state.time, state.dt
        return pts, self._work.at.solution(slice(None))

    def _at_points(self, values: Floats) -> Floats:
        """(m g, ...) as (m, g, ...)."""
        return values.reshape(self._group.m, self._group.g, *values.shape[1:])

    def _gains(self, side: int, pts: Points, sol: Solution) -> Floats:
        """Moles (m, g, M) that a face gains for an area of one."""
        out = np.zeros((self._group.m, self._group.g, self.meets.shape[2]))
        for r in self._reactions:
            out += self._at_points(r.supply(pts, sol))[..., None] * r.yields[side]
        return out * self.meets[:, None, side]

    def residual(self, state: State, R: Floats) -> None:
        if self._group.steady:
            return
        pts, sol = self._now(state)
        columns, f = state.layout.concentrations, self.faces
        for side in (FRONT, BACK):
            area = f.area(state.x, side)[0] * f.w
            moles = 0.5 * state.dt * np.einsum("egk,eg,ga->eak", self._gains(side, pts, sol), area, f.M)
            np.subtract.at(R, (f.nodes[side][..., None], columns), moles)

    # ---- tangent ------------------------------------------------------------------------------------
    def stiffness(self, state: State, groups: Any = None) -> Matrices:
        """Of the exchange, and of what the sides change of the supplies inside the shell."""
        pts, sol = self._now(state)
        rows = _Rows(self._group, state)
        if not self._group.steady:
            for side in (FRONT, BACK):
                self._exchange(rows, state, side, pts, sol)
        for r in self._reactions:
            self._inside(rows, state, r, pts, sol)
        return [rows.made()]

    def _exchange(self, rows: _Rows, state: State, side: int, pts: Points, sol: Solution) -> None:
        f = self.faces
        size, slope = f.area(state.x, side)
        scale = -0.5 * state.dt * f.w
        gains = self._gains(side, pts, sol)
        for k, column in enumerate(state.layout.concentrations):
            test = scale[None, :, None] * f.M * self.meets[:, None, side, k, None]
            if not test.any():
                continue
            for i in range(3):  # areas change with the face
                rows.add(side, column, test * gains[..., k, None], side, state.layout.displacement[i], slope[..., i])
            for reaction in self._reactions:
                weight = test * size[..., None] * reaction.yields[side, k]
                if weight.any():
                    self._by_sides(rows, state, side, column, weight, reaction, pts, sol)
                    self._by_own(rows, state, side, column, weight, reaction, pts, sol)

    def _by_own(
        self, rows: _Rows, state: State, side: int, column: int, test: Floats, r: MembraneReaction, pts: Points,
        sol: Solution,
    ) -> None:  # fmt: skip
        """Add the rows of ``column`` on a face: ``test`` (m, g, n) times what the shell's own state does to zeta."""
        g, n = self._group, self._group.n // 2
        by_c, by_J = self._at_points(r.by_concentration(pts, sol)), self._at_points(r.by_J(pts, sol) * pts.J)
        if not by_c.any():  # nor by J then: the shell's solutes take no part
            return
        B = operators(0, g.m, g.N, g.dN, g.iJ0, g.F, g.J)
        for other, half in ((FRONT, slice(n, None)), (BACK, slice(0, n))):
            for k, c in enumerate(self._own(state)):
                rows.add(side, column, test, other, c, by_c[..., k, None] * g.N[:, half])
            for i, u in enumerate(state.layout.displacement):
                rows.add(side, column, test, other, u, by_J[..., None] * B[:, :, 1 + i, half])

    def _own(self, state: State) -> list[int]:
        """Columns of the shell's own solutes."""
        return [state.layout.column(f"c{s.index + 1}") for s in self._work.mix.solutes]

    def _inside(self, rows: _Rows, state: State, r: MembraneReaction, pts: Points, sol: Solution) -> None:
        """Supplies of fluid and the shell's own solutes, as the mixture takes them."""
        g = self._group
        phi = self._at_points(1.0 - sol.phi0 / pts.J)
        volume = state.dt * phi * g.wJ0 * g.J
        fluid = (int(state.layout.columns(PRESSURE.name)[0]), r.Vbar, volume)
        solutes = [(c, v, volume * phi if g.steady else volume) for c, v in zip(self._own(state), r.net)]
        n = g.n // 2
        for column, v, weight in (fluid, *solutes):
            if v:
                for side, N in ((FRONT, g.N[:, n:]), (BACK, g.N[:, :n])):
                    self._by_sides(rows, state, side, column, -v * weight[..., None] * N, r, pts, sol)

    def _by_sides(
        self, rows: _Rows, state: State, side: int, column: int, test: Floats, r: MembraneReaction, pts: Points,
        sol: Solution,
    ) -> None:  # fmt: skip
        """Add the rows of ``column`` on a face: ``test`` (m, g, n) times what concentrations and strain do to zeta."""
        f, by = self.faces, self._at_points(r.by_sides(pts, sol))
        for other in (FRONT, BACK):
            for k, c in enumerate(state.layout.concentrations):
                if by[:, :, other, k].any():
                    rows.add(side, column, test, other, c, by[:, :, other, k, None] * f.M)
        by_strain = self._at_points(r.by_strain(pts, sol))
        if by_strain.any():
            slope = f.area(state.x, FRONT)[1] * (by_strain / f.reference(state.X))[..., None, None]
            for i in range(3):
                rows.add(side, column, test, FRONT, state.layout.displacement[i], slope[..., i])


class _Rows:
    """Element matrices over the displacements, pressures and all concentrations of both faces of shells."""

    def __init__(self, group: Group, state: State) -> None:
        layout = state.layout
        self.conn, self.n = group.conn.astype(np.int64), group.n
        names = [DISPLACEMENT.name, PRESSURE.name]
        self.columns = np.concatenate([layout.columns(*names), layout.concentrations])
        self.place = {int(c): k for k, c in enumerate(self.columns)}
        size = len(self.columns) * self.n
        self.K = np.zeros((group.m, size, size))

    def _at(self, side: int, column: int) -> slice:
        start = self.place[int(column)] * self.n + (self.n // 2 if side == FRONT else 0)
        return slice(start, start + self.n // 2)

    def add(self, side: int, row: int, test: Floats, other: int, column: int, slope: Floats) -> None:
        """Subtract the sum over points of test times slope (m, g, n): what forces on a face change with another's
        unknowns."""
        self.K[:, self._at(side, row), self._at(other, column)] -= np.einsum("ega,egb->eab", test, slope)

    def made(self) -> tuple[Floats, Ints, Ints]:
        return self.K, np.tile(self.conn, (1, len(self.columns))), np.repeat(self.columns, self.n)
