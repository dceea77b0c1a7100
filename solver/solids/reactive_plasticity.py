"""Plasticity by bonds that break where a yield measure is reached and reform in the deformed state."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..kernels.plastic import yielded
from ..kernels.return_map import advance
from ..matrices import inv
from ..points import Points
from .base import Floats, Number, Property, Solid, unwritten
from .plastic_flow import Families, Trial, beyond_yield, families_at, mixed_energy, mixed_stress
from .registry import register
from .secant import secant_tangent

_EACH = 12  # per family: inverse plastic part (9), yield measure, fraction, yielded before
_K, _W, _Y = 9, 10, 11
_ROUNDS = 20


def return_to_surface(trial: Trial, Ky: Floats, rtol: float) -> tuple[Floats, Floats]:
    """Deformation gradients (m, 3, 3) on the yield surface, and the last yield measure (m,).

    Newton's steps along the normal, every third replaced by a root of the parabola through the last three.
    """
    m = len(Ky)
    lam, phi, other = np.zeros(m), np.zeros(m), np.full(m, np.nan)
    l, p, live = np.zeros((3, m)), np.zeros((3, m)), np.ones(m, bool)
    line = trial.Ue, trial.N, trial.Us, trial.size, trial.iso
    for k in range(2 * _ROUNDS):
        value = trial.measure(lam) - Ky
        if not advance(k, _ROUNDS, rtol, value, *line, lam, phi, other, l, p, live):
            break
    return trial.F(lam), phi + Ky


@dataclass(eq=False)
class ReactivePlasticity(Solid):
    """sigma = (1 - sum w_i) sigma_0(F) + sum_i w_i sigma_0(F Fp_i^-1) over the yielded bond families i.

    Each family breaks at its yield measure and reforms so that the measure stays there. Zimmerman, Jiang &
    Ateshian, J. Biomech. Eng. 143 (2021) 041002. History: per family Fp^-1, yield measure, fraction, yielded.
    """

    consistent = False
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

    def _flow(self, pts: Points, old: Floats) -> tuple[Floats, Floats]:
        """Inverse plastic parts (n, nf, 3, 3) and fractions (n, nf) of the families, ``old`` (n, nf, 12), now."""
        base: Any = self.elastic
        state = old.copy()
        n, f = state.shape[:2]
        rtol = float(self.par(pts)[0, 0])
        Ky, share = self.flow_curve.families(pts)
        Ky = np.broadcast_to(Ky, (n, f))
        Us = state[:, :, :9].reshape(n, f, 3, 3)
        Ku = state[:, :, _K].copy()
        Kv, beyond = beyond_yield(base, self.yield_criterion, pts, Us, Ky, rtol)
        fresh = beyond & (Kv > Ku) & (Ku < Ky * (1 + rtol))
        w = np.where(fresh, share[:, :f], state[:, :, _W])
        rows: Any = np.flatnonzero(beyond)
        if len(rows):
            here = families_at(pts, rows, f)
            flat, K = Us.reshape(-1, 3, 3).copy(), Kv.ravel()
            trial = Trial.start(base, self.yield_criterion, here, flat[rows], bool(self.isochoric))
            F, K[rows] = return_to_surface(trial, Ky.ravel()[rows], rtol)
            flat[rows] = inv(here.F) @ F
            Us, Kv = flat.reshape(n, f, 3, 3), K.reshape(n, f)
        yielded = state[:, :, _Y] > 0
        w = np.where((w > 0) & ~yielded & (Kv < Ky / (1 + rtol)), 0.0, w)
        if pts.new is not None:
            state[:, :, :9], state[:, :, _K], state[:, :, _W] = Us.reshape(n, f, 9), Kv, w
            state[:, :, _Y] = yielded | (w > 0)
            pts.new[:, self.offset : self.offset + self.history] = state.reshape(n, -1)
        return Us, w

    def _cauchy(self, pts: Points, old: Floats) -> Floats:
        """Stress (n, 6); by machine code, where it knows base and criterion."""
        rtol = float(self.par(pts)[0, 0])
        Ky, share = self.flow_curve.families(pts)
        iso = int(bool(self.isochoric))
        found = Families.of(self.elastic, self.yield_criterion, pts, old, _W, Ky, rtol, iso, False)
        if found is None:
            return self._sum(pts, old, False)[0]
        s, new = np.zeros((pts.n, 6)), np.empty(old.shape if pts.new is not None else (0, *old.shape[1:]))
        yielded(old, found.Us, found.K, found.phase, Ky, share, rtol, found.s, s, new)
        if pts.new is not None:
            pts.new[:, self.offset : self.offset + self.history] = new.reshape(pts.n, -1)
        return s

    def _sum(self, pts: Points, old: Floats, tangent: bool) -> tuple[Floats, Floats | None]:
        Us, w = self._flow(pts, old)
        return mixed_stress(self.elastic, pts, Us, w, 1.0 - w.sum(1), tangent)  # type: ignore[arg-type]

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        within = self.inner(pts)
        old = np.ascontiguousarray(self._old(within))
        if c is not None and not self.secant_tangent:
            si, ci = self._sum(within, old, True)
            s += si
            c += ci  # type: ignore[arg-type]
            return
        s += self._cauchy(within, old)
        if c is not None:
            c += secant_tangent(lambda p: self._cauchy(p, np.repeat(old, 7, axis=0)), within)

    def energy(self, pts: Points) -> Floats:
        within = self.inner(unwritten(pts))
        Us, w = self._flow(within, self._old(within))
        base: Any = self.elastic
        return mixed_energy(base, within, Us, w, 1.0 - w.sum(1), bool(self.isochoric))


register(ReactivePlasticity, "reactive plasticity")
