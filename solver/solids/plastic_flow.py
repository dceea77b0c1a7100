"""What reactive plasticity with and without damage share: the yield surface normal and the return to it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..kernels import plastic
from ..kernels.return_map import newton, normals, place, polar
from ..matrices import det
from ..points import Points
from ..values import as_value
from .base import Floats, Solid, evaluate
from .batches import states
from .criteria import DeshpandeFleck, DruckerPrager, VonMises
from .natural_neo_hookean import NaturalNeoHookean
from .neo_hookean import NeoHookean, NeoHookeanAD

# what :mod:`..kernels.plastic` knows, by exact type: bases of E and v, criteria and the name of their number
_BASES: dict[type, int] = {
    NeoHookean: plastic.NEO_HOOKEAN,
    NeoHookeanAD: plastic.NEO_HOOKEAN,
    NaturalNeoHookean: plastic.NATURAL_NEO_HOOKEAN,
}
_CRITERIA: dict[type, tuple[int, str]] = {
    VonMises: (plastic.VON_MISES, ""),
    DruckerPrager: (plastic.DRUCKER_PRAGER, "b"),
    DeshpandeFleck: (plastic.DESHPANDE_FLECK, "beta"),
}
_NO_NUMBER = np.zeros(1)


@dataclass(slots=True)
class Families:
    """Bond families of n points at the present: inverse plastic parts ``Us`` (n, f, 9), yield measures ``K`` (n, f),
    ``phase`` (n, f) of :mod:`..kernels.plastic`, stresses ``s`` (n, f + 1, 6) of each and, last, of intact bonds."""

    Us: Floats
    K: Floats
    phase: NDArray[np.int32]
    s: Floats

    @classmethod
    def of(
        cls, base: Any, criterion: Any, pts: Points, old: Floats, active: int, Ky: Floats, rtol: float, iso: int,
        short: bool,
    ) -> Families | None:  # fmt: skip
        """By machine code for all at once; None where the base or the criterion is not known to it.

        ``old`` (n, f, columns), ``active`` and ``short`` as :func:`..kernels.plastic.families` takes them.
        """
        law, known = _BASES.get(type(base)), _CRITERIA.get(type(criterion))
        if law is None or known is None or base.mat_axis is not None:
            return None
        code, name = known
        number = as_value(getattr(criterion, name))(pts.t, pts.X, pts.e) if name else _NO_NUMBER
        n, f = old.shape[:2]
        out = cls(np.empty((n, f, 9)), np.empty((n, f)), np.empty((n, f), np.int32), np.empty((n, f + 1, 6)))
        plastic.families(
            pts.F, pts.J, old, active, Ky, base.par(pts), number, law, code, rtol, iso, short,
            out.Us, out.K, out.phase, out.s,
        )  # fmt: skip
        return out


@dataclass(slots=True)
class Trial:
    """Points of one bond family beyond yield, and the line of states along which it returns.

    U(lam) = sym(Ue (I - lam N)) beta, N the unit normal and ``beta`` keeping the plastic part isochoric;
    F(lam) = R U(lam); see :mod:`..kernels.return_map`.
    """

    base: Solid
    criterion: Any
    at: Points  # the points at the last F(lam)
    Ue: Floats
    Us: Floats  # inverse of the plastic part so far (m, 3, 3)
    R: Floats
    N: Floats
    size: Floats  # of the normal (m,)
    iso: int

    @classmethod
    def start(cls, base: Solid, criterion: Any, pts: Points, Us: Floats, iso: bool) -> Trial:
        """``pts`` under the whole deformation, one for each of m trials; ``Us`` (m, 3, 3)."""
        m = len(Us)
        Fe, R, Ue, Ri, N = (np.empty((m, 3, 3)) for _ in range(5))
        Je, size = np.empty(m), np.empty(m)
        polar(np.ascontiguousarray(pts.F), np.ascontiguousarray(Us), Fe, Je, R, Ue, Ri)
        at = pts.under(Fe, Je)
        s, c = evaluate(base, at)
        normals(s, c, np.ascontiguousarray(criterion.gradient(base, at)), Fe, Ue, Ri, N, size)
        return cls(base, criterion, pts.under(np.empty((m, 3, 3)), np.empty(m)), Ue, Us, R, N, size, int(iso))

    def F(self, lam: Floats) -> Floats:
        """Deformation gradients (m, 3, 3), overwritten by the next call."""
        place(self.R, self.Ue, self.N, self.Us, lam, self.iso, self.at.F, self.at.J)
        return self.at.F

    def measure(self, lam: Floats) -> Floats:
        """The yield measure at F(lam) (m,)."""
        self.F(lam)
        return self.criterion.of(self.base, self.at)  # type: ignore[no-any-return]

    def newton(self, lam: Floats, phi: Floats) -> Floats:
        """Step of lam towards phi = 0 by the derivative of U along the normal."""
        out = np.empty(len(lam))
        newton(self.Ue, self.N, self.Us, self.size, lam, phi, self.iso, out)
        return out


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
    return Points(pts.F[n], pts.J[n], pts.X[n], pts.e[n], pts.t, pts.dt, Q)


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
