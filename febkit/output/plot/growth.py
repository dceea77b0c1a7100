"""The growth tensor Fg of kinematic growth, by the measures of :mod:`.kinematics`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from febkit.solver.matrices import det
from febkit.solver.solids.voigt import spectral, vector

from .base import Floats, Part, mean, of_solids, register

I = np.eye(3)


def of_growth(measure: Callable[[Floats], Floats]) -> Callable[[Part], Floats | None]:
    """A measure (n, ...) of Fg (n, 3, 3) at the points; None where nothing grows."""

    def points(part: Part) -> Floats | None:
        law: Any = part.g.block.solid
        if type(law).__name__ != "KinematicGrowth":
            return None
        pts = part.points()
        Fg = np.broadcast_to(law.growth.tensor(law.inner(pts)), (pts.n, 3, 3))
        return part.shaped(measure(Fg))

    return points


def _right(F: Floats) -> Floats:
    return np.swapaxes(F, 1, 2) @ F


def _left(F: Floats) -> Floats:
    return F @ np.swapaxes(F, 1, 2)


def _small(F: Floats) -> Floats:
    return vector(0.5 * (F + np.swapaxes(F, 1, 2)) - I)


register("growth Lagrange strain", mean(of_growth(lambda F: vector(0.5 * (_right(F) - I)))))
register("growth infinitesimal strain", mean(of_solids(of_growth(_small))))
register("growth right stretch", mean(of_growth(lambda F: vector(spectral(_right(F), np.sqrt)))))
register("growth left stretch", mean(of_growth(lambda F: vector(spectral(_left(F), np.sqrt)))))
register("growth right Hencky", mean(of_growth(lambda F: vector(0.5 * spectral(_right(F), np.log)))))
register("growth left Hencky", mean(of_growth(lambda F: vector(0.5 * spectral(_left(F), np.log)))))
register("growth relative volume", mean(of_growth(det)))
