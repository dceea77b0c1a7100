"""A solid whose stress is the mean of a representative volume's, solved at each point (first-order homogenisation)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from ..points import Points
from .base import Floats, Property, Solid
from .registry import register


@dataclass(eq=False)
class Micro(Solid):
    """sigma = <sigma>, of a volume whose boundary moves by (F - 1) X. FEBio user manual, "Micro-material".

    The history of a point is the state of its volume (:class:`..rve.Rve`). Kouznetsova, Brekelmans & Baaijens, Comput.
    Mech. 27 (2001) 37; the tangent is that of the mean, where FEBio leaves out what the inside does.
    """

    RVE: Any = None
    properties: ClassVar[dict[str, Property]] = {"RVE": Property("rve")}
    beside: ClassVar[tuple[str, ...]] = ("bc_set", "rve_type", "scale", "probe")  # read with the volume

    def __post_init__(self) -> None:
        super().__post_init__()
        self.history = self.RVE.width

    def initial(self, n: int) -> Floats:
        return np.tile(self.RVE.rest, (n, 1))

    def _solved(self, pts: Points, i: int) -> None:
        """Solve the volume of point i, and keep its state."""
        at = slice(self.offset, self.offset + self.history)
        start = self.RVE.rest if pts.old is None else pts.old[i, at]
        row = self.RVE.solve(pts.F[i], start, pts.t, pts.dt)
        if pts.new is not None:
            pts.new[i, at] = row

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        with self.RVE.lock:
            for i in range(pts.n):
                self._solved(pts, i)
                s[i] += self.RVE.stress()
                if c is not None:
                    c[i] += self.RVE.tangent()

    def energy(self, pts: Points) -> Floats:
        out = np.empty(pts.n)
        with self.RVE.lock:
            for i in range(pts.n):
                start = self.RVE.rest if pts.old is None else pts.old[i, self.offset : self.offset + self.history]
                self.RVE.solve(pts.F[i], start, pts.t, pts.dt)
                out[i] = self.RVE.energy()
        return out


register(Micro, "micro-material")
