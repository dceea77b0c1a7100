"""Springs between pairs of nodes, and constraints of nodal unknowns held by penalty.

A spring pulls its first node by F along the line to the second. FEBio user manual, "Discrete"; theory manual,
"Discrete element library".
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import field
from typing import TYPE_CHECKING, Any

import numpy as np

from ..action import Action
from ..record import variable_record
from ..values import as_value
from .base import Floats, Ints, Matrices, Number

if TYPE_CHECKING:
    from ..group import Group
    from ..state import State

ORIGIN = np.zeros((1, 3))
Curve = Callable[[Floats], Floats]
STEP = 1e-7  # of the measure, in slopes of curves


def slope(f: Curve, x: Floats) -> Floats:
    """f' by central differences."""
    h = STEP * np.maximum(1.0, np.abs(x))
    return np.asarray((f(x + h) - f(x - h)) / (2.0 * h))


@variable_record
class Springs(Action):
    """Springs ``nodes`` (m, 2) of one law; ``rest`` (m,) their lengths in the reference."""

    nodes: Ints
    rest: Floats

    @property
    def joins(self) -> Ints:
        """Nodes that have unknowns for the springs' sake."""
        return np.unique(self.nodes)

    def law(self, L: Floats, rate: Floats, t: float) -> tuple[Floats, Floats, Floats]:
        """Force (m,) at lengths L and their rates, its derivatives by both."""
        raise NotImplementedError

    def cliques(self) -> list[Ints]:
        return [self.nodes]

    def _line(self, state: State) -> tuple[Floats, Floats, Floats, Floats]:
        """Lengths, directions (m, 3), rates of length, and rates of the line (m, 3)."""
        x = state.x[self.nodes]
        r = x[:, 1] - x[:, 0]
        old = (state.X + state.u_old)[self.nodes]
        v = (r - old[:, 1] + old[:, 0]) / state.dt if state.dt > 0 else np.zeros_like(r)
        L = np.linalg.norm(r, axis=1)
        e = r / np.where(L > 0, L, 1.0)[:, None]
        return L, e, (v * e).sum(axis=1), v

    def forces(self, state: State) -> Floats:
        """Forces on the first nodes (m, 3)."""
        L, e, rate, _ = self._line(state)
        return self.law(L, rate, state.time)[0][:, None] * e

    def energies(self, state: State) -> Floats:
        """Strain energies (m,); zero where FEBio has none."""
        return np.zeros(len(self.nodes))

    def residual(self, state: State, R: Floats) -> None:
        f, Ru = self.forces(state), state.layout.u(R)
        np.add.at(Ru, self.nodes[:, 0], f)
        np.add.at(Ru, self.nodes[:, 1], -f)

    def slopes(self, state: State) -> Floats:
        """A = dF/dr (m, 3, 3): F' e e + F / L (1 - e e), and dF/drate e (e / dt + (v - rate e) / L)."""
        L, e, rate, v = self._line(state)
        F, dL, dv = self.law(L, rate, state.time)
        along = np.einsum("mi,mj->mij", e, e)
        over = np.where(L > 0, F / np.where(L > 0, L, 1.0), 0.0)[:, None, None]
        A = dL[:, None, None] * along + over * (np.eye(3) - along)
        if dv.any():
            turn = e / state.dt + (v - rate[:, None] * e) / np.where(L > 0, L, 1.0)[:, None]
            A += dv[:, None, None] * np.einsum("mi,mj->mij", e, turn)
        return np.asarray(A)

    def stiffness(self, state: State, groups: Any = None) -> Matrices:
        A = self.slopes(state)
        K = np.block([[A, -A], [-A, A]])
        return [(K, np.repeat(self.nodes, 3, axis=1), np.tile(state.layout.displacement, 2))]


@variable_record
class LinearSprings(Springs):
    """F = E (L - L0), in tension alone where ``tension_only``."""

    E: Number = 1.0
    tension_only: bool = False

    def law(self, L: Floats, rate: Floats, t: float) -> tuple[Floats, Floats, Floats]:
        E = as_value(self.E)(t, ORIGIN) * np.where((self.rest <= L) | (not self.tension_only), 1.0, 0.0)
        return E * (L - self.rest), E, np.zeros_like(L)

    def energies(self, state: State) -> Floats:
        L, _, rate, _ = self._line(state)
        return np.asarray(0.5 * self.law(L, rate, state.time)[0] * (L - self.rest))


