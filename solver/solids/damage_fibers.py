"""Fibers softened by how far, and how often, they have been stretched: continuous damage.

Balzani, Brinkhues & Holzapfel, Comput. Methods Appl. Mech. Eng. 213-216 (2012) 139.
"""

from __future__ import annotations

from dataclasses import field
from typing import ClassVar

import numpy as np

from ..points import Points
from ..record import variable_record
from ..special import expi
from .base import Floats, Number, unwritten
from .fiber import directions
from .fourth_invariant import FourthInvariant, invariants
from .registry import register

_NEAR = 1e-9  # of times and energies, as FEBio compares them
_LOG = np.log(0.01)  # 99 % of the saturation is reached at beta_s and gamma_max
#: columns of history: has damage begun, psi of the last state, psi and b where it began, b; then what is written
_BEGUN, _LAST, _START, _B0, _B = range(5)
WRITTEN = ("", "D1", "Ds", "D2", "D3", "P", "Psi0", "beta", "gamma", "D2beta")


@variable_record
class DamagedFiber(FourthInvariant):
    """W = m(P), P = <(1 - D) psi - psi_rest>, D = D1 + D2 from time t0 on.

    D1 = Ds (1 - exp[ln(0.01) beta / beta_s]), Ds = Dmax (1 - exp[ln(0.01) gamma / gamma_max]),
    D2 = D3 (a [exp(b beta) - 1] + c [exp(d beta) - 1]), D3 = D3_inf / (1 + exp[(D3_g0 - gamma) / D3_rg]).
    beta adds up all growth of psi, gamma is the most psi has been above where damage began.
    Subclasses give psi (``strain``) and m (``law``).
    """

    t0: Number = field(default=1e9, kw_only=True)
    Dmax: Number = field(default=1.0, kw_only=True)
    beta_s: Number = field(default=0.0, kw_only=True)
    gamma_max: Number = field(default=0.0, kw_only=True)
    D2_a: Number = field(default=0.0, kw_only=True)
    D2_b: Number = field(default=0.0, kw_only=True)
    D2_c: Number = field(default=0.0, kw_only=True)
    D2_d: Number = field(default=0.0, kw_only=True)
    D3_inf: Number = field(default=0.0, kw_only=True)
    D3_g0: Number = field(default=0.0, kw_only=True)
    D3_rg: Number = field(default=1.0, kw_only=True)
    rest: ClassVar[float] = 1.0
    history = 5 + len(WRITTEN)
    damage: ClassVar[tuple[str, ...]] = (
        "t0", "Dmax", "beta_s", "gamma_max", "D2_a", "D2_b", "D2_c", "D2_d", "D3_inf", "D3_g0", "D3_rg",
    )  # fmt: skip

    def strain(self, own: Floats, i: dict[str, Floats]) -> tuple[Floats, ...]:
        """psi, its derivatives by I1, I4, I5, and the second ones by I1 and I4, and by I4 (1|n,)."""
        raise NotImplementedError

    def law(self, own: Floats, P: Floats) -> tuple[Floats, Floats, Floats]:
        """m, m' and m'' at P >= 0 (n,)."""
        raise NotImplementedError

    def initial(self, n: int) -> Floats:
        out = np.zeros((n, self.history))
        out[:, _LAST] = out[:, 5 + WRITTEN.index("Psi0")] = self.rest
        return out

    def written(self, pts: Points, name: str) -> Floats | None:
        """A value of the state last evaluated (n,), by its name among ``WRITTEN``."""
        return None if pts.new is None else pts.new[:, self.offset + 5 + WRITTEN.index(name)]

    def _split(self, pts: Points) -> tuple[Floats, Floats]:
        """The law's own parameters (k, 1|n), and those of damage."""
        par, k = self.par(pts).T, len(self.damage)
        return par[:-k], par[-k:]

    def _damage(self, pts: Points, psi: Floats) -> tuple[Floats, Floats]:
        """D and dD/dpsi (n,) at the present state."""
        _, (t0, Dmax, beta_s, gamma_max, a, b, c, d, most, g0, rg) = self._split(pts)
        old = self.initial(pts.n) if pts.old is None else pts.old[:, self.offset : self.offset + self.history]
        was = dict(zip(WRITTEN, old[:, 5:].T, strict=True))
        on, begun = pts.t >= t0 - _NEAR, old[:, _BEGUN] > 0
        start = np.where(begun, old[:, _START], old[:, _LAST])
        B0 = np.where(begun, old[:, _B0], old[:, _B] + np.maximum(old[:, _LAST] - was["Psi0"], 0.0))
        B = old[:, _B] + np.maximum(psi - was["Psi0"], 0.0)
        beta, more = np.maximum(B - B0, 0.0), np.maximum(psi - start, 0.0)
        further = more - was["gamma"] > _NEAR
        gamma = np.where(further, more, was["gamma"])
        left = gamma_max > 0
        decay = np.where(left, np.exp(_LOG * gamma / np.where(left, gamma_max, 1.0)), 0.0)
        Ds, dDs = Dmax * (1.0 - decay), -Dmax * np.where(left, _LOG / np.where(left, gamma_max, 1.0), 0.0) * decay
        worn = np.exp(_LOG * beta / beta_s)
        smooth = np.where(rg == 0, 1.0, rg)
        e = np.where(rg == 0, 0.0, np.exp((g0 - gamma) / smooth))
        D3, dD3 = most / (1.0 + e), np.where(rg == 0, 0.0, most * e / smooth / (1.0 + e) ** 2)
        D2 = a * np.expm1(b * beta) + c * np.expm1(d * beta)
        dD2 = a * b * np.exp(b * beta) + c * d * np.exp(d * beta)
        D1 = Ds * (1.0 - worn)
        D = D1 + D3 * D2
        slope = np.where((psi > was["Psi0"]) & (B > B0), D3 * dD2 - Ds * _LOG / beta_s * worn, 0.0)
        slope = slope + np.where(further, dDs * (1.0 - worn) + dD3 * D2, 0.0)
        D, slope = np.where(on, D, was[""]), np.where(on, slope, 0.0)
        if pts.new is not None:
            new = pts.new[:, self.offset : self.offset + self.history]
            new[:] = old
            new[:, _LAST], new[:, 5 + WRITTEN.index("P")] = psi, (1.0 - D) * psi - self.rest
            columns = dict(zip(WRITTEN, (D, D1, Ds, D3 * D2, D3, None, psi, beta, gamma, D2), strict=True))
            keep = (1.0 * on, None, start, B0, B, *columns.values())
            for k, v in enumerate(keep):
                if v is not None:
                    new[:, k] = np.where(on, v, old[:, k])
        return D, slope

    def _chain(self, pts: Points, i: dict[str, Floats]) -> tuple[Floats, ...]:
        """f = m' (1 - D) and df/dpsi, then the derivatives of psi."""
        own, _ = self._split(pts)
        psi, *by = self.strain(own, i)
        D, slope = self._damage(pts, psi)
        P = (1.0 - D) * psi - self.rest
        _, m1, m2 = self.law(own, np.maximum(P, 0.0))
        grown = np.where(P > 0, m2, 0.0) * (1.0 - D - psi * slope)
        return m1 * (1.0 - D), grown * (1.0 - D) - m1 * slope, *by

    def derivatives(self, pts: Points, i: dict[str, Floats]) -> tuple[Floats | float, ...]:
        f, _, p1, p4, p5, _, _ = self._chain(pts, i)
        return f * p1, 0.0, f * p4, f * p5

    def second(self, pts: Points, i: dict[str, Floats]) -> tuple[Floats | float, ...]:
        f, g, p1, p4, p5, p14, p44 = self._chain(unwritten(pts), i)
        return g * p1 * p1, g * p1 * p4 + f * p14, g * p1 * p5, g * p4 * p4 + f * p44, g * p4 * p5, g * p5 * p5

    def energy(self, pts: Points) -> Floats:
        within = unwritten(self.inner(pts))
        own, _ = self._split(within)
        psi = self.strain(own, invariants(within, directions(self.fiber, within), False))[0]
        D, _ = self._damage(within, psi)
        return self.law(own, np.maximum((1.0 - D) * psi - self.rest, 0.0))[0]

    def broken(self, pts: Points) -> Floats | float:
        D = self.written(pts, "")
        return 0.0 if D is None else D


