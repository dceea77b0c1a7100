"""Reactive plasticity whose intact and yielded bonds also fail for good."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..kernels.plastic import FRESH
from ..matrices import inv
from ..points import Points
from .base import Floats, Number, Property, Solid, unwritten
from .batches import states
from .plastic_flow import Families, Trial, beyond_yield, families_at, mixed_energy, mixed_stress
from .registry import register
from .secant import secant_tangent

_EACH = 16  # per family: inverse plastic part (9), yield measure, fraction, d_i, d_y, largest yielded measure,
_K, _W, _DI, _DY, _E, _B, _T = range(9, 16)  # yielded, yielding
_HEAD = 2  # largest measure of the intact bonds, fraction broken


def return_to_surface(trial: Trial, Ky: Floats, rtol: float) -> tuple[Floats, Floats]:
    """Deformation gradients near the yield surface after at most two Newton steps and one parabola."""
    m = len(Ky)
    lam, live = np.zeros(m), np.ones(m, bool)
    l, p = np.zeros((3, m)), np.zeros((3, m))
    for k in range(3):
        phi = trial.measure(lam) - Ky
        l[k], p[k] = lam, phi
        step = trial.newton(lam, phi)
        nxt = lam + step
        if k == 2:
            nxt = _root(l, p)
        lam = np.where(live, nxt, lam)
        live = live & ~((np.abs(step) <= rtol * np.abs(lam)) | (np.abs(lam) <= rtol * rtol))
        if not live.any():
            break
    K = trial.measure(lam)
    return trial.at.F, K


def _root(l: Floats, p: Floats) -> Floats:
    """Root nearest to zero of the parabola through (0, p0), (l1, p1), (l2, p2)."""
    _, l1, l2 = l
    p0, p1, p2 = p
    d = l1 * l2 * (l1 - l2)
    some = np.where(d == 0, 1.0, d)
    a = (l2 * (p1 - p0) - l1 * (p2 - p0)) / some
    b = ((p2 - p0) * l1 * l1 - (p1 - p0) * l2 * l2) / some
    disc, flat = b * b - 4 * a * p0, a == 0
    safe, root = np.where(flat, 1.0, a), np.sqrt(np.maximum(disc, 0.0))
    r1, r2 = (-b + root) / (2 * safe), (-b - root) / (2 * safe)
    lam = np.where(np.abs(r1) < np.abs(r2), r1, r2)
    lam = np.where(flat, np.where(b != 0, -p0 / np.where(b == 0, 1.0, b), 0.0), lam)
    lam = np.where(disc < 0, np.where(flat, 0.0, -b / (2 * safe)), lam)
    return np.where(d == 0, np.where(l1 * l2 == 0, 0.0, l2), lam)


@dataclass(eq=False)
class ReactivePlasticDamage(Solid):
    """sigma = w_intact sigma_0(F) + sum_i w_i sigma_0(F Fp_i^-1); intact and yielded bonds fail by their own
    criteria and distributions. Ateshian, Hung & Zimmerman, Comput. Methods Biomech. Biomed. Eng. (2022).
    """

    consistent = False
    elastic: Solid | None = None
    yield_criterion: Any = None
    flow_curve: Any = None
    plastic_damage: Any = None
    plastic_damage_criterion: Any = None
    elastic_damage: Any = None
    elastic_damage_criterion: Any = None
    isochoric: int = 1
    rtol: Number = 1e-4
    secant_tangent: int = 1
    parameters = ("rtol",)
    options = ("isochoric", "secant_tangent")
    properties = {
        "elastic": Property("solid"),
        "yield_criterion": Property("criterion"),
        "flow_curve": Property("flow_curve"),
        "plastic_damage": Property("cdf", optional=True),
        "plastic_damage_criterion": Property("criterion", optional=True),
        "elastic_damage": Property("cdf", optional=True),
        "elastic_damage_criterion": Property("criterion", optional=True),
    }
    symmetric = False
    history: int = field(default=0, init=False, repr=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        self.history = _HEAD + _EACH * (self.flow_curve.size if self.flow_curve is not None else 0)

    def initial(self, n: int) -> Floats:
        out = np.zeros((n, self.history))
        out[:, _HEAD:].reshape(n, -1, _EACH)[:, :, :9] = np.eye(3).ravel()
        return out

    def _old(self, pts: Points) -> Floats:
        return self.initial(pts.n) if pts.old is None else pts.old[:, self.offset : self.offset + self.history]

    def _flow(self, pts: Points, old: Floats) -> tuple[Floats, Floats, Floats, Floats | None]:
        """Inverse plastic parts (n, nf, 3, 3), yielded fractions (n, nf) and the intact fraction (n,).

        And stresses (n, nf + 1, 6) of the families and, last, of intact bonds, where they were had along with them.
        """
        at, h, n = self.offset, self.history, pts.n
        state = old[:, _HEAD:].reshape(n, -1, _EACH).copy()
        f = state.shape[1]
        Ky, share = (np.broadcast_to(x, (n, x.shape[1])) for x in self.flow_curve.families(pts))
        E = old[:, 0]
        if self.elastic_damage_criterion is not None:
            E = np.maximum(self.elastic_damage_criterion.of(self.elastic, pts), E)
        di = self._cdf(self.elastic_damage, pts, E)
        s = self._yield(pts, state, Ky, share[:, :f])
        D = di * share[:, f] + self._fail(pts, state, share[:, :f], di[:, None]).sum(1)
        w = state[:, :, _W]
        if pts.new is not None:
            out = state.copy()
            out[:, :, _B] = np.where(w > 0, 1.0, out[:, :, _B])
            pts.new[:, at], pts.new[:, at + 1] = np.maximum(E, old[:, 0]), D
            pts.new[:, at + _HEAD : at + h] = out.reshape(n, -1)
        return state[:, :, :9].reshape(n, f, 3, 3), w, 1.0 - w.sum(1) - D, s

    @staticmethod
    def _cdf(law: Any, pts: Points, X: Floats) -> Floats:
        return np.zeros(X.shape) if law is None else np.broadcast_to(law.cdf(pts, X), X.shape)

    def _yield(self, pts: Points, state: Floats, Ky: Floats, share: Floats) -> Floats | None:
        """Bring the families (n, nf, 16) from the old state to the present; returns stresses as :meth:`_flow` does."""
        rtol, iso = float(self.par(pts)[0, 0]), bool(self.isochoric)
        Ky = np.ascontiguousarray(Ky)
        found = Families.of(self.elastic, self.yield_criterion, pts, state, _T, Ky, rtol, int(iso), True)
        if found is not None:
            self._start(state, found.phase > 0, found.phase == FRESH, share)
            state[:, :, :9], state[:, :, _K] = found.Us, found.K
            return found.s
        base: Any = self.elastic
        n, f = Ky.shape
        Us, Ku = state[:, :, :9].reshape(n, f, 3, 3), state[:, :, _K].copy()
        Kv, beyond = beyond_yield(base, self.yield_criterion, pts, Us, Ky, rtol)
        self._start(state, beyond, beyond & (Kv > Ku) & (Ku < Ky * (1 + rtol)), share)
        rows: Any = np.flatnonzero(beyond)
        if len(rows):
            here = families_at(pts, rows, f)
            flat, K = Us.reshape(-1, 3, 3).copy(), Kv.ravel()
            trial = Trial.start(base, self.yield_criterion, here, flat[rows], iso)
            F, K[rows] = return_to_surface(trial, Ky.ravel()[rows], rtol)
            flat[rows] = inv(here.F) @ F
            state[:, :, :9], Kv = flat.reshape(n, f, 9), K.reshape(n, f)
        state[:, :, _K] = Kv
        return None

    @staticmethod
    def _start(state: Floats, beyond: Any, fresh: Any, share: Floats) -> None:
        """Families that yield now for the first time take their share of what is intact."""
        starts = fresh & (state[:, :, _T] == 0)
        never = beyond & ~fresh & (state[:, :, _B] == 0)
        w = np.where(starts, (1.0 - state[:, :, _DI]) * share, state[:, :, _W])
        state[:, :, _W] = np.where(never, 0.0, w)
        state[:, :, _T] = np.where(starts, 1.0, np.where(never, 0.0, state[:, :, _T]))

    def _fail(self, pts: Points, state: Floats, share: Floats, di: Floats) -> Floats:
        """Update what has failed of each family; return its broken fraction of all bonds (n, nf)."""
        yielding = state[:, :, _T] > 0
        n, f = yielding.shape
        state[:, :, _DI] = np.where(yielding, state[:, :, _DI], di)
        E = state[:, :, _E]
        if self.plastic_damage_criterion is not None and yielding.any():
            Fp: Any = inv(state[:, :, :9].reshape(n, f, 3, 3))
            E = np.maximum(E, self.plastic_damage_criterion.of(self.elastic, states(pts, Fp)).reshape(n, f))
        dy = np.where(yielding, self._cdf(self.plastic_damage, pts, E), 0.0)
        state[:, :, _DY] = np.where(yielding, dy, state[:, :, _DY])
        state[:, :, _E] = np.where(yielding, E, state[:, :, _E])
        left = (1.0 - dy) * (1.0 - state[:, :, _DI])
        state[:, :, _W] = np.where(yielding, left * share, state[:, :, _W])
        return (1.0 - left) * share

    def _sum(self, pts: Points, old: Floats, tangent: bool) -> tuple[Floats, Floats | None]:
        Us, w, intact, s = self._flow(pts, old)
        if s is None or tangent:
            return mixed_stress(self.elastic, pts, Us, w, intact, tangent)  # type: ignore[arg-type]
        return np.einsum("nf,nfi->ni", np.concatenate((w, intact[:, None]), axis=1), s), None

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        within = self.inner(pts)
        old, exact = self._old(within), c is not None and not self.secant_tangent
        si, ci = self._sum(within, old, exact)
        s += si
        if c is not None:
            c += ci if ci is not None else secant_tangent(
                lambda p: self._sum(p, np.repeat(old, 7, axis=0), False)[0], within
            )  # fmt: skip

    def broken(self, pts: Points) -> Floats | float:
        state = pts.old if pts.new is None else pts.new
        return 0.0 if state is None else state[:, self.offset + 1]

    def energy(self, pts: Points) -> Floats:
        within = self.inner(unwritten(pts))
        base: Any = self.elastic
        return mixed_energy(base, within, *self._flow(within, self._old(within))[:3], bool(self.isochoric))


register(ReactivePlasticDamage, "reactive plastic damage")
