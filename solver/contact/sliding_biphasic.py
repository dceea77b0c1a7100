"""Biphasic surfaces that slide on each other: fluid passes where they touch, and drains freely where they do not."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..fields import PRESSURE
from ..kernels import contact as contact_kernels
from ..kernels import contact_flow, ray
from . import register
from .base import Floats, Ints, Matrices, Progress, Side
from .passage import Passage, Passages, Steps, holds
from .penalty import conductance
from .sliding_elastic import SlidingElastic, SlidingPoints
from .surface import Surface

if TYPE_CHECKING:
    from ..group import Group
    from ..state import State


class SlidingFluid(SlidingPoints):
    """At integration points besides: what passes. ``wet``: does any facet hold fluid?"""

    def __init__(self, *args: object) -> None:
        super().__init__(*args)
        self.passages = Passages()

    @property
    def wet(self) -> bool:
        return any(bool(q.own.any()) for q in self.passages)

    def snapshot(self) -> dict[str, Any]:
        return super().snapshot() | {"passages": self.passages.snapshot()}

    def restore(self, saved: dict[str, Any]) -> None:
        own = dict(saved)
        self.passages.restore(own.pop("passages"))
        super().restore(own)


@dataclass(eq=False)
class SlidingBiphasic(SlidingElastic):
    """As :class:`~.sliding_elastic.SlidingElastic`, with a flow L + eps_p (p1 - p2) between porous facets in contact.

    Nodes of porous surfaces that are not in contact have no fluid pressure. Ateshian et al., J. Biomech. Eng. 132
    (2010) 061006; FEBio User Manual, "Sliding-Biphasic".
    """

    pressure_penalty: float = 1.0
    ptol: float = 0.0
    side: ClassVar[type[Side]] = SlidingFluid
    drains: ClassVar[bool] = True
    ctol = 0.0
    RT = 1.0

    def __post_init__(self) -> None:
        super().__post_init__()
        self.knmult = 1  # FEBio has no other tangent here

    @property
    def projected(self) -> list[Side]:
        """A secondary surface that holds fluid is projected, too, for its gaps count when multipliers are augmented."""
        other = self.sides[1]
        assert isinstance(other, SlidingFluid)
        return self.sides if self.laugon and other.wet else self.passes

    def carried(self, groups: list[Group]) -> list[tuple[str, float]]:
        """Fields that pass, and their penalties."""
        return [(PRESSURE.name, self.pressure_penalty)]

    def ambient(self, state: State) -> dict[str, float]:
        """What nodes that touch nothing have, by field."""
        return {PRESSURE.name: 0.0}

    def conductances(self, s: Side, field: str, groups: list[Group]) -> Floats:
        """What the penalty of a field multiplies (q,)."""
        return conductance(s.surface, groups, field)[s.facet] if self.auto_penalty else np.ones(s.n)

    def prepare(self, state: State, groups: list[Group]) -> None:
        super().prepare(state, groups)
        for s, o in (self.sides, reversed(self.sides)):
            assert isinstance(s, SlidingFluid)
            for field, penalty in self.carried(groups):
                own, beyond = (holds(q.surface, groups, field) for q in (s, o))
                k = self.conductances(s, field, groups)
                s.passages.append(Passage(field, penalty, own, beyond, k))

    def update(self, state: State, progress: Progress) -> None:
        super().update(state, progress)
        for s in self.sides:
            assert isinstance(s, SlidingFluid)
            for q in s.passages:
                q.update(s, state)
                q.multiplier = np.where(q.open(s), q.multiplier, 0.0)

    def residual(self, state: State, R: Floats) -> None:
        super().residual(state, R)
        for s in self.passes:
            assert isinstance(s, SlidingFluid)
            bears = self.pressure(s, state) > 0.0
            for q in s.passages:
                q.spread(s, state, state.dt * q.flow(s, bears)[0] * s.detJ * s.surface.weight, R)

    def stiffness(self, state: State, groups: Any = None) -> Matrices:
        out = []
        for s in self.passes:
            assert isinstance(s, SlidingFluid)
            kinds = self.tangents(s, state)
            flows = [q.flow(s, self.pressure(s, state) > 0.0) for q in s.passages]
            for acting, tangent in kinds:
                for rows, a, b, nodes in s.pairs(acting):
                    for i, (q, flow) in enumerate(zip(s.passages, flows, strict=True)):
                        K, unknowns, columns = q.unknowns(state, nodes)
                        if i == 0:
                            tangent(s, state, rows, a, b, K)
                        self.passing(s, state, q, flow, rows, a, b, K)
                        out.append((K, unknowns, columns))
        return out

    def passing(
        self, s: Side, state: State, q: Passage, flow: tuple[Floats, Floats], rows: Ints, a: int, b: int, K: Floats
    ) -> None:  # fmt: skip
        """Add the tangents of what passes between points that slide; ``flow``: wn and eps (q,)."""
        assert isinstance(s, SlidingFluid)
        w, o, values = s.surface, s.other, np.ascontiguousarray(state.layout.scalar(state.d, q.field))
        contact_flow.sliding(
            w.T, state.x, values, w.conn, w.facet, o.conn, s.partner, s.rs, rows, a, b, w.N, w.G, s.M, w.weight,
            s.normals, s.gap, *flow, state.dt, K,
        )  # fmt: skip

    def augment(self, done: int, state: State) -> bool:
        """As sliding contact, the flows' multipliers too; differences over tractions are small at the end."""
        if not self.laugon:
            return True
        steps = Steps()
        for s in self.sides:
            assert isinstance(s, SlidingFluid)
            new = self.renewed(s, state)
            for q in s.passages:
                touching = (new > 0.0) & q.own.any()
                q.multiplier = np.where(touching, q.multiplier + q.penalty * q.conductance * q.step, 0.0)
                steps.add(q, touching)
        before, after, gap = self.renew(state)
        good = self.settled(done, before, after, gap, state)
        return (good and not steps.loose(after, self.tolerance, self.ptol, self.ctol, self.RT)) or done >= self.maxaug

    # ---- free draining ----------------------------------------------------------------------------
    def drained(self, state: State) -> tuple[Ints, Ints]:
        """Nodes of porous surfaces, and those of them that are in contact."""
        nodes, touching = [], []
        for s in self.sides:
            assert isinstance(s, SlidingFluid)
            if s.wet:
                nodes.append(s.surface.nodes)
        for s in self.passes:
            p = self._nodal_pressure(s, state)
            touching.append(s.surface.nodes[p > 0.0])
            o = next(q for q in self.sides if q is not s)
            assert isinstance(o, SlidingFluid)
            if o.wet:
                touching.append(o.surface.nodes[self._met(s.surface, o.surface, p, state) > 0.0])
        return (np.concatenate(q) if q else np.zeros(0, np.int64) for q in (nodes, touching))  # type: ignore[return-value]

    def _nodal_pressure(self, s: Side, state: State) -> Floats:
        """Mean pressure over the facets around each node (m,) that bear any."""
        w, mean = s.surface, s.surface.means(self.net_pressure(s, state), False)
        use = (w.local >= 0) & (mean > 0.0)[:, None]
        count = np.bincount(w.local[use], minlength=len(w.nodes))
        total = np.bincount(w.local[use], np.broadcast_to(mean[:, None], use.shape)[use], len(w.nodes))
        return np.asarray(total / np.maximum(count, 1))

    def _met(self, primary: Surface, other: Surface, p: Floats, state: State) -> Floats:
        """Pressure of the primary surface where the normals of the other's nodes meet it (0 elsewhere)."""
        x, n = state.x, len(other.nodes)
        partner, rs = np.full(n, -1), np.zeros((n, 2))
        primary.facet_tree.fit(x, 2 * self.search_tol)
        ray.find(
            primary.T, x, primary.conn, primary.count, primary.facet_tree.order, primary.facet_tree.boxes,
            x[other.nodes], other.nodal_normals(x), self.search_tol, self.search_radius, False, False, True, partner,
            rs,
        )  # fmt: skip
        M, place = np.zeros((n, 9)), np.zeros((n, 3))
        contact_kernels.partners(primary.T, x, primary.conn, primary.count, partner, rs, M, place)
        value = (M * np.where(primary.local >= 0, p[primary.local], 0.0)[partner]).sum(axis=1)
        return np.where(partner >= 0, value, 0.0)


register(SlidingBiphasic, "sliding-biphasic")