@variable_record
class DamagedFiberPower(DamagedFiber):
    """m = a1 P^a2, psi = kappa I1 + (1 - 3 kappa / 2) (I1 I4 - I5), psi_rest = 2."""

    a1: Number = 0.0
    a2: Number = 0.0
    kappa: Number = 0.0
    parameters = ("a1", "a2", "kappa", *DamagedFiber.damage)
    rest = 2.0

    def strain(self, own: Floats, i: dict[str, Floats]) -> tuple[Floats, ...]:
        kappa, I1, I4 = own[2], i["I1"], i["I4"]
        k = 1.0 - 1.5 * kappa
        return kappa * I1 + k * (I1 * I4 - i["I5"]), kappa + k * I4, k * I1, -k, k, 0.0 * k

    def law(self, own: Floats, P: Floats) -> tuple[Floats, Floats, Floats]:
        a1, a2, _ = own
        some = np.where(P > 0, P, 1.0)
        return a1 * P**a2, a1 * a2 * P ** (a2 - 1), np.where(P > 0, a1 * a2 * (a2 - 1) * some ** (a2 - 2), 0.0)


@variable_record
class DamagedFiberExponential(DamagedFiber):
    """m = k1 / (2 k2) (exp[k2 P^2] - 1), psi = kappa I1 + (1 - 3 kappa) I4, psi_rest = 1."""

    k1: Number = 0.0
    k2: Number = 0.0
    kappa: Number = 0.0
    parameters = ("k1", "k2", "kappa", *DamagedFiber.damage)

    def strain(self, own: Floats, i: dict[str, Floats]) -> tuple[Floats, ...]:
        kappa = own[2]
        k, none = 1.0 - 3.0 * kappa, 0.0 * kappa
        return kappa * i["I1"] + k * i["I4"], kappa, k, none, none, none

    def law(self, own: Floats, P: Floats) -> tuple[Floats, Floats, Floats]:
        k1, k2, _ = own
        e = k1 * np.exp(k2 * P * P)
        return (e - k1) / (2.0 * k2), P * e, e * (1.0 + 2.0 * k2 * P * P)


