"""Stiffness by how much of a solid-bound molecule there is, in solids of multiphasic materials."""

from __future__ import annotations

from ..points import Points
from .base import Floats, Number


class Bound:
    """(rho / rho0)^gamma multiplies what a solid bears; rho is the referential apparent density of molecule ``sbm``.

    ``sbm``: its place in the material; rho (n,) is that column of ``pts.extra["bound"]``, rho0 where a solid stands for
    itself. ``parameters`` end with rho0 and gamma.
    """

    sbm: int | str
    rho0: Number
    gamma: Number

    def factor(self, pts: Points) -> Floats:
        """(1|n,)."""
        rho0, gamma = self.par(pts)[:, -2:].T  # type: ignore[attr-defined]
        return (self.referential(pts) / rho0) ** gamma  # type: ignore[no-any-return]

    def referential(self, pts: Points) -> Floats:
        """rho (1|n,)."""
        bound = pts.extra.get("bound")
        return self.par(pts)[:, -2] if bound is None else bound[:, int(self.sbm)]  # type: ignore[no-any-return,attr-defined]

    def density(self, pts: Points) -> Floats:
        """Its mass density is that of the molecule."""
        return self.referential(pts)
