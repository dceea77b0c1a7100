"""Rotations of nodes: vectors in the nodal arrays, composed rather than added, and their rates.

A node's rotation in a step is that of the increment so far, then that of the present one, on top of the last converged
one: Q = exp(u) exp(U) Q_old. Angular velocity w and acceleration a are spatial and follow Newmark's rule in the frame
of the last converged rotation. FEBio Theory Manual, "Beams"; Simo and Vu-Quoc, Comput Methods Appl Mech Engrg 66
(1988) 125.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from .quaternions import conjugate, of_increment, of_vector, product, rotate, skew, vector

Floats = NDArray[np.float64]
RATES = ("spin", "spin rate")


class Nodal(Protocol):
    """What is needed of a state (:mod:`.state`)."""

    d: Floats
    d_old: Floats
    dt: float
    extra: dict[str, Floats]


class Rotations:
    """Nodes with rotations, in one analysis step.

    ``own``: columns of the rotations; ``free`` (node, 3): which are unknowns, of equations ``eq``; ``nodes`` that have
    any. In ``state.extra``, all (node, 3): "spin" and "spin rate" are w and a, "turn" is the rotation of the present
    increment, "settled" the rotation vector after the last iteration, "turned" the rotation of the step so far.
    """

    def __init__(
        self, state: Nodal, own: slice, nodes: NDArray[np.int64], free: NDArray[np.bool_], eq: NDArray[np.int32]
    ) -> None:
        self.own, self.nodes, self.free = own, nodes, free[nodes]
        count = self.free.sum(axis=1, keepdims=True)
        self.all, self.none = count == 3, count == 0
        self.eq = np.where(self.free, eq[nodes], 0)
        for name in (*RATES, "turn", "settled", "turned"):
            state.extra.setdefault(name, np.zeros((len(state.d), 3)))
            state.extra.setdefault(f"{name}_old", np.zeros((len(state.d), 3)))

    def _of(self, unknowns: Floats) -> Floats:
        """Entries of an equation vector at the nodes, zero where none is free."""
        return np.where(self.free, unknowns[self.eq], 0.0)

    # ---- motion -----------------------------------------------------------------------------------
    def move(self, s: Nodal, increment: Floats, u: Floats) -> None:
        """Rotate by the increment so far and then ``u`` (equations), or as prescribed.

        Of nodes that turn freely about some axes alone vectors are added. A prescribed rotation goes on by its growth
        in the node's own frame, as in FEBio: the same where its axis stays.
        """
        n, now = self.nodes, s.d[self.nodes, self.own]
        before, turn = of_vector(s.d_old[n, self.own]), self._of(u)
        step = product(of_vector(turn), of_vector(self._of(increment)))
        given = product(conjugate(before), of_vector(now))
        self._step = np.where(self.none, given, step)
        on = product(conjugate(of_vector(s.extra["settled"][n])), of_vector(now))
        s.extra["turn"][n] = np.where(self.none, vector(on), turn)
        s.extra["turned"][n] = vector(self._step)
        s.d[n, self.own] = np.where(self.all, vector(product(step, before)), now)

    def compose(self, total: Floats, a: Floats, b: Floats) -> Floats:
        """``total`` = a + b with the rotations composed, b after a."""
        both = vector(product(of_vector(self._of(b)), of_vector(self._of(a))))
        total[self.eq[self.free]] = both[self.free]
        return total

    def settle(self, s: Nodal) -> None:
        """The present state is the one that increments start from."""
        s.extra["turn"][self.nodes] = 0.0
        s.extra["settled"][self.nodes] = s.d[self.nodes, self.own]

    # ---- rates ------------------------------------------------------------------------------------
    def begin_step(self, s: Nodal, rule: tuple[float, float] | None) -> None:
        """The present state becomes the last converged one; rates are predicted for no further motion."""
        s.extra["turn"][self.nodes] = s.extra["turned"][self.nodes] = 0.0
        s.extra["settled"][self.nodes] = s.d[self.nodes, self.own]
        for name in RATES:
            s.extra[f"{name}_old"] = s.extra[name].copy()
        if rule is not None:
            self.rates(s, rule)

    def rates(self, s: Nodal, rule: tuple[float, float]) -> None:
        """w and a at the present rotation by Newmark's ``rule`` (beta, gamma)."""
        dt, (beta, gamma) = s.dt, rule
        n, a = self.nodes, 1.0 / (beta * dt)
        before = of_vector(s.d_old[n, self.own])
        back = conjugate(before)
        q = s.extra["turned"][n]
        growth, w, al = (rotate(back, v) for v in (q, s.extra["spin_old"][n], s.extra["spin rate_old"][n]))
        now = product(of_vector(q), before)
        s.extra["spin"][n] = rotate(
            now, growth * (gamma * a) + w * (1.0 - gamma / beta) + al * (dt * (1.0 - 0.5 * gamma / beta))
        )
        s.extra["spin rate"][n] = rotate(now, growth * (a / dt) - w * a + al * (1.0 - 0.5 / beta))

    @staticmethod
    def slopes(s: Nodal, rule: tuple[float, float], nodes: NDArray[np.integer]) -> tuple[Floats, Floats]:
        """Derivatives (..., 3, 3) of w and a at nodes by a further rotation of these."""
        X, a = of_increment(s.extra["turned"][nodes]), 1.0 / (rule[0] * s.dt)
        return (
            rule[1] * a * X - skew(s.extra["spin"][nodes]),
            a / s.dt * X - skew(s.extra["spin rate"][nodes]),
        )
