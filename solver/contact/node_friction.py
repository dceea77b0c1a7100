"""Nodes that slide on facets with friction."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..kernels import node_friction as kernels
from . import register
from .base import Floats, Matrices, Side, matrices
from .facet_on_facet import ClosestSide
from .node_on_facet import NodeOnFacet

if TYPE_CHECKING:
    from ..state import State


class FrictionNodes(ClosestSide):
    """At nodes besides: first places on the partners, multipliers of the tangential traction, metrics."""

    memory = (*ClosestSide.memory, "first", "tangential")

    def __init__(self, *args: object) -> None:
        super().__init__(*args)
        self.first, self.tangential = np.zeros((self.n, 2)), np.zeros((self.n, 2))
        self.metric = np.zeros((self.n, 3))


@dataclass(eq=False)
class NodeFriction(NodeOnFacet):
    """As :class:`~.node_on_facet.NodeOnFacet`, with Coulomb friction and the tangential penalty ``fric_penalty``.

    FEBio User Manual, "Sliding Node-on-Facet". Without ``ktmult`` the tangent of nodes that slip has no friction.
    """

    fric_coeff: float = 0.0
    fric_penalty: float = 0.0
    side: ClassVar[type[Side]] = FrictionNodes

    def project(self, state: State, search: bool) -> None:
        before = [s.partner.copy() for s in self.passes]
        super().project(state, search)
        for s, old in zip(self.passes, before, strict=True):
            assert isinstance(s, FrictionNodes)
            o, new = s.other, (old < 0) & (s.partner >= 0)
            s.first[new] = s.rs[new]
            kernels.carry(o.T, state.x, state.X, o.conn, o.count, old, s.partner, s.rs, s.first, s.tangential)
            s.tangential[s.partner < 0] = s.multiplier[s.partner < 0] = 0.0
            kernels.metrics(o.T, state.X, o.conn, o.count, s.partner, s.rs, s.metric)

    def tangential(self, s: FrictionNodes, most: Floats, eps: float) -> Floats:
        """Tangential tractions (q, 2) of size ``most`` (q,) at most."""
        out = np.zeros((s.n, 2))
        kernels.trials(s.partner, s.metric, s.tangential, s.rs, s.first, eps, most, out)
        return out

    def residual(self, state: State, R: Floats) -> None:
        super().residual(state, R)
        for s in self.passes:
            assert isinstance(s, FrictionNodes)
            o, t = s.other, self.tangential(s, self.fric_coeff * self.pressure(s, state), self.fric_penalty)
            kernels.force(
                o.T, state.x, s.surface.nodes, o.conn, o.count, s.partner, s.rs, s.N, s.M, s.partner_normals, s.gap, t,
                s.reference_area, state.layout.u(R),
            )  # fmt: skip

    def stiffness(self, state: State, groups: Any = None) -> Matrices:
        out = super().stiffness(state, groups)
        for s in self.passes:
            assert isinstance(s, FrictionNodes)
            # FEBio tells who sticks without the penalty
            T = self.tangential(s, np.full(s.n, np.inf), 1.0)
            o, sticks = s.other, (s.gap >= 0.0) & (_size(s.metric, T) <= self.fric_coeff * self.pressure(s, state))
            for rows, _, b, nodes in s.pairs(sticks):
                K, unknowns, columns = matrices(state, nodes)
                kernels.stick(
                    o.T, state.x, o.conn, s.partner, s.rs, rows, b, s.N, s.M, s.partner_normals, s.gap, s.metric,
                    self.fric_penalty * s.reference_area, K,
                )  # fmt: skip
                out.append((K, unknowns, columns))
        return out

    def augment(self, done: int, state: State) -> bool:
        """Multipliers of pressures and tangential tractions; first places move on at the end, as in FEBio."""
        if not self.laugon:
            return True
        n0 = n1 = 0.0
        new = []
        for s in self.sides:
            assert isinstance(s, FrictionNodes)
            p = np.maximum(s.multiplier + self.scale(state) * s.modulus * s.gap, 0.0)
            held = s.partner >= 0
            T = self.tangential(s, self.fric_coeff * s.multiplier, self.fric_penalty)
            n0 += float((s.multiplier**2).sum() + (_size(s.metric, s.tangential)[held] ** 2).sum())
            n1 += float((p**2).sum() + (_size(s.metric, T)[held] ** 2).sum())
            new.append(p)
        n0, n1 = float(np.sqrt(n0)), float(np.sqrt(n1))
        change, gap = abs(n1 - n0) / (n1 or 1.0), self.gap_norm(done)
        good = not (0 < self.tolerance < change) and not (0 < self.gaptol < gap) and done >= self.minaug
        ended = good or done >= self.maxaug
        for s, p in zip(self.sides, new, strict=True):
            assert isinstance(s, FrictionNodes)
            if ended:
                s.first = s.rs.copy()
            else:
                s.multiplier = p
                s.tangential = self.tangential(s, self.fric_coeff * p, self.fric_penalty)
        return ended


def _size(m: Floats, T: Floats) -> Floats:
    """sqrt(T . M^-1 . T) (q,); 0 where there is no metric."""
    det = m[:, 0] * m[:, 2] - m[:, 1] ** 2
    h = m[:, 2] * T[:, 0] ** 2 - 2 * m[:, 1] * T[:, 0] * T[:, 1] + m[:, 0] * T[:, 1] ** 2
    return np.sqrt(np.maximum(np.divide(h, det, out=np.zeros_like(h), where=det != 0.0), 0.0))


register(NodeFriction, "sliding-node-on-facet with friction")
