"""Fibers of entropic chains (inverse Langevin)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..points import Points
from .base import Floats, Number
from .fiber import Fiber, FiberLaw, UncoupledFiber
from .inverse_langevin import COEFFICIENTS, even_series
from .registry import register


@dataclass(eq=False)
class _Chain(FiberLaw):
    """dW/dIn = ksi (g(In/N) - g(1/N)) / 2, g(x^2) = beta / x with beta the inverse Langevin function of x."""

    def _three(self, pts: Points) -> tuple[Floats, Floats, Floats]:
        par = self.par(pts).T[:, :, None]  # type: ignore[attr-defined]
        return par[0], par[1], par[2] if len(par) > 2 else np.zeros((1, 1))

    def tension(self, pts: Points, In: Floats, sn: Floats, cn: Floats) -> Floats:
        N, ksi, mu = self._three(pts)
        g, slope = even_series(In / N, self.n_term)  # type: ignore[attr-defined]
        rest = even_series(1.0 / N, self.n_term)[0]  # type: ignore[attr-defined]
        on = In - 1.0 > np.finfo(float).eps
        sn[:] = np.where(on, In * ksi * (g - rest), 0.0)
        cn[:] = np.where(on, 2.0 * In * In * ksi / N * slope, 0.0)
        return np.ascontiguousarray(np.where(on, mu, 0.0)) if mu.any() else np.empty((0, 0))

    def shears(self, pts: Points) -> bool:
        return bool(self._three(pts)[2].any())

    def fiber_energy(self, pts: Points, In: Floats) -> Floats:
        N, ksi, _ = self._three(pts)
        c: Floats = np.array(list(COEFFICIENTS[: int(self.n_term)]))  # type: ignore[attr-defined]
        integral = np.append(0.0, c / np.arange(1, len(c) + 1))
        x = np.maximum(In, 1.0)
        poly = np.polynomial.polynomial.polyval
        rest = even_series(1.0 / N, self.n_term)[0]  # type: ignore[attr-defined]
        return 0.5 * ksi * (N * (poly(x / N, integral) - poly(1.0 / N, integral)) - rest * (x - 1.0))

    def shear_energy(self, pts: Points, A: Floats, In: Floats) -> Floats | float:
        _, _, mu = self._three(pts)
        if not mu.any():
            return 0.0
        C = np.swapaxes(pts.F, 1, 2) @ pts.F
        Ca = np.einsum("nij,nmj->nmi", C, np.broadcast_to(A, (pts.n, *A.shape[1:])))
        return np.where(In > 1.0, 0.25 * mu * ((Ca**2).sum(2) - 2.0 * (In - 1.0) - 1.0), 0.0)


@dataclass(eq=False)
class FiberEntropyChain(_Chain, Fiber):
    """A chain of N segments in tension, with a shear term mu."""

    N: Number = 1.0
    ksi: Number = 0.0
    mu: Number = 0.0
    n_term: int = 30
    parameters = ("N", "ksi", "mu")
    options = ("n_term",)


@dataclass(eq=False)
class FiberEntropyChainUncoupled(_Chain, UncoupledFiber):
    """A chain of N segments in distortional tension."""

    N: Number = 1.0
    ksi: Number = 0.0
    n_term: int = 30
    parameters = ("N", "ksi")
    options = ("n_term",)


for _table in ("solid", "fiber"):
    register(FiberEntropyChain, "fiber-entropy-chain", _table)
    register(FiberEntropyChainUncoupled, "uncoupled fiber-entropy-chain", _table)
