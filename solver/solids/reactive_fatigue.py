"""Solids whose intact bonds break by overloading, or first turn into bonds that break more easily: fatigue.

Zimmerman, Jiang & Ateshian, J. Biomech. Eng. 143 (2021) 041002; FEBio theory manual, "Reactive fatigue".
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from ..kernels.push import add_scaled
from ..points import Points
from .base import Floats, Number, Property, Solid, unwritten, wanted
from .reactive_viscoelastic import ReactiveViscoelastic
from .registry import register
from .uncoupled import Uncoupled, distortional, distortional_energy

#: head of the history: time, number of generations, criterion (largest, last, rate), probability that an intact bond
#: is broken, and the fractions of intact, broken and fatigued bonds
_T, _N, _MOST, _X, _RATE, _F, _INTACT, _BROKEN, _FATIGUED = range(9)
_HEAD, _EACH = 9, 3  # and for each generation of fatigued bonds: fraction, probability, largest criterion
_ROUNDS, _TIGHT = 50, 1e-13


def _share(F: Floats, before: Floats) -> Floats:
    """Of what has survived probability ``before``, the part that breaks by ``F``; all where nothing has."""
    left = 1.0 - before
    return np.where(left > 0, (F - before) / np.where(left > 0, left, 1.0), 1.0)


@dataclass(eq=False)
class _Fatigue:
    """sigma = (1 - w_b) sigma_0: intact bonds break as elastic_damage says, or fatigue at rate k0 (|dX/dt| w_b)^beta.

    What fatigues in a step is a generation of bonds that break as fatigue_damage says; it takes up those that have
    not borne more. X is elastic_criterion.
    """

    consistent = False
    elastic: Solid | None = None
    elastic_damage: Any = None
    fatigue_damage: Any = None
    elastic_criterion: Any = None
    fatigue_criterion: Any = None
    k0: Number = 0.0
    beta: Number = 0.0
    parameters: ClassVar[tuple[str, ...]] = ("k0", "beta")
    properties: ClassVar[dict[str, Property]] = {
        "elastic": Property("solid"),
        "elastic_damage": Property("cdf"),
        "fatigue_damage": Property("cdf"),
        "elastic_criterion": Property("criterion"),
        "fatigue_criterion": Property("criterion"),
    }
    capacity: int = field(default=4, init=False, repr=False)
    history: int = field(default=_HEAD + 4 * _EACH, init=False, repr=False)

    def initial(self, n: int) -> Floats:
        out = np.zeros((n, self.history))
        out[:, _INTACT] = 1.0
        return out

    def room(self, pts: Points) -> None:
        at: int = self.offset  # type: ignore[attr-defined]
        if pts.old is not None and pts.old[:, at + _N].max(initial=0) >= self.capacity:
            self.capacity *= 2
            self.history = _HEAD + self.capacity * _EACH

    def _react(
        self, pts: Points, old: Floats, rate: Floats, F: Floats, lost: Floats, G: Floats
    ) -> tuple[Floats, Floats, Floats]:
        """Fractions of intact bonds, of broken ones, and of those that have fatigued in the step (n,).

        ``F`` and ``G``: probabilities of breaking of intact and of newly fatigued bonds, ``lost``: older fatigued
        bonds that break.
        """
        raise NotImplementedError

    def _speed(self, pts: Points, rate: Floats, broken: Floats) -> Floats:
        k0, beta = self.par(pts).T  # type: ignore[attr-defined]
        return np.asarray(k0 * (np.abs(rate) * broken) ** beta)

    def _bonds(self, pts: Points) -> Floats:
        """The history (n, history) at the present state; written where it is kept."""
        at: int = self.offset  # type: ignore[attr-defined]
        old = self.initial(pts.n) if pts.old is None else pts.old[:, at : at + self.history]
        new = self._advance(pts, old) if pts.dt > 0 else old
        new = np.where((old[:, _T] == pts.t)[:, None], old, new)  # a state of the present time has reacted already
        if pts.new is not None:
            pts.new[:, at : at + self.history] = new
        return new

    def _advance(self, pts: Points, old: Floats) -> Floats:
        X, Y = self.elastic_criterion.of(self.elastic, pts), self.fatigue_criterion.of(self.elastic, pts)
        F = np.where(old[:, _MOST] < X, self.elastic_damage.cdf(pts, X), old[:, _F])
        G, rate = self.fatigue_damage.cdf(pts, Y), (X - old[:, _X]) / pts.dt
        gen = old[:, _HEAD:].reshape(pts.n, self.capacity, _EACH).copy()
        live = np.arange(self.capacity) < old[:, _N, None]
        joined = live & (gen[:, :, 2] <= Y[:, None])
        fell = np.where(joined & (gen[:, :, 2] < Y[:, None]), _share(G[:, None], gen[:, :, 1]) * gen[:, :, 0], 0.0)
        intact, broken, tired = self._react(pts, old, rate, F, fell.sum(axis=1), G)
        tired = tired + np.where(joined, gen[:, :, 0] - fell, 0.0).sum(axis=1)
        order = np.argsort(~(live & ~joined), axis=1, kind="stable")
        gen = np.take_along_axis(gen, order[:, :, None], axis=1)
        count = (live & ~joined).sum(axis=1)
        gen[np.arange(pts.n), count] = np.stack((tired, G, Y), axis=1)
        most, left = np.maximum(X, old[:, _MOST]), 1.0 - intact - broken
        head = np.stack((pts.t + 0.0 * X, count + 1.0, most, X, rate, F, intact, broken, left), axis=1)
        return np.concatenate((head, gen.reshape(pts.n, -1)), axis=1)

    def _state(self, pts: Points) -> Floats:
        """The state last evaluated."""
        return self._bonds(self.inner(pts)) if pts.new is None else pts.new[:, self.offset :]  # type: ignore[attr-defined, index]

    def broken(self, pts: Points) -> Floats | float:
        return self._state(pts)[:, _BROKEN]

    def fatigued(self, pts: Points) -> Floats:
        """Fraction of fatigued bonds (n,)."""
        return self._state(pts)[:, _FATIGUED]

    def _weaken(self, pts: Points, s: Floats, c: Floats | None, law: Any) -> None:
        within = self.inner(pts)  # type: ignore[attr-defined]
        w = 1.0 - self._bonds(within)[:, _BROKEN]
        s0 = np.zeros((pts.n, 6))
        c0 = None if c is None else np.zeros((pts.n, 6, 6))
        law(within, s0, c0)
        add_scaled(w, s0, wanted(c0), s, wanted(c))


@dataclass(eq=False)
class ReactiveFatigue(_Fatigue, Solid):
    """Of a compressible solid: what fatigues by the trapezoidal rule."""

    def _react(
        self, pts: Points, old: Floats, rate: Floats, F: Floats, lost: Floats, G: Floats
    ) -> tuple[Floats, Floats, Floats]:
        was, gone = old[:, _INTACT], old[:, _BROKEN]
        broke = _share(F, old[:, _F]) * was
        now = self._speed(pts, rate, gone + broke)
        tired = 0.5 * pts.dt * (now * (was - broke) + self._speed(pts, old[:, _RATE], gone) * was)
        return np.clip(was - broke - tired, 0.0, was), np.clip(gone + broke + lost, gone, 1.0), tired

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        self._weaken(pts, s, c, self.elastic.stress)  # type: ignore[union-attr]

    def energy(self, pts: Points) -> Floats:
        within = self.inner(unwritten(pts))
        return (1.0 - self._bonds(within)[:, _BROKEN]) * self.elastic.energy(within)  # type: ignore[union-attr]


@dataclass(eq=False)
class UncoupledReactiveFatigue(_Fatigue, Uncoupled):
    """Of a nearly incompressible solid: what fatigues goes by the bonds broken at the end of the step."""

    def _react(
        self, pts: Points, old: Floats, rate: Floats, F: Floats, lost: Floats, G: Floats
    ) -> tuple[Floats, Floats, Floats]:
        was, gone = old[:, _INTACT], old[:, _BROKEN]
        share = np.where(old[:, _F] < 1, _share(F, old[:, _F]), 0.0)
        before, broken = self._speed(pts, old[:, _RATE], gone), gone
        for _ in range(_ROUNDS):
            now = self._speed(pts, rate, broken)
            tired = (now + before) * pts.dt / (2.0 + now * pts.dt) * was
            more = np.minimum(gone + (was - tired) * share + tired * G + lost, 1.0)
            change, broken = np.abs(more - broken).max(initial=0.0), more
            if change <= _TIGHT:
                break
        return np.maximum((was - tired) * (1.0 - share), 0.0), broken, tired * (1.0 - G)

    def dev(self, pts: Points, s: Floats, c: Floats | None) -> None:
        self._weaken(pts, s, c, distortional(self.elastic))  # type: ignore[arg-type]

    def dev_energy(self, pts: Points) -> Floats:
        within = self.inner(unwritten(pts))
        return (1.0 - self._bonds(within)[:, _BROKEN]) * distortional_energy(self.elastic, within)  # type: ignore[arg-type, operator]


@dataclass(eq=False)
class ReactiveViscoelasticFatigue(Solid):
    """(1 - w_b) times a reactive viscoelastic stress, whose strong bonds are a "reactive fatigue" solid."""

    consistent = False
    viscoelastic: ReactiveViscoelastic | None = None
    properties = {"viscoelastic": Property("solid")}

    def __post_init__(self) -> None:
        super().__post_init__()
        if not isinstance(getattr(self.viscoelastic, "elastic", None), ReactiveFatigue):
            raise ValueError('its <viscoelastic> must have an <elastic type="reactive fatigue">')

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        within = self.inner(pts)
        s0 = np.zeros((pts.n, 6))
        c0 = None if c is None else np.zeros((pts.n, 6, 6))
        self.viscoelastic.stress(within, s0, c0)  # type: ignore[union-attr]
        add_scaled(1.0 - self.broken(within), s0, wanted(c0), s, wanted(c))

    def broken(self, pts: Points) -> Floats | float:
        solid: Any = self.viscoelastic
        return solid.elastic.broken(solid.inner(pts))  # type: ignore[no-any-return]

    def energy(self, pts: Points) -> Floats:
        within = self.inner(unwritten(pts))
        return (1.0 - np.asarray(self.broken(within))) * self.viscoelastic.energy(within)  # type: ignore[union-attr]


register(ReactiveFatigue, "reactive fatigue")
register(UncoupledReactiveFatigue, "uncoupled reactive fatigue")
register(ReactiveViscoelasticFatigue, "reactive viscoelastic fatigue")
