"""Plasticity by bonds that break where a yield measure is reached and reform in the deformed state."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..points import Points
from .base import Floats, Number, Property, Solid, deformed, evaluate
from .fiber import part
from .plastic_flow import Trial
from .registry import register
from .secant import secant_tangent

_EACH = 12  # per family: inverse plastic part (9), yield measure, fraction, yielded before
_K, _W, _Y = 9, 10, 11
_ROUNDS = 20


def _parabola(l: Floats, p: Floats) -> tuple[Floats, Floats, Floats]:
    """a, b, c of the parabola through three points (l, p), each (3, m); the line's sums where two coincide."""
    l0, l1, l2 = l
    p0, p1, p2 = p
    d = (l0 - l1) * (l0 - l2) * (l1 - l2)
    some = np.where(d == 0, 1.0, d)
    a = (l2 * (p1 - p0) + l1 * (p0 - p2) + l0 * (p2 - p1)) / some
    b = (l2**2 * (p0 - p1) + l0**2 * (p1 - p2) + l1**2 * (p2 - p0)) / some
    c = (l0 * l2 * (l2 - l0) * p1 + l1**2 * (l2 * p0 - l0 * p2) + l1 * (p2 * l0**2 - p0 * l2**2)) / some
    return np.where(d == 0, 0.0, a), np.where(d == 0, 0.0, b), np.where(d == 0, 0.0, c)


def _guess(l: Floats, p: Floats) -> tuple[Floats, Floats, Floats]:
    """Root of the parabola through three trials, its second root (nan where none), and the parabola there."""
    a, b, c = _parabola(l, p)
    flat = a == 0
    safe = np.where(flat, 1.0, a)
    disc = b * b - 4 * a * c
    root = np.sqrt(np.maximum(disc, 0.0))
    r1, r2 = (-b + root) / (2 * safe), (-b - root) / (2 * safe)
    small, large = np.where(np.abs(r1) < np.abs(r2), r1, r2), np.where(np.abs(r1) >= np.abs(r2), r1, r2)
    apart = r1 * r2 < 0
    lam = np.where(apart, np.maximum(r1, r2), small)
    other = np.where(apart | flat | (disc < 0), np.nan, large)
    sx, sy = l.sum(0), p.sum(0)
    spread = 3 * (l**2).sum(0) - sx**2
    slope = (3 * (l * p).sum(0) - sx * sy) / np.where(spread == 0, 1.0, spread)
    line = -((sy - slope * sx) / 3) / np.where(slope == 0, 1.0, slope)
    none = np.where(line < 0, -b / (2 * safe), line)
    lam = np.where(disc < 0, none, lam)
    lam = np.where(flat, np.where(b != 0, -c / np.where(b == 0, 1.0, b), 0.0), lam)
    coincide = (l[0] == l[1]) | (l[0] == l[2]) | (l[1] == l[2])
    lam = np.where(coincide, np.where(l[0] == l[1], l[1], l[2]), lam)
    return lam, np.where(coincide, np.nan, other), a * lam**2 + b * lam + c


def return_to_surface(trial: Trial, Ky: Floats, rtol: float) -> tuple[Floats, Floats]:
    """Deformation gradients (m, 3, 3) on the yield surface, and the last yield measure (m,).

    Newton's steps along the normal, every third replaced by a root of the parabola through the last three.
    """
    m = len(Ky)
    lam, phi = np.zeros(m), np.zeros(m)
    other = np.full(m, np.nan)
    l, p = np.zeros((3, m)), np.zeros((3, m))
    live = np.ones(m, bool)
    for k in range(2 * _ROUNDS):
        value = trial.measure(trial.F(lam)) - Ky
        it = k % 3
        l[it], p[it] = np.where(live, lam, l[it]), np.where(live, value, p[it])
        nxt = lam + trial.newton(lam, value)
        now = value
        if it == 2:
            nxt, second, now = _guess(l, p)
            other = np.where(live & ~np.isnan(second), second, other)
        lam, phi = np.where(live, nxt, lam), np.where(live, now, phi)
        live = live & ~(np.abs(phi) <= rtol)
        if k >= _ROUNDS:
            retry = live & ~np.isnan(other)
            lam, other = np.where(retry, other, lam), np.where(retry, np.nan, other)
            live = retry
        if not live.any():
            break
    return trial.F(lam), phi + Ky


