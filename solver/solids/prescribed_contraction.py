"""Prescribed active stresses, per reference area: T0 along, across or all around the first local axis."""

from __future__ import annotations

from dataclasses import field
from typing import Any, ClassVar

import numpy as np

from ..jit import kernel
from ..kernels.tensors import dyad_of, left_cauchy_green
from ..points import Points
from ..record import variable_record
from .base import Floats, Number, Property, Solid
from .fiber import directions
from .registry import register
from .uncoupled import Uncoupled


@kernel
def _run(F, J, a0, T0, along, around, s):
    """s += T0 (along N + around b) / J, N = n dyad n, n = F a0."""
    b, N = np.empty(6), np.empty(6)
    for i in range(len(J)):
        d = i if a0.shape[0] > 1 else 0
        m = i if T0.shape[0] > 1 else 0
        x = F[i, 0, 0] * a0[d, 0] + F[i, 0, 1] * a0[d, 1] + F[i, 0, 2] * a0[d, 2]
        y = F[i, 1, 0] * a0[d, 0] + F[i, 1, 1] * a0[d, 1] + F[i, 1, 2] * a0[d, 2]
        z = F[i, 2, 0] * a0[d, 0] + F[i, 2, 1] * a0[d, 1] + F[i, 2, 2] * a0[d, 2]
        dyad_of(x, y, z, N)
        left_cauchy_green(F, i, 1.0, b)
        for p in range(6):
            s[i, p] += T0[m] / J[i] * (along * N[p] + around * b[p])


@variable_record
class _Contraction:
    """S = T0 M with M constant in the reference: the tangent is zero."""

    T0: Number = 0.0
    parameters: ClassVar[tuple[str, ...]] = ("T0",)
    along, around = 1.0, 0.0

    def _add(self, pts: Points, s: Floats) -> None:
        a0 = directions(getattr(self, "fiber", None), self.inner(pts))  # type: ignore[attr-defined]
        T0 = np.ascontiguousarray(self.par(pts)[:, 0])  # type: ignore[attr-defined]
        _run(pts.F, pts.J, a0, T0, self.along, self.around, s)

    def _work(self, pts: Points) -> Floats:
        """T0 M : E."""
        a0 = directions(getattr(self, "fiber", None), self.inner(pts))  # type: ignore[attr-defined]
        n = np.einsum("nij,nj->ni", pts.F, np.broadcast_to(a0, (pts.n, 3)))
        E = self.along * ((n**2).sum(1) - 1.0) + self.around * ((pts.F**2).sum((1, 2)) - 3.0)
        return 0.5 * self.par(pts)[:, 0] * E  # type: ignore[attr-defined, no-any-return]


@variable_record
class Uniaxial(_Contraction, Solid):
    """sigma = T0 n dyad n / J, n = F e1."""

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        self._add(pts, s)

    def energy(self, pts: Points) -> Floats:
        return self._work(pts)


@variable_record
class TransIso(Uniaxial):
    """sigma = T0 (b - n dyad n) / J."""

    along, around = -1.0, 1.0


@variable_record
class Isotropic(Uniaxial):
    """sigma = T0 b / J."""

    along, around = 0.0, 1.0


@variable_record
class AlongFiber(Uniaxial):
    """sigma = T0 n dyad n / J along a fiber direction."""

    fiber: Any = field(default=None, kw_only=True)
    properties = {"fiber": Property("direction", default="vector")}


@variable_record
class UniaxialUncoupled(_Contraction, Uncoupled):
    """:class:`Uniaxial` as the distortional part; not made deviatoric, as in FEBio."""

    def dev(self, pts: Points, s: Floats, c: Floats | None) -> None:
        self._add(pts, s)

    def dev_energy(self, pts: Points) -> Floats:
        return self._work(pts)


@variable_record
class TransIsoUncoupled(UniaxialUncoupled):
    """:class:`TransIso` as the distortional part."""

    along, around = -1.0, 1.0


@variable_record
class IsotropicUncoupled(UniaxialUncoupled):
    """:class:`Isotropic` as the distortional part."""

    along, around = 0.0, 1.0


@variable_record
class AlongFiberUncoupled(UniaxialUncoupled):
    """:class:`AlongFiber` as the distortional part."""

    fiber: Any = field(default=None, kw_only=True)
    properties = {"fiber": Property("direction", default="vector")}


register(Uniaxial, "prescribed uniaxial active contraction")
register(TransIso, "prescribed trans iso active contraction")
register(Isotropic, "prescribed isotropic active contraction")
register(AlongFiber, "prescribed fiber active contraction")
register(UniaxialUncoupled, "uncoupled prescribed uniaxial active contraction")
register(TransIsoUncoupled, "uncoupled prescribed trans iso active contraction")
register(IsotropicUncoupled, "uncoupled prescribed isotropic active contraction")
register(AlongFiberUncoupled, "uncoupled prescribed fiber active contraction")
