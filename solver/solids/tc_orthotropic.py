"""Mooney-Rivlin solid with fibers along the three local axes (tension-compression nonlinear)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..kernels.fibers import add_fibers, squared_stretch
from ..points import Points
from .base import Floats, Number, wanted
from .invariants import isochoric_invariants
from .mooney_rivlin import run
from .registry import register
from .uncoupled import Uncoupled


@dataclass(eq=False)
class TCOrthotropic(Uncoupled):
    """W~ = c1 (I1~ - 3) + c2 (I2~ - 3) + sum_i ksi_i <l_i~ - 1>^beta_i along the local axes i."""

    c1: Number = 0.0
    c2: Number = 0.0
    beta: Any = (0.0, 0.0, 0.0)
    ksi: Any = (0.0, 0.0, 0.0)
    parameters = ("c1", "c2", "beta", "ksi")
    vectors = {"beta": 3, "ksi": 3}

    def _stretches(self, pts: Points) -> tuple[Floats, Floats]:
        Q = self.inner(pts).Q
        A = np.ascontiguousarray(np.eye(3)[None] if Q is None else np.swapaxes(Q, 1, 2))
        In = np.empty((pts.n, 3))
        squared_stretch(pts.F, pts.J, A, True, In)
        return A, In

    def dev(self, pts: Points, s: Floats, c: Floats | None) -> None:
        run(pts.F, pts.J, self.par(pts), s, wanted(c))
        A, In = self._stretches(pts)
        beta, ksi = self.vector("beta", pts), self.vector("ksi", pts)
        l = np.sqrt(In)
        on = l > 1.0
        x = np.where(on, l - 1.0, 1.0)
        Wl = np.where(on, beta * ksi * x ** (beta - 1.0), 0.0)
        Wll = np.where(on, beta * (beta - 1.0) * ksi * x ** (beta - 2.0), 0.0)
        sn, cn = l * Wl, In * Wll - l * Wl
        add_fibers(pts.F, pts.J, A, np.ones((1, 3)), In, sn, cn, np.empty((0, 0)), True, s, wanted(c))

    def dev_energy(self, pts: Points) -> Floats:
        I1, I2 = isochoric_invariants(pts)
        _, In = self._stretches(pts)
        x = np.maximum(np.sqrt(In) - 1.0, 0.0)
        fibers = np.where(x > 0, self.vector("ksi", pts) * x ** self.vector("beta", pts), 0.0).sum(1)
        c1, c2 = self.par(pts).T
        return c1 * (I1 - 3.0) + c2 * (I2 - 3.0) + fibers


register(TCOrthotropic, "TC nonlinear orthotropic")
