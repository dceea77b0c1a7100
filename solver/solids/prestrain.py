"""Solids that are strained in the reference configuration."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, ClassVar

import numpy as np

from ..matrices import det
from ..points import Points
from ..record import variable_record
from ..values import as_value
from .base import Floats, Number, Property, Solid, deformed
from .fiber import directions
from .registry import register
from .uncoupled import Uncoupled, distortional, distortional_energy


@variable_record
class _Prestrained:
    """F0 = Fc F_given; the correction Fc is a history where :meth:`correctable` says so, else the identity."""

    elastic: Solid | None = None
    prestrain: Any = None
    properties: ClassVar[dict[str, Property]] = {
        "elastic": Property("solid"),
        "prestrain": Property("prestrain", optional=True),
    }

    def __post_init__(self) -> None:
        super().__post_init__()  # type: ignore[misc]
        if self.prestrain is not None:
            self.prestrain.solid = self.elastic

    def correctable(self) -> None:
        """Make room for corrections (:class:`..loads.prestrain.PrestrainCorrection`); before the first step."""
        self.history = 9

    @property
    def corrects(self) -> bool:
        return self.history > 0

    def initial(self, n: int) -> Floats:
        return np.tile(np.eye(3).ravel()[: self.history], (n, 1))

    def correction(self, pts: Points) -> Floats | None:
        """Fc (n, 3, 3), which augmentations write; None where there is none."""
        kept = pts.old if pts.new is None else pts.new
        if not self.history or kept is None:
            return None
        first = int(self.offset)  # type: ignore[attr-defined]
        return kept[:, first : first + 9].reshape(-1, 3, 3)

    def gradient(self, pts: Points) -> Floats | None:
        """F0 at points seen with the solid's axes; None where it is the identity."""
        given = None if self.prestrain is None else self.prestrain.gradient(pts)
        Fc = self.correction(pts)
        return given if Fc is None else Fc if given is None else Fc @ given

    def _state(self, pts: Points) -> Points:
        """The points with F F0."""
        within = self.inner(pts)  # type: ignore[attr-defined]
        F0 = self.gradient(within)
        return within if F0 is None else deformed(within, within.F @ F0)

    def density(self, pts: Points) -> Floats:
        rho = as_value(self.density_)(pts.t, pts.X, pts.e)  # type: ignore[attr-defined]
        F0 = self.gradient(self.inner(pts))  # type: ignore[attr-defined]
        return rho if F0 is None else rho / det(F0)


@variable_record
class Prestrained(_Prestrained, Solid):
    """sigma = sigma_0(F F0). Maas et al., J. Mech. Behav. Biomed. Mater. 61 (2016) 499."""

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        self.elastic.stress(self._state(pts), s, c)  # type: ignore[union-attr]

    def energy(self, pts: Points) -> Floats:
        return self.elastic.energy(self._state(pts))  # type: ignore[union-attr]


@variable_record
class PrestrainedUncoupled(_Prestrained, Uncoupled):
    """The distortional stress of F F0; the volumetric part sees F."""

    def dev(self, pts: Points, s: Floats, c: Floats | None) -> None:
        distortional(self.elastic)(self._state(pts), s, c)  # type: ignore[arg-type]

    def dev_energy(self, pts: Points) -> Floats:
        return distortional_energy(self.elastic, self._state(pts))  # type: ignore[arg-type]


@variable_record
class PrestrainGradient:
    """F0(t) = (1 - ramp) I + ramp F0; ``F0`` is nine values by rows, or a function of points giving (1|n, 3, 3)."""

    ramp: Number = 1.0
    F0: Any = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
    parameters: ClassVar[tuple[str, ...]] = ("ramp", "F0")
    vectors: ClassVar[dict[str, int]] = {"F0": 9}
    options: ClassVar[tuple[str, ...]] = ()
    properties: ClassVar[dict[str, Property]] = {}
    solid: Any = None

    def gradient(self, pts: Points) -> Floats:
        ramp = as_value(self.ramp)(pts.t, pts.X, pts.e)[:, None, None]
        if callable(self.F0):
            F0 = np.asarray(self.F0(pts), dtype=float)
        else:
            numbers = np.ravel(self.F0) if isinstance(self.F0, np.ndarray) else self.F0
            cols = (as_value(v)(pts.t, pts.X, pts.e) for v in numbers)
            F0 = np.stack(np.broadcast_arrays(*cols), axis=-1)
        F0 = F0.reshape(-1, 3, 3)
        return (1.0 - ramp) * np.eye(3) + ramp * F0


@variable_record
class InSituStretch:
    """F0 = l n dyad n + (I - n dyad n) l^-1/2 along the fiber n of the elastic solid (no l^-1/2 if not isochoric)."""

    stretch: Number = 1.0
    isochoric: int = 1
    parameters: ClassVar[tuple[str, ...]] = ("stretch",)
    options: ClassVar[tuple[str, ...]] = ("isochoric",)
    properties: ClassVar[dict[str, Property]] = {}
    solid: Any = None

    def gradient(self, pts: Points) -> Floats:
        l = as_value(self.stretch)(pts.t, pts.X, pts.e)[:, None, None]
        n = directions(self.solid.fiber, replace(pts))
        A = n[:, :, None] * n[:, None, :]
        return l * A + (np.eye(3) - A) * (1.0 / np.sqrt(l) if self.isochoric else 1.0)


register(Prestrained, "prestrain elastic")
register(PrestrainedUncoupled, "uncoupled prestrain elastic")
register(PrestrainGradient, "prestrain gradient", "prestrain")
register(InSituStretch, "in-situ stretch", "prestrain")