@variable_record
class DamagedFiberExpLinear(DamagedFiber):
    """(P + 1) m' = c3 (exp[c4 P] - 1) up to P = lambda - 1, then c5 (P + 1) + c6; psi is the stretch, 1 at rest."""

    c3: Number = 0.0
    c4: Number = 0.0
    c5: Number = 0.0
    lambda_: Number = 0.0
    parameters = ("c3", "c4", "c5", "lambda_", *DamagedFiber.damage)

    def strain(self, own: Floats, i: dict[str, Floats]) -> tuple[Floats, ...]:
        l, none = np.sqrt(i["I4"]), 0.0 * own[0]
        return l, none, 0.5 / l, none, none, -0.25 / l**3

    def law(self, own: Floats, P: Floats) -> tuple[Floats, Floats, Floats]:
        c3, c4, c5, lam = own
        toe, l = np.minimum(P, lam - 1.0), P + 1.0
        e = c3 * np.exp(c4 * toe)
        c6 = c3 * np.expm1(c4 * (lam - 1.0)) - c5 * lam
        some = np.where(c4 == 0, 1.0, c4)
        curled = np.exp(-c4) * (expi(some * (toe + 1.0)) - expi(some)) - np.log(toe + 1.0)
        tail = np.maximum(l, lam)
        m = c3 * np.where(c4 == 0, 0.0, curled) + c5 * (tail - lam) + c6 * np.log(tail / lam)
        low = l <= lam
        m1 = np.where(low, (e - c3) / l, c5 + c6 / l)
        return m, m1, np.where(low, (c4 * e - (e - c3) / l) / l, -c6 / l**2)


register(DamagedFiberPower, "damage fiber power")
register(DamagedFiberExponential, "damage fiber exponential")
register(DamagedFiberExpLinear, "damage fiber exp-linear")
