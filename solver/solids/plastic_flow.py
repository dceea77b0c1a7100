"""What reactive plasticity with and without damage share: the yield surface normal and the return to it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..matrices import det, inv
from ..points import Points
from .base import Floats, Solid, deformed, evaluate
from .batches import states
from .voigt import matrix, norm, right_stretch, spectral

_I = np.eye(3)
_WEIGHT = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])
Measure = Callable[[Floats], Floats]


def _T(m: Floats) -> Floats:
    return np.swapaxes(m, -1, -2)


def _trace(m: Floats) -> Floats:
    return np.trace(m, axis1=-2, axis2=-1)


def _sym(m: Floats) -> Floats:
    return 0.5 * (m + _T(m))


def surface_normal(base: Solid, criterion: object, pts: Points) -> Floats:
    """Derivative of the yield measure by U at ``pts`` (n, 3, 3), symmetric."""
    from .voigt import vector

    s, c = evaluate(base, pts)
    d = criterion.gradient(base, pts)  # type: ignore[attr-defined]
    ds = d @ matrix(s)
    assert c is not None
    cd = np.einsum("nij,nj->ni", c, vector(d) * _WEIGHT)
    M = 2.0 * ds - _trace(ds)[:, None, None] * _I + matrix(cd)
    Ui = spectral(_T(pts.F) @ pts.F, lambda w: 1.0 / np.sqrt(w))  # type: ignore[arg-type]
    R = pts.F @ Ui
    return _sym(_T(R) @ M @ R @ Ui)


@dataclass
class Trial:
    """Points of one bond family beyond yield, and the line of states along which it returns.

    U(lam) = sym(Ue (I - lam N)) beta, N the unit normal and ``beta`` keeping the plastic part isochoric;
    F(lam) = R U(lam).
    """

    Ue: Floats
    Us: Floats  # inverse of the plastic part so far (m, 3, 3)
    R: Floats
    N: Floats
    size: Floats  # of the normal (m,)
    isochoric: bool
    measure: Measure  # of a deformation gradient (m, 3, 3)

    @classmethod
    def start(cls, base: Solid, criterion: object, pts: Points, Us: Floats, iso: bool) -> Trial:
        """``pts`` under the whole deformation, one for each of m trials; ``Us`` (m, 3, 3)."""
        F, Fe = pts.F, pts.F @ Us
        R = F @ spectral(_T(F) @ F, lambda w: 1.0 / np.sqrt(w))  # type: ignore[arg-type, operator]

        def measure(F: Floats) -> Floats:
            return criterion.of(base, deformed(pts, F))  # type: ignore[attr-defined, no-any-return]

        N = surface_normal(base, criterion, deformed(pts, Fe))
        size = norm(N)
        return cls(right_stretch(Fe), Us, R, N / size[:, None, None], size, iso, measure)

    def left(self, lam: Floats) -> Floats:
        return _I - self.N * lam[:, None, None]

    def beta(self, lam: Floats) -> Floats:
        if not self.isochoric:
            return np.ones(len(lam))
        return np.cbrt(1.0 / det(self.Us @ self.left(lam)))

    def F(self, lam: Floats) -> Floats:
        return self.R @ (_sym(self.Ue @ self.left(lam)) * self.beta(lam)[:, None, None])

    def newton(self, lam: Floats, phi: Floats) -> Floats:
        """Step of lam towards phi = 0 by the derivative of U along the normal."""
        beta, ImN = self.beta(lam), self.left(lam)
        dU = -self.Ue @ self.N * beta[:, None, None]
        if self.isochoric:
            dU = dU + self.Ue @ ImN * (_trace(inv(ImN) @ self.N) * beta / 3.0)[:, None, None]
        return -phi / (self.size * _trace(self.N @ _T(dU)))


def beyond_yield(
    base: Solid, criterion: object, pts: Points, Us: Floats, Ky: Floats, rtol: float
) -> tuple[Floats, Any]:
    """Yield measures (n, f) of families with inverse plastic parts ``Us`` (n, f, 3, 3), where they are beyond
    yield (n, f; bool)."""
    at = states(pts, pts.F[:, None] @ Us)
    K = criterion.of(base, at).reshape(Ky.shape)  # type: ignore[attr-defined]
    return K, K - Ky > rtol * Ky


def families_at(pts: Points, rows: Floats, f: int) -> Points:
    """The points of selected rows of n f families, under their own whole deformation."""
    n = np.asarray(rows) // f
    Q = pts.Q if pts.Q is None or len(pts.Q) == 1 else pts.Q[n]
    return replace(
        pts, F=pts.F[n], J=pts.J[n], X=pts.X[n], e=pts.e[n], Q=Q, old=None, new=None, extra={}
    )


def mixed_stress(
    base: Solid, pts: Points, Us: Floats, w: Floats, intact: Floats, tangent: bool
) -> tuple[Floats, Floats | None]:
    """intact sigma_0(F) + sum_i w_i sigma_0(F Us_i), and its tangent at fixed plastic parts."""
    n = pts.n
    some = np.flatnonzero((w != 0).any(0))
    k = np.concatenate((intact[:, None], w[:, some]), axis=1)
    F = np.concatenate((pts.F[:, None], pts.F[:, None] @ Us[:, some]), axis=1)
    s, c = evaluate(base, states(pts, F), tangent)
    s = np.einsum("nf,nfi->ni", k, s.reshape(n, -1, 6))
    return s, None if c is None else np.einsum("nf,nfij->nij", k, c.reshape(n, -1, 6, 6))


def mixed_energy(base: Solid, pts: Points, Us: Floats, w: Floats, intact: Floats, isochoric: bool) -> Floats:
    """intact W_0(F) + sum_i w_i W_0(F Us_i) / det Us_i."""
    J = np.ones(w.shape) if isochoric else det(Us)
    W = base.energy(states(pts, pts.F[:, None] @ Us)).reshape(w.shape)
    return intact * base.energy(pts) + (w / J * W).sum(1)
