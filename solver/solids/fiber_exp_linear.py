"""Fibers with an exponential toe, then linear, in the stretch."""

from __future__ import annotations

import math

import numpy as np

from ..jit import kernel
from ..kernels.fibers import add_fibers, squared_stretch
from ..points import Points
from ..record import variable_record
from ..special import expi
from .base import Floats, Number, wanted
from .fiber import Fiber, FiberLaw, UncoupledFiber
from .registry import register


@kernel
def tension(In, par, sn, cn):
    """Columns of ``par``: c3, c4, c5, lambda."""
    for i in range(In.shape[0]):
        m = i if par.shape[0] > 1 else 0
        c3, c4, c5, lam1 = par[m, 0], par[m, 1], par[m, 2], par[m, 3]
        if c3 == 0.0 and c4 != 0.0:
            c3 = c5 / c4 * math.exp(-c4 * (lam1 - 1.0))
        c6 = c3 * (math.exp(c4 * (lam1 - 1.0)) - 1.0) - c5 * lam1
        for j in range(In.shape[1]):
            sn[i, j] = cn[i, j] = 0.0
            l = math.sqrt(In[i, j])
            if l >= 1.0:
                if l < lam1:
                    e = math.exp(c4 * (l - 1.0))
                    sn[i, j] = c3 * (e - 1.0)
                    cn[i, j] = c3 * (2.0 + e * (c4 * l - 2.0))
                else:
                    sn[i, j] = c5 * l + c6
                    cn[i, j] = -c5 * l - 2.0 * c6


def fiber_energy(In: Floats, par: Floats) -> Floats:
    """W (n, m) of the law; Ei is the exponential integral."""
    c3, c4, c5, lam1 = par.T[:, :, None]
    c3 = np.where(c3 == 0, c5 / np.where(c4 == 0, 1.0, c4) * np.exp(-c4 * (lam1 - 1)), c3)
    c6 = c3 * np.expm1(c4 * (lam1 - 1)) - c5 * lam1
    lam = np.maximum(np.sqrt(In), 1.0)
    toe, tail = np.minimum(lam, lam1), np.maximum(lam, lam1)
    some = np.where(c4 == 0, 1.0, c4)
    curled = np.exp(-c4) * (expi(some * toe) - expi(some)) - np.log(toe)
    return c3 * np.where(c4 == 0, 0.0, curled) + c5 * (tail - lam1) + c6 * np.log(tail / lam1)


def add_family(pts: Points, a0: Floats, par: Floats, s: Floats, c: Floats | None) -> None:
    """Add the distortional stress of fibers of this law along ``a0`` (1|n, 3); ``par`` c3, c4, c5, lambda."""
    In = np.empty((pts.n, 1))
    squared_stretch(pts.F, pts.J, a0[:, None], True, In)
    sn, cn = np.empty_like(In), np.empty_like(In)
    tension(In, par, sn, cn)
    add_fibers(pts.F, pts.J, a0[:, None], np.ones((1, 1)), In, sn, cn, np.empty((0, 0)), True, s, wanted(c))


def family_energy(pts: Points, a0: Floats, par: Floats) -> Floats:
    """Distortional energy (n,) of fibers of this law along ``a0``."""
    In = np.empty((pts.n, 1))
    squared_stretch(pts.F, pts.J, a0[:, None], True, In)
    return fiber_energy(In, par)[:, 0]


@variable_record
class _ExpLinear(FiberLaw):
    def tension(self, pts: Points, In: Floats, sn: Floats, cn: Floats) -> Floats:
        tension(In, self.par(pts), sn, cn)  # type: ignore[attr-defined]
        return np.empty((0, 0))

    def fiber_energy(self, pts: Points, In: Floats) -> Floats:
        return fiber_energy(In, self.par(pts))  # type: ignore[attr-defined]


@variable_record
class FiberExpLinear(_ExpLinear, Fiber):
    """l dW/dl = c3 (exp[c4 (l - 1)] - 1) for 1 <= l < lambda, c5 l + c6 beyond.

    c6 makes the tension continuous; c3 = 0 asks for the c3 that makes the modulus continuous.
    Weiss, Maker & Govindjee, Comput. Methods Appl. Mech. Eng. 135 (1996) 107.
    """

    c3: Number = 0.0
    c4: Number = 0.0
    c5: Number = 0.0
    lambda_: Number = 1.0
    parameters = ("c3", "c4", "c5", "lambda_")


@variable_record
class FiberExpLinearUncoupled(_ExpLinear, UncoupledFiber):
    """The law of :class:`FiberExpLinear` in the distortional stretch."""

    c3: Number = 0.0
    c4: Number = 0.0
    c5: Number = 0.0
    lambda_: Number = 1.0
    parameters = ("c3", "c4", "c5", "lambda_")


for _table in ("solid", "fiber"):
    register(FiberExpLinear, "fiber-exp-linear", _table)
    register(FiberExpLinearUncoupled, "uncoupled fiber-exp-linear", _table)
