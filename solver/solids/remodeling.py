"""Solids that gain and lose mass under load, and stiffness with it: remodeling of bone."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from ..law import Law
from ..points import Points
from ..values import Constant, as_value
from .base import Floats, Number, Property, Solid
from .registry import register

MOST = 100  # Newton steps for a density
TIGHT = 1e-14  # of a density, in them


@dataclass(eq=False)
class HuiskesSupply(Law):
    """Mass per time and reference volume B (W / rho - k).

    Weinans, Huiskes & Grootenboer, J. Biomech. 25 (1992) 1425. Sensors sense the point they are at (D = 0).
    """

    B: Number = 0.0
    k: Number = 0.0
    D: Number = 0.0
    parameters: ClassVar[tuple[str, ...]] = ("B", "k", "D")
    properties: ClassVar[dict[str, Property]] = {}

    def __post_init__(self) -> None:
        super().__post_init__()
        if np.any(as_value(self.D)(0.0, np.zeros((1, 3))) != 0.0):
            raise ValueError("a sensor distance <D> other than 0 is not supported by febkit's solver")

    def supply(self, pts: Points, w: Floats) -> tuple[Floats, Floats]:
        """The supply (n,) at a specific energy w = W / rho (n,), and its derivative by w (1|n,)."""
        B, k = self.par(pts).T[:2]
        return B * (w - k), B


@dataclass(eq=False)
class Remodeling(Solid):
    """rho = rho_old + dt supply(W(F, rho) / rho), kept within ``min_density`` and ``max_density``.

    History: how far rho is from the density of ``solid`` at the start. FEBio's rho follows its iterates, which end
    where the equation holds; here it holds in each evaluation. FEBio user manual, "Remodeling solid".
    """

    min_density: Number = 0.0
    max_density: Number = 0.0
    solid: Any = None
    supply: Any = None
    parameters = ("min_density", "max_density")
    properties: ClassVar[dict[str, Property]] = {
        "solid": Property("remodeled"),
        "supply": Property("solid_supply"),
    }
    history = 1

    def __post_init__(self) -> None:
        super().__post_init__()
        least, most = self.min_density, self.max_density
        if isinstance(least, Constant) and isinstance(most, Constant) and not 0.0 <= least.number < most.number:
            raise ValueError(f"<max_density> {most.number:g} must be above <min_density> {least.number:g}, both from 0")

    def _density(self, pts: Points) -> tuple[Floats, Floats]:
        """rho (n,), and d ln(rho) / dW at a given rho, zero at its bounds."""
        start = self.solid.density(pts)
        old = np.broadcast_to(start if pts.old is None else start + pts.old[:, self.offset], (pts.n,))
        least, most = self.par(pts).T
        power = self.solid.exponent(pts)
        rho = np.clip(old, least, most) if pts.dt > 0 else old
        by_energy = np.zeros(pts.n)
        for _ in range(MOST if pts.dt > 0 else 0):
            w = self.solid.energy_at(pts, rho) / rho
            gain, slope = self.supply.supply(pts, w)
            by_energy = pts.dt * slope / rho
            fall = 1.0 - by_energy * (power - 1.0) * w  # of the equation's gap, by rho
            # beyond its fold the equation has no root that growth from the old density could reach
            step = np.where(fall > 0.0, (old + pts.dt * gain - rho) / np.where(fall > 0.0, fall, 1.0), np.inf)
            by_energy = by_energy / np.where(fall > 0.0, fall, 1.0)
            new = np.clip(rho + step, least, most)
            done = np.abs(new - rho).max(initial=0.0) <= TIGHT * np.abs(rho).max(initial=0.0)
            rho = new
            if done:
                break
        inside = (rho > least) & (rho < most)
        return rho, np.where(inside, by_energy / rho, 0.0)

    def _state(self, pts: Points) -> tuple[Points, Floats]:
        within = self.inner(pts)
        rho, by_energy = self._density(within)
        if pts.new is not None:
            pts.new[:, self.offset] = rho - self.solid.density(within)
        return replace(within, extra={**within.extra, "density": rho}), by_energy

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        """The tangent has J gamma (d ln rho / dW) sigma sigma besides that of the solid."""
        at, by_energy = self._state(pts)
        own = np.zeros_like(s)
        self.solid.stress(at, own, c)
        s += own
        if c is not None:
            c += (pts.J * self.solid.exponent(at) * by_energy)[:, None, None] * (own[:, :, None] * own[:, None, :])

    def energy(self, pts: Points) -> Floats:
        at, _ = self._state(replace(pts, new=None))
        return np.asarray(self.solid.energy(at))

    def density(self, pts: Points) -> Floats:
        kept = pts.old if pts.new is None else pts.new
        start = self.solid.density(pts)
        return np.asarray(start if kept is None else start + kept[:, self.offset])


register(HuiskesSupply, "Huiskes-supply", "solid_supply")
register(Remodeling, "remodeling solid")
