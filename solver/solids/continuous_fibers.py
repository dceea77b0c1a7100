"""Fibers in all directions with a continuous angular density."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..kernels.directions import turn
from ..points import Points
from .base import Floats, Property, Solid
from .fiber import FiberLaw, part, prestretched
from .registry import register
from .schemes import Scheme
from .uncoupled import Uncoupled

_BATCH = 1 << 18  # directions held at a time


@dataclass(eq=False)
class _Continuous:
    fibers: FiberLaw | None = None
    distribution: Any = None
    scheme: Any = None

    def _family(self, pts: Points) -> tuple[Floats, Floats]:
        """Directions (1|n, m, 3) and weights (1|n, m) that sum to one over the whole sphere."""
        N, w = self.scheme.whole()
        density = (self.distribution(pts, N) * w).sum(1, keepdims=True)
        density = np.where(density == 0, 1.0, density)
        if type(self.scheme).taut is not Scheme.taut:
            C = np.swapaxes(pts.F, 1, 2) @ pts.F
            if self.iso:  # type: ignore[attr-defined]
                C = C * pts.J[:, None, None] ** (-2.0 / 3.0)
            N, w = self.scheme.taut(C)
        w = self.distribution(pts, N) * w / density
        if pts.Q is not None:
            N = turned(N, pts.Q)
        return prestretched(np.ascontiguousarray(N), pts), np.ascontiguousarray(w)

    def _parts(self, pts: Points) -> list[slice]:
        m = self.scheme.whole()[1].shape[1]
        step = max(1, _BATCH // m)
        return [slice(a, min(a + step, pts.n)) for a in range(0, pts.n, step)]

    def _add(self, pts: Points, s: Floats, c: Floats | None) -> None:
        within = self.inner(pts)  # type: ignore[attr-defined]
        for at in self._parts(pts):
            here = part(within, at)
            A, w = self._family(here)
            self.fibers.add(here, A, w, s[at], None if c is None else c[at])  # type: ignore[union-attr]

    def _energy(self, pts: Points) -> Floats:
        within = self.inner(pts)  # type: ignore[attr-defined]
        out = np.empty(pts.n)
        for at in self._parts(pts):
            here = part(within, at)
            A, w = self._family(here)
            out[at] = self.fibers.sum_energy(here, A, w)  # type: ignore[union-attr]
        return out


def turned(N: Floats, Q: Floats) -> Floats:
    """Q N for directions N (1|n, m, 3) and axes Q (1|n, 3, 3)."""
    out = np.empty((max(len(N), len(Q)), *N.shape[1:]))
    turn(N, np.ascontiguousarray(Q), out)
    return out


def _properties(table: str) -> dict[str, Property]:
    return {
        "fibers": Property(table),
        "distribution": Property("distribution"),
        "scheme": Property("scheme"),
    }


@dataclass(eq=False)
class ContinuousFibers(_Continuous, Solid):
    """sigma = sum_j w_j R(N_j) sigma_fiber(N_j) / sum_j w_j R(N_j).

    Hou & Ateshian, Comput. Methods Biomech. Biomed. Eng. 19 (2016) 1437.
    """

    properties = _properties("fiber")
    iso = False

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        self._add(pts, s, c)

    def energy(self, pts: Points) -> Floats:
        return self._energy(pts)


@dataclass(eq=False)
class ContinuousFibersUncoupled(_Continuous, Uncoupled):
    """:class:`ContinuousFibers` of nearly incompressible fibers."""

    properties = _properties("fiber")
    iso = True

    def dev(self, pts: Points, s: Floats, c: Floats | None) -> None:
        self._add(pts, s, c)

    def dev_energy(self, pts: Points) -> Floats:
        return self._energy(pts)


register(ContinuousFibers, "continuous fiber distribution")
register(ContinuousFibersUncoupled, "continuous fiber distribution uncoupled")