@dataclass(eq=False)
class ReactivePlasticity(Solid):
    """sigma = (1 - sum w_i) sigma_0(F) + sum_i w_i sigma_0(F Fp_i^-1) over the yielded bond families i.

    Each family breaks at its yield measure and reforms so that the measure stays there. Zimmerman, Jiang &
    Ateshian, J. Biomech. Eng. 143 (2021) 041002. History: per family Fp^-1, yield measure, fraction, yielded.
    """

    elastic: Solid | None = None
    yield_criterion: Any = None
    flow_curve: Any = None
    isochoric: int = 1
    rtol: Number = 1e-4
    secant_tangent: int = 1
    parameters = ("rtol",)
    options = ("isochoric", "secant_tangent")
    properties = {
        "elastic": Property("solid"),
        "yield_criterion": Property("criterion"),
        "flow_curve": Property("flow_curve"),
    }
    symmetric = False
    history: int = field(default=0, init=False, repr=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        self.history = _EACH * (self.flow_curve.size if self.flow_curve is not None else 0)

    def initial(self, n: int) -> Floats:
        out = np.zeros((n, self.history // _EACH, _EACH))
        out[:, :, :9] = np.eye(3).ravel()
        return out.reshape(n, -1)

    def _old(self, pts: Points) -> Floats:
        if pts.old is None:
            return self.initial(pts.n).reshape(pts.n, -1, _EACH)
        return pts.old[:, self.offset : self.offset + self.history].reshape(pts.n, -1, _EACH)

    def _flow(self, pts: Points) -> tuple[Floats, Floats]:
        """Inverse plastic parts (n, nf, 3, 3) and fractions (n, nf) of the families at the present state."""
        state = self._old(pts).copy()
        rtol = float(self.par(pts)[0, 0])
        Ky, share = self.flow_curve.families(pts)
        for i in range(state.shape[1]):
            self._family(pts, state[:, i], np.broadcast_to(Ky[:, i], (pts.n,)), share[:, i], rtol)
        if pts.new is not None:
            out = state.copy()
            out[:, :, _Y] = np.where(out[:, :, _W] > 0, 1.0, out[:, :, _Y])
            pts.new[:, self.offset : self.offset + self.history] = out.reshape(pts.n, -1)
        return state[:, :, :9].reshape(pts.n, -1, 3, 3), state[:, :, _W]

    def _family(self, pts: Points, state: Floats, Ky: Floats, share: Floats, rtol: float) -> None:
        """Bring one family (n, 12) from the old state to the present."""
        base: Any = self.elastic
        Ku = state[:, _K].copy()
        Us = state[:, :9].reshape(-1, 3, 3)
        Kv = self.yield_criterion.of(base, deformed(pts, pts.F @ Us))
        beyond = Kv - Ky > rtol * Ky
        fresh = beyond & (Kv > Ku) & (Ku < Ky * (1 + rtol))
        state[:, _W] = np.where(fresh, share, state[:, _W])
        at: Any = np.flatnonzero(beyond)
        if len(at):
            here = part(pts, at)
            trial = Trial.start(base, self.yield_criterion, here, Us[at], bool(self.isochoric))
            F, Kv[at] = return_to_surface(trial, Ky[at], rtol)
            state[at, :9] = (np.linalg.inv(here.F) @ F).reshape(-1, 9)
        state[:, _K] = Kv
        shy = (state[:, _W] > 0) & (state[:, _Y] == 0) & (Kv < Ky / (1 + rtol))
        state[:, _W] = np.where(shy, 0.0, state[:, _W])

    def _cauchy(self, pts: Points) -> Floats:
        return self._sum(pts, False)[0]

    def _sum(self, pts: Points, tangent: bool) -> tuple[Floats, Floats | None]:
        base: Any = self.elastic
        Us, w = self._flow(pts)
        s, c = evaluate(base, pts, tangent)
        k = 1.0 - w.sum(1)
        s = s * k[:, None]
        c = None if c is None else c * k[:, None, None]
        for i in range(w.shape[1]):
            if w[:, i].any():
                si, ci = evaluate(base, deformed(pts, pts.F @ Us[:, i]), tangent)
                s = s + w[:, i, None] * si
                c = None if c is None or ci is None else c + w[:, i, None, None] * ci
        return s, c

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        within = self.inner(pts)
        exact = c is not None and not self.secant_tangent
        si, ci = self._sum(within, exact)
        s += si
        if c is not None:
            c += ci if exact and ci is not None else secant_tangent(self._cauchy, within)

    def broken(self, pts: Points) -> Floats | float:
        return 0.0

    def energy(self, pts: Points) -> Floats:
        within = self.inner(pts)
        base: Any = self.elastic
        Us, w = self._flow(within)
        W = base.energy(within) * (1.0 - w.sum(1))
        for i in range(w.shape[1]):
            Jp = np.ones(pts.n) if self.isochoric else np.linalg.det(Us[:, i])
            W = W + w[:, i] / Jp * base.energy(deformed(within, within.F @ Us[:, i]))
        return W


register(ReactivePlasticity, "reactive plasticity")
