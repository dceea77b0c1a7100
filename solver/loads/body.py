"""What a body load is: an acceleration of the mass of some blocks."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..action import Action
from ..kernels import body as kernels
from .base import Floats, Ints, Matrices

if TYPE_CHECKING:
    from ..state import State

Group = Any  # febkit.solver.group.Group: one block of elements at work


@dataclass(eq=False)
class BodyLoad(Action):
    """R += int N rho a over the reference volume; rho follows the fluid content in biphasic blocks.

    FEBio gives body forces the opposite sign: its "force" f means a = -f. ``blocks`` names the blocks
    acted on, None all; ``elements`` block -> element indices, where not all of the block. The system of an analysis
    step sets ``rate`` as well as ``alpha``.
    """

    blocks: tuple[str, ...] | None = field(default=None, kw_only=True)
    elements: dict[str, Ints] = field(default_factory=dict, kw_only=True)
    rate: float = field(default=0.0, init=False)  # dt dv/du of the time integration
    moves: ClassVar[bool] = False  # the acceleration depends on the motion
    drives: ClassVar[bool] = False  # it acts on the fluid of mixtures, too, by ``force(points)``

    def acceleration(self, state: State, group: Group) -> Floats:
        """Acceleration (1|n, 3) at the points of a group."""
        raise NotImplementedError

    def gradient(self, state: State, group: Group, rate: float) -> Floats:
        """da/dx + ``rate`` da/dv (1|n, 3, 3)."""
        raise NotImplementedError

    def _acts(self, group: Group) -> bool:
        return self.blocks is None or group.block.name in self.blocks

    def _mass(self, group: Group) -> tuple[Floats, Floats | None]:
        """Mass (m, g) at the points, and the part of it that comes with volume where there is a fluid."""
        w = np.zeros((group.m, group.g))
        rows = self.elements.get(group.block.name, slice(None))
        w[rows] = group.wJ0[rows]
        density, grows = group.physics.mass()
        return w * density, None if grows is None else w * grows * group.J

    def residual(self, state: State, groups: list[Group], R: Floats) -> None:
        """Add its forces on the points of ``groups`` to R."""
        for g in groups:
            if self._acts(g):
                a = np.ascontiguousarray(self.acceleration(state, g), dtype=float)
                kernels.force(g.conn, g.N, g.physics.pull * self._mass(g)[0], a, state.layout.u(R))

    def stiffness(self, state: State, groups: Any = None) -> Matrices:
        out: Matrices = []
        for g in groups:
            if not self._acts(g):
                continue
            mass, swelling = self._mass(g)
            heavy = swelling is not None and bool(swelling.any())
            if not (self.moves or heavy):
                continue
            K = np.zeros((g.m, 3 * g.n, 3 * g.n))
            if self.moves:
                rate = self.rate / state.dt if state.dt > 0 else 0.0
                kernels.stiffness(g.N, g.physics.pull * mass, self.alpha * self.gradient(state, g, rate), K)
            if heavy:
                a = np.ascontiguousarray(self.acceleration(state, g), dtype=float)
                kernels.swelling(g.N, g.dN, g.iJ0, g.F, g.J, swelling, a, K)
            out.append((K, np.tile(g.conn, (1, 3)), np.repeat(state.layout.displacement, g.n)))
        return out

    def positions(self, state: State, group: Group) -> Floats:
        """Positions (n, 3) of the points of a group."""
        x = state.x if self.alpha == 1.0 else state.X + self._between(state.u, state.u_old)
        return np.asarray(np.einsum("ga,eai->egi", group.N, x[group.conn]).reshape(-1, 3))

    def velocities(self, state: State, group: Group) -> Floats:
        """Velocities (n, 3) of the points of a group."""
        v = self._between(state.velocity, state.velocity_old)
        return np.asarray(np.einsum("ga,eai->egi", group.N, v[group.conn]).reshape(-1, 3))

    def _between(self, end: Floats, start: Floats) -> Floats:
        """Nodal values at the instant of the step at which generalised-alpha takes its forces."""
        return end if self.alpha == 1.0 else self.alpha * end + (1.0 - self.alpha) * start
