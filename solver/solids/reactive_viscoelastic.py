"""Reactive viscoelastic solids: strong bonds that last, weak bonds that break and reform in generations."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

import numpy as np

from ..kernels.generations import since_birth
from ..matrices import det, inv
from ..points import Points
from .base import Floats, Number, Property, Solid, unwritten
from .batches import states
from .continuous_fibers import ContinuousFibers, ContinuousFibersUncoupled
from .fiber import Fiber, UncoupledFiber
from .registry import register
from .uncoupled import Uncoupled, distortional, distortional_energy
from .voigt import deviator, distortion, matrix, norm, right_stretch, spectral, strain, vector

_HEAD = 10  # number of generations, F of the last state
_EACH = 11  # per generation: v, J, f, recruited, K2, U
_V, _J, _F, _R, _K = range(5)
_U = slice(5, 11)
_BATCH = 1 << 13  # points of all generations evaluated at a time
Law = Callable[[Points, Floats, Floats | None], None]


@dataclass(eq=False)
class _Bonds:
    """Generation g starts to break at time v_g, when the strain changes, and was born in the state (U, J)_(g-1).

    sigma = sigma_strong(F) + (1 - D) sum_g w_g sigma_bond(F U_(g-1)^-1) / J_(g-1), w_g the mass fraction of the
    bonds of generation g, kinetics type I or II. Ateshian, J. Biomech. 48 (2015) 941; Nims & Ateshian, J.
    Biomech. 56 (2017) 66.
    """

    consistent = False  # it leaves out what is recruited
    elastic: Solid | None = None
    bond: Solid | None = None
    relaxation: Any = None
    recruitment: Any = None
    wmin: Number = 0.0
    emin: Number = 0.0
    kinetics: int = 1
    trigger: int = 0
    parameters: ClassVar[tuple[str, ...]] = ("wmin", "emin")
    options: ClassVar[tuple[str, ...]] = ("kinetics", "trigger")
    properties: ClassVar[dict[str, Property]] = {
        "elastic": Property("solid"),
        "bond": Property("solid"),
        "relaxation": Property("relaxation"),
        "recruitment": Property("recruitment", optional=True),
    }
    capacity: int = field(default=4, init=False, repr=False)
    history: int = field(default=_HEAD + 4 * _EACH, init=False, repr=False)

    def initial(self, n: int) -> Floats:
        out = np.zeros((n, self.history))
        out[:, 1:_HEAD] = np.eye(3).ravel()
        return out

    def room(self, pts: Points) -> None:
        at = self.offset  # type: ignore[attr-defined]
        if pts.old is not None and pts.old[:, at].max(initial=0) >= self.capacity:
            self.take_room(_HEAD + 2 * self.capacity * _EACH)

    def take_room(self, columns: int) -> None:
        self.capacity, self.history = (columns - _HEAD) // _EACH, columns

    def _weights(self, pts: Points, gen: Floats, rate: Floats) -> Floats:
        """Mass fraction of each generation (n, capacity) as if all existed."""
        dtv = pts.t - gen[:, :, _V]
        g = self.relaxation(pts, np.maximum(dtv, 0.0), gen[:, :, _K], rate)
        if self.kinetics == 1:
            return np.where(dtv >= 0, gen[:, :, _F] * g, 0.0)
        out = np.array(np.broadcast_to(g, dtv.shape))
        before = self.relaxation(pts, np.maximum(dtv[:, :-1], 0.0), gen[:, 1:, _K], rate)
        out[:, 1:] -= before
        return out

    def _reforming(self, pts: Points, gen: Floats, count: Floats, rate: Floats) -> Floats:
        """1 - sum of the fractions of all generations but the last of ``count``."""
        top = max(int(count.max(initial=0)) - 1, 0)
        if top == 0:
            return np.ones(pts.n)
        live = np.arange(top) < (count - 1)[:, None]
        return 1.0 - (self._weights(pts, gen[:, :top], rate) * live).sum(1)

    def _changed(self, F: Floats, gen: Floats, count: Floats) -> Floats:
        """Measure of the strain since the last generation, by ``trigger``."""
        last = np.maximum(count - 1, 0).astype(int)
        U = matrix(gen[np.arange(len(F)), last, _U])
        U[count == 0] = np.eye(3)
        Fu = F @ inv(U)
        return self._scalar(Fu)

    def _scalar(self, F: Floats) -> Floats:
        if self.trigger == 0:
            return norm(strain(F))
        if self.trigger == 1:
            return norm(deviator(0.5 * spectral(F @ np.swapaxes(F, 1, 2), np.log)))
        return np.abs(np.log(det(F)))

    def _slack(self, pts: Points, law: Law) -> Any:
        """Where both parts are fibers that bear no load, no generation starts."""
        families = (Fiber, UncoupledFiber)
        if not (isinstance(self.elastic, families) and isinstance(self.bond, families)):
            return np.zeros(pts.n, bool)
        s = np.zeros((pts.n, 6))
        law(pts, s, None)
        return ~s.any(1)

    def _advance(self, pts: Points, strong: Law) -> tuple[Floats, Floats, Floats]:
        """Generations at the present state: (n, capacity, 11), their number (n,), the rate (n, 1) where it matters."""
        at, h = self.offset, self.history  # type: ignore[attr-defined]
        old = self.initial(pts.n) if pts.old is None else pts.old[:, at : at + h]
        count = old[:, 0].copy()
        gen = old[:, _HEAD:].reshape(pts.n, self.capacity, _EACH).copy()
        rate = np.zeros((pts.n, 1))
        if pts.dt > 0 and self.relaxation.rated:
            L = (pts.F - old[:, 1:_HEAD].reshape(-1, 3, 3)) @ inv(pts.F) / pts.dt
            rate = norm(0.5 * (L + np.swapaxes(L, 1, 2)))[:, None]
        wmin, emin = self.par(pts).T  # type: ignore[attr-defined]
        slack = self._slack(pts, strong)
        now = np.zeros(pts.n, bool) if pts.new is None else self._begun(pts)
        born = now | (self._due(pts, gen, count, rate, wmin, emin) if not now.all() else False)
        for i in np.flatnonzero(now & slack):  # what an earlier iteration of the step has begun stays
            assert pts.new is not None
            count[i] = pts.new[i, at]
            gen[i] = pts.new[i, at + _HEAD : at + h].reshape(self.capacity, _EACH)
        who = np.flatnonzero(born & ~slack)
        if len(who):
            self._begin(pts, gen, count, rate, who)
            if wmin.any():
                self._cull(pts, gen, count, rate, who, wmin)
        if pts.new is not None:
            pts.new[:, at] = count
            pts.new[:, at + 1 : at + _HEAD] = pts.F.reshape(pts.n, 9)
            pts.new[:, at + _HEAD : at + h] = gen.reshape(pts.n, -1)
        return gen, count, rate

    def _due(
        self, pts: Points, gen: Floats, count: Floats, rate: Floats, wmin: Floats, emin: Floats
    ) -> Any:
        """Points (n,) whose strain has changed since the last generation, while enough bonds reform."""
        eps = np.maximum(emin, 10 * np.finfo(float).eps)
        last = gen[np.arange(pts.n), np.maximum(count - 1, 0).astype(int), _V]
        due = (count == 0) | (last < pts.t)
        if wmin.any():
            due &= self._reforming(pts, gen, count, rate) >= wmin
        return due & (self._changed(pts.F, gen, count) > eps)

    def _begun(self, pts: Points) -> Any:
        """Points (n,) with a generation of the present time in ``pts.new``."""
        at, h = self.offset, self.history  # type: ignore[attr-defined]
        assert pts.new is not None
        count, gen = pts.new[:, at], pts.new[:, at + _HEAD : at + h].reshape(pts.n, self.capacity, _EACH)
        last = gen[np.arange(pts.n), np.maximum(count - 1, 0).astype(int), _V]
        return (count > 0) & (last == pts.t)

    def _begin(self, pts: Points, gen: Floats, count: Floats, rate: Floats, who: Any) -> None:
        k = count[who].astype(int)
        U = right_stretch(pts.F[who])
        gen[who, k, _V] = pts.t
        gen[who, k, _J] = pts.J[who]
        gen[who, k, _K] = distortion(U)
        gen[who, k, _U] = vector(U)
        gen[who, k, _R] = 1.0
        if self.recruitment is not None:
            gen[who, k, _R] = self.recruitment(pts, self._scalar(pts.F))[who]
        count[who] += 1
        gen[who, k, _F] = self._reforming(pts, gen, count, rate)[who]

    def _cull(
        self, pts: Points, gen: Floats, count: Floats, rate: Floats, who: Any, wmin: Floats
    ) -> None:
        """Merge the oldest generation into the next where its fraction has fallen below wmin."""
        w = self._weights(pts, gen[:, :2], rate) * gen[:, :2, _R]
        thin = np.zeros(pts.n, bool)
        thin[who] = True
        thin &= (count >= 3) & (w[:, 0] < wmin)
        if not thin.any():
            return
        a, b = w[thin, 0, None], w[thin, 1, None]
        mean = (a * gen[thin, 0] + b * gen[thin, 1]) / (a + b)
        U = matrix(mean[:, _U])
        mean[:, _J], mean[:, _K] = det(U), distortion(U)
        gen[thin, :-1] = gen[thin, 1:]
        gen[thin, 0] = mean
        count[thin] -= 1

    def _states(self, pts: Points, gen: Floats, count: Floats, rate: Floats) -> Any:
        """(points as a batch of generations sees them, generations in it, weights (n, b), J at birth (n, b))."""
        n, top = pts.n, max(int(count.max(initial=0)), 1)
        w = self._weights(pts, gen[:, :top], rate) * gen[:, :top, _R]
        w = np.where(np.arange(top) < count[:, None], w, 0.0)
        w[count == 0, 0] = 1.0
        used = np.flatnonzero((w != 0.0).any(0))
        step = max(1, _BATCH // n) if not any(m.history for m in self.bond.walk()) else 1  # type: ignore[union-attr]
        for a in range(0, len(used), step):
            some = used[a : a + step]
            J = np.empty((n, len(some)))
            yield self._repeat(pts, gen, count, some, J), len(some), w[:, some], J

    def _repeat(self, pts: Points, gen: Floats, count: Floats, some: Any, J: Floats) -> Points:
        """Each point once for each of b generations ``some``, since their birth; writes J at birth (n, b)."""
        n, b = J.shape
        F, Jg = np.empty((n * b, 3, 3)), np.empty(n * b)
        since_birth(pts.F, pts.J, gen, count, some, _J, _U.start, F, Jg, J)
        if b == 1:  # the bond may keep a history
            out = replace(pts, F=F, J=Jg)
        else:
            out = states(pts, F.reshape(n, b, 3, 3), Jg)
        if isinstance(self.bond, (ContinuousFibers, ContinuousFibersUncoupled)):
            out = replace(out, extra={**out.extra, "prestretch": self._births(gen, count, some)})
        return out

    @staticmethod
    def _births(gen: Floats, count: Floats, some: Any) -> Floats:
        """Stretches U at birth (n b, 3, 3) of generations ``some``."""
        has = (some > 0) & (some < count[:, None])
        U = np.where(has[..., None, None], matrix(gen[:, some - 1, _U]), np.eye(3))
        return np.ascontiguousarray(U.reshape(-1, 3, 3))

    def _sum(self, pts: Points, s: Floats, c: Floats | None, strong: Law, bond: Law, rest: bool) -> None:
        within = self.inner(pts)  # type: ignore[attr-defined]
        strong(within, s, c)
        gen, count, rate = self._advance(within, strong)
        intact = 1.0 - self.elastic.broken(within)  # type: ignore[union-attr]
        for at, b, w, J in self._states(within, gen, count, rate):
            sb = np.zeros((at.n, 6))
            cb = None if c is None else np.zeros((at.n, 6, 6))
            bond(at, sb, cb)
            k = w / J
            weak = np.einsum("ng,ngi->ni", k, sb.reshape(pts.n, b, 6))
            if not rest:
                s += np.asarray(intact).reshape(-1, 1) * weak
            if c is not None and cb is not None:
                stiff = np.einsum("ng,ngij->nij", k, cb.reshape(pts.n, b, 6, 6))
                c += np.asarray(intact).reshape(-1, 1, 1) * stiff

    def _sum_energy(self, pts: Points, energy: Callable[[Solid, Points], Floats], law: Law) -> Floats:
        within = self.inner(unwritten(pts))  # type: ignore[attr-defined]
        gen, count, rate = self._advance(within, law)
        intact = 1.0 - self.elastic.broken(within)  # type: ignore[union-attr]
        out = energy(self.elastic, within)  # type: ignore[arg-type]
        for at, b, w, _ in self._states(within, gen, count, rate):
            out = out + intact * (w * energy(self.bond, at).reshape(pts.n, b)).sum(1)  # type: ignore[arg-type]
        return out


@dataclass(eq=False)
class ReactiveViscoelastic(_Bonds, Solid):
    """Reactive viscoelastic solid of compressible parts; weak bonds bear no stress at t = 0."""

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        self._sum(pts, s, c, self.elastic.stress, self.bond.stress, pts.t == 0)  # type: ignore[union-attr]

    def energy(self, pts: Points) -> Floats:
        return self._sum_energy(pts, lambda m, p: m.energy(p), self.elastic.stress)  # type: ignore[union-attr]


@dataclass(eq=False)
class UncoupledReactiveViscoelastic(_Bonds, Uncoupled):
    """Reactive viscoelastic solid of nearly incompressible parts; weak bonds bear no stress where dt = 0."""

    def dev(self, pts: Points, s: Floats, c: Floats | None) -> None:
        strong, bond = distortional(self.elastic), distortional(self.bond)  # type: ignore[arg-type]
        self._sum(pts, s, c, strong, bond, pts.dt == 0)

    def dev_energy(self, pts: Points) -> Floats:
        return self._sum_energy(pts, distortional_energy, distortional(self.elastic))  # type: ignore[arg-type]


register(ReactiveViscoelastic, "reactive viscoelastic")
register(UncoupledReactiveViscoelastic, "uncoupled reactive viscoelastic")
