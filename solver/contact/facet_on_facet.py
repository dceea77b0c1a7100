"""Surfaces that slide on each other, integration points projected on the closest points of the other surface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..kernels import contact
from ..kernels import sliding as kernels
from . import register
from .base import Contact, Floats, Matrices, Progress, Side, matrices
from .penalty import automatic

if TYPE_CHECKING:
    from ..group import Group
    from ..state import State


class ClosestSide(Side):
    """Penetration of each point, and the multiplier of the pressure."""

    memory = (*Side.memory, "multiplier", "gap", "modulus")

    def __init__(self, *args: object) -> None:
        super().__init__(*args)  # type: ignore[arg-type]
        self.multiplier, self.gap = np.zeros(self.n), np.zeros(self.n)
        self.partner_normals = np.zeros((self.n, 3))


@dataclass(eq=False)
class FacetOnFacet(Contact):
    """A pressure p = max(L + eps g, 0) per reference area along the other surface's normal at the closest point.

    FEBio User Manual, "Sliding Facet-on-Facet".
    """

    auto_penalty: bool = False
    gaptol: float = 0.0
    knmult: float = 1.0
    search_tol: float = 0.01
    search_radius: float = 0.0
    seg_up: int = 0
    tolerance: float = 0.01
    side: ClassVar[type[Side]] = ClosestSide
    erodes: ClassVar[bool] = True
    written: ClassVar[float] = -1.0  # sign of the tractions that FEBio writes

    def __post_init__(self) -> None:
        super().__post_init__()
        self._first = True

    def begin(self, state: State, groups: list[Group]) -> None:
        self.open(state)
        self._first = True
        for s in self.passes:
            if self.auto_penalty:
                s.modulus = self.moduli(s, groups)
        self.project(state, True)

    def moduli(self, s: Side, groups: list[Group]) -> Floats:
        """Automatic penalty at the points (q,)."""
        return automatic(s.surface, groups)[s.facet]

    def update(self, state: State, progress: Progress) -> None:
        search = self._first or self.seg_up == 0 or progress.iterations <= self.seg_up
        self._first = False
        self.project(state, search)

    def project(self, state: State, search: bool) -> None:
        x = state.x
        for s in self.passes:
            assert isinstance(s, ClosestSide)
            s.closest(x, self.search_tol, self.search_radius, True, update=search, itself=True)
            o = s.other
            s.shapes(x)
            contact.partner_normals(o.T, x, o.conn, o.count, s.partner, s.rs, s.partner_normals)
            g = -((s.positions(x) - s.place) * s.partner_normals).sum(axis=1) + self.offsets(s)
            s.gap = np.where(s.partner >= 0, g, 0.0)

    def offsets(self, s: Side) -> Floats | float:
        """What the gap counts on top (q,)."""
        return 0.0

    def pressure(self, s: Side, state: State) -> Floats:
        """p (q,), zero where a point has no partner."""
        assert isinstance(s, ClosestSide)
        p = np.maximum(s.multiplier + self.scale(state) * s.modulus * s.gap, 0.0)
        return np.where(s.partner >= 0, p, 0.0)

    def values(self, s: Side, what: str, state: State) -> Floats | None:
        assert isinstance(s, ClosestSide)
        if what == "gap":
            return s.gap
        p = self.net_pressure(s, state)
        return p if what == "pressure" else self.written * p[:, None] * s.partner_normals

    def residual(self, state: State, R: Floats) -> None:
        for s in self.passes:
            assert isinstance(s, ClosestSide)
            f = self.pressure(s, state) * s.reference_area
            s.spread(state, f[:, None] * s.partner_normals, R)

    def stiffness(self, state: State, groups: Any = None) -> Matrices:
        out = []
        for s in self.passes:
            assert isinstance(s, ClosestSide)
            o, eps = s.other, self.scale(state) * s.modulus
            touching = (s.partner >= 0) & (s.multiplier + eps * s.gap >= 0.0)
            stiff, force = eps * s.reference_area, self.pressure(s, state) * s.reference_area
            for rows, a, b, nodes in s.pairs(touching):
                K, unknowns, columns = matrices(state, nodes)
                kernels.stiffness(
                    o.T, state.x, o.conn, s.partner, s.rs, rows, a, b, s.N, s.M, s.partner_normals, s.gap, stiff, force,
                    float(self.knmult), K,
                )  # fmt: skip
                out.append((K, unknowns, columns))
        return out

    def augment(self, done: int, state: State) -> bool:
        """L = p; ends where the relative change of |L| and the mean gap are small."""
        if not self.laugon:
            return True
        new = []
        n0 = n1 = 0.0
        for s in self.sides:
            assert isinstance(s, ClosestSide)
            p = np.maximum(s.multiplier + self.scale(state) * s.modulus * s.gap, 0.0)
            n0 += float((s.multiplier**2).sum())
            n1 += float((p**2).sum())
            new.append(p)
        n0, n1 = np.sqrt(n0), np.sqrt(n1)
        change, gap = abs(n1 - n0) / (n1 or 1.0), self.gap_norm(done)
        good = not (0 < self.tolerance < change) and not (0 < self.gaptol < gap) and done >= self.minaug
        if good or done >= self.maxaug:
            return True
        for s, p in zip(self.sides, new, strict=True):
            s.multiplier = p  # type: ignore[attr-defined]
        return False

    def gap_norm(self, done: int) -> float:
        """Root mean square of the penetrations."""
        g = np.concatenate([s.gap for s in self.sides])  # type: ignore[attr-defined]
        g = g[g > 0.0]
        return float(np.sqrt((g**2).sum() / max(len(g), 1)))


register(FacetOnFacet, "sliding-facet-on-facet")
