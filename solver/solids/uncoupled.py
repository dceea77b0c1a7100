"""Solids whose energy splits into a distortional and a volumetric part: W = W~(C~) + U(J)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import field
from typing import ClassVar

import numpy as np

from ..jit import kernel
from ..kernels.tensors import add_identity
from ..points import Points
from ..record import variable_record
from ..values import as_value
from .base import Floats, Number, Solid, wanted

Law = tuple[Callable[[Floats], Floats], Callable[[Floats], Floats], Callable[[Floats], Floats]]

_OGDEN: Law = (
    lambda J: 0.25 * (J * J - 2.0 * np.log(J) - 1.0),
    lambda J: 0.5 * (J - 1.0 / J),
    lambda J: 0.5 * (1.0 + 1.0 / (J * J)),
)

#: U, U' and U'' per bulk modulus, by FEBio's ``pressure_model``: default, NIKE3D, Abaqus, Abaqus (GOH)
VOLUMETRIC: tuple[Law, ...] = (
    (
        lambda J: 0.5 * np.log(J) ** 2,
        lambda J: np.log(J) / J,
        lambda J: (1.0 - np.log(J)) / (J * J),
    ),
    _OGDEN,
    (lambda J: 0.5 * (J - 1.0) ** 2, lambda J: J - 1.0, lambda J: np.ones_like(J)),
    _OGDEN,
)


@kernel
def add_volumetric(J, p, pJ, s, c):
    """Add p I and (p + J dp/dJ) I dyad I - 2 p I circle I; ``p`` and ``pJ`` (n,)."""
    for i in range(len(J)):
        for a in range(3):
            s[i, a] += p[i]
        if c.shape[0] > 0:
            add_identity(c, i, p[i] + J[i] * pJ[i], -2.0 * p[i])


@variable_record
class Uncoupled(Solid):
    """sigma = dev part(F~) + U'(J) I. Subclasses give ``dev(pts, s, c)`` and ``dev_energy(pts)``."""

    uncoupled: ClassVar[bool] = True
    k: Number = field(default=0.0, kw_only=True)  # bulk modulus; the root's counts
    pressure_model: int = field(default=0, kw_only=True)

    def __post_init__(self) -> None:
        super().__post_init__()
        self.k = as_value(self.k)
        self.pressure_model = int(self.pressure_model)
        for child in self.children:
            if isinstance(child, Uncoupled):
                child.k = as_value(0.0)

    def _bulk_modulus(self, pts: Points) -> Floats:
        return self.k(pts.t, pts.X, pts.e)  # type: ignore[operator]

    def volumetric(self, J: Floats, pts: Points) -> Floats:
        """U(J)."""
        return self._bulk_modulus(pts) * VOLUMETRIC[self.pressure_model][0](J)

    def pressure(self, J: Floats, pts: Points) -> Floats:
        """U'(J): the mean stress at relative volume ``J`` (n,)."""
        return self._bulk_modulus(pts) * VOLUMETRIC[self.pressure_model][1](J)

    def bulk(self, J: Floats, pts: Points) -> Floats:
        """U''(J)."""
        return self._bulk_modulus(pts) * VOLUMETRIC[self.pressure_model][2](J)

    def dev(self, pts: Points, s: Floats, c: Floats | None) -> None:
        """Add the distortional Cauchy stress and its tangent."""
        raise NotImplementedError

    def dev_energy(self, pts: Points) -> Floats:
        """W~ per reference volume (n,)."""
        raise NotImplementedError(f"{type(self).__name__} gives no strain energy")

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        self.dev(pts, s, c)
        add_volumetric(pts.J, self.pressure(pts.J, pts), self.bulk(pts.J, pts), s, wanted(c))

    def energy(self, pts: Points) -> Floats:
        return self.dev_energy(pts) + self.volumetric(pts.J, pts)


def distortional(solid: Solid) -> Callable[[Points, Floats, Floats | None], None]:
    """``solid.dev`` of an uncoupled solid, ``solid.stress`` of another: what a part adds within an uncoupled whole."""
    return solid.dev if isinstance(solid, Uncoupled) else solid.stress


def distortional_energy(solid: Solid, pts: Points) -> Floats:
    """Energy that goes with :func:`distortional`."""
    return solid.dev_energy(pts) if isinstance(solid, Uncoupled) else solid.energy(pts)
