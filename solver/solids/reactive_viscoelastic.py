"""Reactive viscoelastic solids: strong bonds that last, weak bonds that break and reform in generations."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

import numpy as np

from ..kernels.fibers import add_fibers, squared_stretch
from ..kernels.generations import (
    add_bonds,
    add_mooney_rivlin,
    add_neo_hookean,
    ages,
    born_along,
    fractions,
    grow,
    since_birth,
    strain_measures,
)
from ..matrices import inv
from ..points import Points
from .base import Floats, Number, Property, Solid, unwritten, wanted
from .batches import states
from .continuous_fibers import ContinuousFibers, ContinuousFibersUncoupled
from .fiber import Fiber, UncoupledFiber, directions
from .mooney_rivlin import MooneyRivlin, MooneyRivlinAD
from .neo_hookean import NeoHookean, NeoHookeanAD
from .registry import register
from .uncoupled import Uncoupled, distortional, distortional_energy
from .voigt import matrix, norm

_HEAD = 10  # number of generations, F of the last state
_EACH = 11  # per generation: v, J, f, recruited, K2, U
_V, _J, _F, _R, _K = range(5)
_U = slice(5, 11)
_TOGETHER = {
    NeoHookean: add_neo_hookean,
    NeoHookeanAD: add_neo_hookean,
    MooneyRivlin: add_mooney_rivlin,
    MooneyRivlinAD: add_mooney_rivlin,
}  # kernels of all generations at once, by the bond
_ALL, _NONE_BEFORE, _NO_STRESS = np.empty(0), np.empty((0, 0)), np.empty((0, 6))
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
    _bond_remembers: bool | None = field(default=None, init=False, repr=False)

    def initial(self, n: int) -> Floats:
        out = np.zeros((n, self.history))
        out[:, 1:_HEAD] = np.eye(3).ravel()
        return out

    def room(self, pts: Points) -> None:
        at = self.offset  # type: ignore[attr-defined]
        if pts.old is not None and pts.old[:, at].max(initial=0) >= self.capacity:
            self.take_room(_HEAD + (self.capacity + self.capacity // 2) * _EACH)

    def take_room(self, columns: int) -> None:
        self.capacity, self.history = (columns - _HEAD) // _EACH, columns

    def _weights(self, pts: Points, gen: Floats, rate: Floats, count: Floats = _ALL) -> Floats:
        """Mass fraction of each generation (n, capacity) as if all existed, or :func:`..kernels.generations.fractions`
        of ``count`` of them."""
        t, K, before = np.empty(gen.shape[:2]), gen[:, :, _K], _NONE_BEFORE
        if ages(gen, pts.t, t) and not (self.relaxation.rated or self.relaxation.formed):
            t = t[:1]  # bonds of all points started to break together, and break alike
        if self.kinetics == 2:
            before = np.ascontiguousarray(self.relaxation(pts, t[:, :-1], K[:, 1:], rate))
        out = np.empty(gen.shape[:2])
        fractions(gen, pts.t, np.ascontiguousarray(self.relaxation(pts, t, K, rate)), before, count, out)
        return out

    def _reforming(self, pts: Points, gen: Floats, count: Floats, rate: Floats) -> Floats:
        """1 - sum of the fractions of all generations but the last of ``count``."""
        top = max(int(count.max(initial=0)) - 1, 0)
        if top == 0:
            return np.ones(pts.n)
        live = np.arange(top) < (count - 1)[:, None]
        return 1.0 - (self._weights(pts, gen[:, :top], rate) * live).sum(1)

    def _scalar(self, F: Floats) -> Floats:
        """Measure of strain (n,) by ``trigger``."""
        out = np.empty(len(F))
        strain_measures(np.ascontiguousarray(F), int(self.trigger), out)
        return out

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
        at, h, n = self.offset, self.history, pts.n  # type: ignore[attr-defined]
        old = self.initial(n) if pts.old is None else pts.old[:, at : at + h]
        new = old.copy() if pts.new is None else pts.new[:, at : at + h]
        gen, top = old[:, _HEAD:].reshape(n, self.capacity, _EACH), int(old[:, 0].max(initial=0))
        rate = np.zeros((n, 1))
        if pts.dt > 0 and self.relaxation.rated:
            L = (pts.F - old[:, 1:_HEAD].reshape(-1, 3, 3)) @ inv(pts.F) / pts.dt
            rate = norm(0.5 * (L + np.swapaxes(L, 1, 2)))[:, None]
        par, share = self.par(pts), np.ones(n)  # type: ignore[attr-defined]
        if self.recruitment is not None:
            share[:] = self.recruitment(pts, self._scalar(pts.F))
        w = self._weights(pts, gen[:, :top], rate)
        slack, culls = self._slack(pts, strong), bool(par[:, 0].any())
        grow(pts.F, pts.J, pts.t, old, w, share, slack, par, int(self.trigger), culls, pts.new is not None, new)
        return new[:, _HEAD:].reshape(n, self.capacity, _EACH), new[:, 0].copy(), rate

    def _fractions(self, pts: Points, gen: Floats, count: Floats, rate: Floats) -> Floats:
        """What each generation weighs (n, g), recruited bonds counted; all is of the first where there is none."""
        return self._weights(pts, gen[:, : max(int(count.max(initial=0)), 1)], rate, count)

    def _batches(self, n: int, w: Floats) -> Any:
        """Generations that weigh something, some at a time."""
        used = np.flatnonzero((w != 0.0).any(0))
        step = 1 if self._remembers() else max(1, _BATCH // n)
        for a in range(0, len(used), step):
            yield used[a : a + step]

    def _states(self, pts: Points, gen: Floats, count: Floats, w: Floats) -> Any:
        """(points as a batch of generations sees them, generations in it, weights (n, b), J at birth (n, b))."""
        for some in self._batches(pts.n, w):
            J = np.empty((pts.n, len(some)))
            yield self._repeat(pts, gen, count, some, J), len(some), w[:, some], J

    def _remembers(self) -> bool:
        """Has the bond a history? What may grow has one from the first."""
        if self._bond_remembers is None:
            self._bond_remembers = any(m.history for m in self.bond.walk())  # type: ignore[union-attr]
        return self._bond_remembers

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
        intact = np.full(pts.n, 1.0)
        intact -= self.elastic.broken(within)  # type: ignore[union-attr]
        w = self._fractions(within, gen, count, rate)
        alike = isinstance(self.bond, Uncoupled) == isinstance(self, Uncoupled)
        together = _TOGETHER.get(type(self.bond)) if alike else None  # type: ignore[arg-type]
        if together is not None:
            par = self.bond.par(within)  # type: ignore[union-attr]
            together(within.F, within.J, gen, count, w, par, intact, rest, s, wanted(c))
            return
        if alike and self._sum_fibers(within, gen, count, intact[:, None] * w, np.zeros_like(s) if rest else s, c):
            return
        bears = _NO_STRESS if rest else s
        for at, _, wb, J in self._states(within, gen, count, w):
            sb = np.zeros((at.n, 6))
            cb = None if c is None else np.zeros((at.n, 6, 6))
            bond(at, sb, cb)
            add_bonds(intact[:, None] * wb / J, sb, wanted(cb), bears, wanted(c))

    def _sum_fibers(self, pts: Points, gen: Floats, count: Floats, w: Floats, s: Floats, c: Floats | None) -> bool:
        """Add the bonds of all generations where they are fibers without a shear term: they pull along directions of
        their own. False where they are not."""
        bond = self.bond
        if not isinstance(bond, (Fiber, UncoupledFiber)) or self._remembers() or bond.shears(pts):
            return False
        a = directions(bond.fiber, bond.inner(pts))
        for some in self._batches(pts.n, w):
            A, In, sn, cn = np.empty((pts.n, len(some), 3)), *(np.empty((pts.n, len(some))) for _ in range(3))
            born_along(a, gen, count, some, bond.iso, A)
            squared_stretch(pts.F, pts.J, A, bond.iso, In)
            g = bond.tension(pts, In, sn, cn)
            add_fibers(pts.F, pts.J, A, np.ascontiguousarray(w[:, some]), In, sn, cn, g, bond.iso, s, wanted(c))
        return True

    def _sum_energy(self, pts: Points, energy: Callable[[Solid, Points], Floats], law: Law) -> Floats:
        within = self.inner(unwritten(pts))  # type: ignore[attr-defined]
        gen, count, rate = self._advance(within, law)
        intact = 1.0 - self.elastic.broken(within)  # type: ignore[union-attr]
        out = energy(self.elastic, within)  # type: ignore[arg-type]
        fractions = self._fractions(within, gen, count, rate)
        for at, b, w, _ in self._states(within, gen, count, fractions):
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
