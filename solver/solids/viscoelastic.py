"""Quasi-linear viscoelastic solids: a Prony series of an elastic stress."""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar

import numpy as np

from ..kernels.prony import prony
from ..points import Points
from ..record import variable_record
from .base import Floats, Number, Property, Solid
from .registry import register
from .uncoupled import Uncoupled, distortional

_TERMS = 6
_NO_HISTORY = np.empty((0, 0))


@variable_record
class _Series:
    """S = g0 Se + sum_i g_i H_i, H_i(t) = exp(-dt/t_i) H_i(t - dt) + (1 - exp(-dt/t_i)) t_i/dt (Se - Se_old).

    History: Se, H_1 ... H_6 (second Piola-Kirchhoff). Puso & Weiss, J. Biomech. Eng. 120 (1998) 62.
    """

    elastic: Solid | None = None
    g0: Number = 1.0
    g1: Number = 0.0
    g2: Number = 0.0
    g3: Number = 0.0
    g4: Number = 0.0
    g5: Number = 0.0
    g6: Number = 0.0
    t1: Number = 1.0
    t2: Number = 1.0
    t3: Number = 1.0
    t4: Number = 1.0
    t5: Number = 1.0
    t6: Number = 1.0
    parameters: ClassVar[tuple[str, ...]] = (
        "g0", "g1", "g2", "g3", "g4", "g5", "g6", "t1", "t2", "t3", "t4", "t5", "t6",
    )
    properties: ClassVar[dict[str, Property]] = {"elastic": Property("solid")}
    history = 6 + 6 * _TERMS

    def _relax(
        self, pts: Points, s: Floats, c: Floats | None, law: Callable[[Points, Floats, Floats | None], None]
    ) -> None:
        se = np.zeros((pts.n, 6))
        ce = None if c is None else np.zeros((pts.n, 6, 6))
        law(self.inner(pts), se, ce)  # type: ignore[attr-defined]
        if pts.dt == 0:
            if c is not None and ce is not None:
                c += ce
            return
        at: int = self.offset  # type: ignore[attr-defined]
        old = np.zeros((pts.n, at + self.history)) if pts.old is None else pts.old
        new = _NO_HISTORY if pts.new is None else pts.new
        scale = np.empty(pts.n)
        prony(pts.F, pts.J, se, self.par(pts), pts.dt, at, old, new, s, scale)  # type: ignore[attr-defined]
        if c is not None and ce is not None:
            c += scale[:, None, None] * ce


@variable_record
class Viscoelastic(_Series, Solid):
    """Viscoelastic solid over a compressible one; no stress outside a time step (dt = 0)."""

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        self._relax(pts, s, c, self.elastic.stress)  # type: ignore[union-attr]


@variable_record
class UncoupledViscoelastic(_Series, Uncoupled):
    """Viscoelastic distortional stress over a nearly incompressible solid, whose bulk modulus it takes over."""

    def __post_init__(self) -> None:
        from ..values import as_value

        k = self.elastic.k if isinstance(self.elastic, Uncoupled) else as_value(0.0)
        super().__post_init__()
        if self.k.constant and self.k(0.0, np.zeros((1, 3)))[0] == 0.0:  # type: ignore[union-attr, operator]
            self.k = k

    def dev(self, pts: Points, s: Floats, c: Floats | None) -> None:
        self._relax(pts, s, c, distortional(self.elastic))  # type: ignore[arg-type]


register(Viscoelastic, "viscoelastic")
register(UncoupledViscoelastic, "uncoupled viscoelastic")