@variable_record
class ExperimentalSprings(Springs):
    """F = s (1 - exp(-E d / s)), d = L - L0, s = sM; in compression odd with s = sm."""

    E: Number = 0.0
    sM: Number = 0.0
    sm: Number = 0.0

    def _side(self, L: Floats, t: float) -> tuple[Floats, Floats, Floats]:
        """E, and s and exp(-E |d| / s) of the side (m,)."""
        E, most, least = (as_value(v)(t, ORIGIN) for v in (self.E, self.sM, self.sm))
        s = np.where(self.rest <= L, most, least)
        return E, s, np.exp(-E * np.abs(L - self.rest) / s)

    def law(self, L: Floats, rate: Floats, t: float) -> tuple[Floats, Floats, Floats]:
        E, s, e = self._side(L, t)
        return np.sign(L - self.rest) * s * (1.0 - e), E * e, np.zeros_like(L)

    def energies(self, state: State) -> Floats:
        L = self._line(state)[0]
        E, s, e = self._side(L, state.time)
        return np.asarray(s * (np.abs(L - self.rest) - s / E * (1.0 - e)))


@variable_record
class TorsionSprings(Springs):
    """Springs that resist turning away from their line e0 of the reference: energy r (1 - w^2) / 2, w = e0 . e.

    F = -r w t, t = (e0 - w e) / L, pulls the first node.
    """

    r: Number = 0.0

    def _turned(self, state: State) -> tuple[Floats, ...]:
        """Lengths, directions e and t (m, 3), and w (m,)."""
        L, e, _, _ = self._line(state)
        X = state.X[self.nodes]
        e0 = (X[:, 1] - X[:, 0]) / self.rest[:, None]
        w = (e0 * e).sum(axis=1)
        return L, e, (e0 - w[:, None] * e) / L[:, None], w

    def forces(self, state: State) -> Floats:
        _, _, t, w = self._turned(state)
        return -as_value(self.r)(state.time, ORIGIN)[:, None] * w[:, None] * t

    def slopes(self, state: State) -> Floats:
        L, e, t, w = self._turned(state)
        r = as_value(self.r)(state.time, ORIGIN)[:, None, None]
        tt, te = t[:, :, None] * t[:, None, :], t[:, :, None] * e[:, None, :]
        over = (w / L)[:, None, None]
        wide = te + np.swapaxes(te, 1, 2) + over * (np.eye(3) - e[:, :, None] * e[:, None, :])
        return np.asarray(r * (over * wide - tt))

    def energies(self, state: State) -> Floats:
        return np.asarray(0.5 * as_value(self.r)(state.time, ORIGIN) * (1.0 - self._turned(state)[3] ** 2))


@variable_record
class CompositeSprings(Springs):
    """Several laws between the same nodes."""

    parts: tuple[Springs, ...] = ()

    @property
    def symmetric(self) -> bool:
        return all(p.symmetric for p in self.parts)

    def forces(self, state: State) -> Floats:
        return np.asarray(sum(p.forces(state) for p in self.parts))

    def slopes(self, state: State) -> Floats:
        return np.asarray(sum(p.slopes(state) for p in self.parts))

    def energies(self, state: State) -> Floats:
        return np.asarray(sum(p.energies(state) for p in self.parts))


@variable_record
class NonlinearSprings(Springs):
    """F = scale f(s), s the elongation L - L0, the strain (L - L0) / L0 or the stretch L / L0."""

    force: Curve = field(default=lambda s: s)
    scale: Number = 1.0
    measure: str = "elongation"

    def law(self, L: Floats, rate: Floats, t: float) -> tuple[Floats, Floats, Floats]:
        k = as_value(self.scale)(t, ORIGIN)
        per = np.ones_like(L) if self.measure == "elongation" else 1.0 / self.rest
        s = L * per if self.measure == "stretch" else (L - self.rest) * per
        return k * self.force(s), k * slope(self.force, s) * per, np.zeros_like(L)


