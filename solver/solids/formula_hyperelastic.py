"""Isotropic and transversely isotropic solids whose energy is a formula of the file."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..points import Points
from ..record import variable_record
from .base import Floats, Property, Solid
from .fiber import directions
from .fourth_invariant import FourthInvariant, UncoupledFourthInvariant, invariants
from .hyperelastic import Hyperelastic, UncoupledHyperelastic, columns
from .registry import register
from .secant import central_tangent

#: W of a dict of arrays: I1, I2, J, X, Y, Z, or I1, I2, I4, I5, J
Formula = Callable[[dict[str, Floats]], Floats]
_STEP = 2e-4  # relative; sixth-order differences


def _around(W: Formula, at: dict[str, Floats], name: str) -> tuple[Floats, dict[int, Floats]]:
    """A step of a variable, and W up to three of them to either side."""
    h = _STEP * np.maximum(np.abs(at[name]), 1.0)
    return h, {k: np.asarray(W({**at, name: at[name] + k * h}), dtype=float) for k in (-3, -2, -1, 1, 2, 3)}


def _slope(h: Floats, w: dict[int, Floats]) -> Floats:
    return (45 * (w[1] - w[-1]) - 9 * (w[2] - w[-2]) + (w[3] - w[-3])) / (60 * h)


def _derivatives(W: Formula, at: dict[str, Floats], names: tuple[str, ...]) -> dict[str, Floats]:
    """First and second derivatives of W by ``names``, keyed "I1" or "I1I2"."""

    def shifted(**shift: Floats) -> Floats:
        return np.asarray(W({**at, **{k: at[k] + v for k, v in shift.items()}}), dtype=float)

    out: dict[str, Floats] = {}
    zero = shifted()
    for a in names:
        h, w = _around(W, at, a)
        out[a] = _slope(h, w)
        second = 270 * (w[1] + w[-1]) - 27 * (w[2] + w[-2]) + 2 * (w[3] + w[-3]) - 490 * zero
        out[a + a] = second / (180 * h**2)
    a, b = names[:2]
    h, k = (20 * _STEP * np.maximum(np.abs(at[x]), 1.0) for x in (a, b))

    def cross(m: float) -> Floats:
        corners = [shifted(**{a: p * m * h, b: q * m * k}) * p * q for p in (-1, 1) for q in (-1, 1)]
        return sum(corners) / (4 * m * m * h * k)  # type: ignore[return-value]

    out[a + b] = (4 * cross(0.5) - cross(1.0)) / 3
    return out


def _places(pts: Points) -> dict[str, Floats]:
    return {"X": pts.X[:, 0], "Y": pts.X[:, 1], "Z": pts.X[:, 2]}


@variable_record
class FormulaHyperelastic(Hyperelastic):
    """W(I1, I2, J, X, Y, Z)."""

    W: Formula | None = None
    properties = {"W": Property("energy")}

    def derivatives(self, pts: Points, I1: Floats, I2: Floats, J: Floats) -> Floats:
        at = {"I1": I1, "I2": I2, "J": J, **_places(pts)}
        d = _derivatives(self.W, at, ("I1", "I2", "J"))  # type: ignore[arg-type]
        return columns(pts, d["I1"], d["I2"], d["I1I1"], d["I1I2"], d["I2I2"], d["J"], d["JJ"])

    def potential(self, pts: Points, I1: Floats, I2: Floats, J: Floats) -> Floats:
        return self.W({"I1": I1, "I2": I2, "J": J, **_places(pts)})  # type: ignore[misc]


@variable_record
class FormulaHyperelasticUncoupled(UncoupledHyperelastic):
    """W~(I1~, I2~, X, Y, Z)."""

    W: Formula | None = None
    properties = {"W": Property("energy")}

    def derivatives(self, pts: Points, I1: Floats, I2: Floats) -> Floats:
        d = _derivatives(self.W, {"I1": I1, "I2": I2, **_places(pts)}, ("I1", "I2"))  # type: ignore[arg-type]
        return columns(pts, d["I1"], d["I2"], d["I1I1"], d["I1I2"], d["I2I2"])

    def potential(self, pts: Points, I1: Floats, I2: Floats) -> Floats:
        return self.W({"I1": I1, "I2": I2, **_places(pts)})  # type: ignore[misc]


@variable_record
class _FormulaTransIso(Solid):
    """The fiber is a direction in global axes, as in FEBio."""

    W: Formula | None = None
    properties = {"W": Property("fiber energy"), **FourthInvariant.properties}

    def inner(self, pts: Points) -> Points:
        return pts.but(Q=None)

    def derivatives(self, pts: Points, i: dict[str, Floats]) -> tuple[Floats | float, ...]:
        at = self._at(pts, i)
        names = [n for n in ("I1", "I2", "I4", "I5", "J") if n in at]
        return tuple(_slope(*_around(self.W, at, n)) for n in names)  # type: ignore[arg-type]

    def _at(self, pts: Points, i: dict[str, Floats]) -> dict[str, Floats]:
        return i

    def _tangent(self, pts: Points) -> Floats:
        c = central_tangent(self._cauchy, pts)  # type: ignore[attr-defined]
        return np.asarray(0.5 * (c + c.transpose(0, 2, 1)))  # rounding of differences of differences

    def _value(self, pts: Points) -> Floats:
        a0 = directions(self.fiber, self.inner(pts))  # type: ignore[attr-defined]
        W = self.W(self._at(pts, invariants(pts, a0, self.iso)))  # type: ignore[attr-defined, misc]
        return np.broadcast_to(W, (pts.n,))


@variable_record
class FormulaTransIso(_FormulaTransIso, FourthInvariant):
    """W(I1, I2, I4, I5, J)."""

    def _at(self, pts: Points, i: dict[str, Floats]) -> dict[str, Floats]:
        return {**i, "J": pts.J}

    def energy(self, pts: Points) -> Floats:
        return self._value(pts)


@variable_record
class FormulaTransIsoUncoupled(_FormulaTransIso, UncoupledFourthInvariant):
    """W~(I1~, I2~, I4~, I5~)."""

    def dev_energy(self, pts: Points) -> Floats:
        return self._value(pts)


register(FormulaTransIso, "trans-iso hyperelastic")
register(FormulaTransIsoUncoupled, "uncoupled trans-iso hyperelastic")
register(FormulaHyperelastic, "hyperelastic")
register(FormulaHyperelasticUncoupled, "uncoupled hyperelastic")
