"""What reactive plasticity with and without damage share: the yield surface normal and the return to it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..points import Points
from .base import Floats, Solid, deformed, evaluate
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
        return np.cbrt(1.0 / np.linalg.det(self.Us @ self.left(lam)))

    def F(self, lam: Floats) -> Floats:
        return self.R @ (_sym(self.Ue @ self.left(lam)) * self.beta(lam)[:, None, None])

    def newton(self, lam: Floats, phi: Floats) -> Floats:
        """Step of lam towards phi = 0 by the derivative of U along the normal."""
        beta, ImN = self.beta(lam), self.left(lam)
        dU = -self.Ue @ self.N * beta[:, None, None]
        if self.isochoric:
            dU = dU + self.Ue @ ImN * (_trace(np.linalg.inv(ImN) @ self.N) * beta / 3.0)[:, None, None]
        return -phi / (self.size * _trace(self.N @ _T(dU)))