@variable_record
class HillMuscles(Springs):
    """F = Fmax (passive(l) + ac Ftl(l) Fvl(V)), l = L / L0, V = rate / (Vmax Sv(ac)).

    passive = (exp(Ksh (l - 1) / Lmax) - 1) / (exp(Ksh) - 1) where l > 1.
    """

    Vmax: Number = 1.0
    ac: Number = 0.0
    Fmax: Number = 1.0
    Ksh: Number = 1.0
    Lmax: Number = 1.0
    L0: float = 0.0
    Sv: Curve | None = None
    Ftl: Curve | None = None
    Fvl: Curve | None = None

    @property
    def symmetric(self) -> bool:
        return False

    def law(self, L: Floats, rate: Floats, t: float) -> tuple[Floats, Floats, Floats]:
        fastest, ac, most, shape, longest = (
            float(as_value(v)(t, ORIGIN)[0]) for v in (self.Vmax, self.ac, self.Fmax, self.Ksh, self.Lmax)
        )
        rest = np.full_like(L, self.L0) if self.L0 else self.rest
        one = np.ones_like(L)
        if self.Sv is not None:
            fastest *= float(self.Sv(np.array([ac]))[0])
        l, V = L / rest, rate / fastest
        grown, whole = np.exp(shape * (l - 1.0) / longest), np.exp(shape) - 1.0
        passive = np.where(l > 1.0, most * (grown - 1.0) / whole, 0.0)
        stiff = np.where(l > 1.0, most / whole * shape / longest * grown, 0.0)
        tl, dtl = (self.Ftl(l), slope(self.Ftl, l)) if self.Ftl else (one, 0.0 * one)
        vl, dvl = (self.Fvl(V), slope(self.Fvl, V)) if self.Fvl else (one, 0.0 * one)
        return passive + ac * most * tl * vl, (stiff + ac * most * dtl * vl) / rest, ac * most * tl * dvl / fastest


@variable_record
class ConstraintSet(Action):
    """Sums of coefficients x unknowns that must vanish, by penalty: f_i = -(lambda + eps c) a_i.

    Each row of ``nodes``, ``columns``, ``coefficients`` is a constraint, padded with node -1 and coefficient 0.
    FEBio user manual, "Linear constraints" (its rhs counts in the multipliers alone).
    """

    nodes: Ints
    columns: Ints
    coefficients: Floats
    penalty: Number = 1.0
    tolerance: float = 0.1
    rhs: float = 0.0
    minaug: int = 0
    maxaug: int = 50
    laugon: int = 1
    multipliers: Floats = field(init=False, repr=False)  # lambda (constraint,)

    def __post_init__(self) -> None:
        self.multipliers = np.zeros(len(self.nodes))

    def begin(self, state: State, groups: list[Group]) -> None:
        self.multipliers = np.zeros(len(self.nodes))

    def snapshot(self) -> Floats:
        return self.multipliers.copy()

    def restore(self, saved: Floats) -> None:
        self.multipliers = saved.copy()

    def cliques(self) -> list[Ints]:
        return [self.nodes]

    def _eps(self, state: State) -> float:
        """The penalty at the present time."""
        return float(as_value(self.penalty)(state.time, ORIGIN)[0])

    def _sums(self, state: State) -> Floats:
        u = state.d[np.maximum(self.nodes, 0), self.columns]
        return np.asarray((self.coefficients * u).sum(axis=1))

    def residual(self, state: State, R: Floats) -> None:
        f = self.multipliers + self._eps(state) * self._sums(state)
        np.add.at(R, (np.maximum(self.nodes, 0), self.columns), -f[:, None] * self.coefficients)

    def stiffness(self, state: State, groups: Any = None) -> Matrices:
        """eps a a^T, constraints of like columns together."""
        out: Matrices = []
        kinds, which = np.unique(np.where(self.nodes < 0, -1, self.columns), axis=0, return_inverse=True)
        for k, columns in enumerate(kinds):
            rows, on = which.ravel() == k, columns >= 0
            a = self.coefficients[rows][:, on]
            out.append((self._eps(state) * a[:, :, None] * a[:, None, :], self.nodes[rows][:, on], columns[on]))
        return out

    @property
    def augments(self) -> bool:
        return True

    def augment(self, done: int, state: State) -> bool:
        """Renew the multipliers; True where their norm has settled."""
        if self.laugon == 0:
            return True
        old = self.multipliers
        new = old + self._eps(state) * (self._sums(state) - self.rhs)
        n0, n1 = float(np.linalg.norm(old)), float(np.linalg.norm(new))
        good = abs(n1 - n0) <= self.tolerance * (n1 or 1.0) or 0 <= self.maxaug <= done
        if good and done >= self.minaug:
            return True
        self.multipliers = new
        return False
