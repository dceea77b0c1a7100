"""Arc length: a time step is a way along the path of equilibrium, and how much of the loads acts is an unknown.

Residual R = lambda Fext - Fint. An iteration's direction is u + g uF with K u = R and K uF = Fext, lambda grows
by g, and g keeps the increment U of the step at the radius r: |U + u + g uF|^2 + psi^2 (dlambda + g)^2 |Fext|^2
= r^2, of both roots the one that turns least (Crisfield, "A fast incremental/iterative solution procedure that
handles snap-through", Comput Struct 13 (1981) 55). The first step of an analysis takes lambda = its size, and
its length is r; later ones begin on the side to which the last one went. As in FEBio loads have their stiffness
whatever lambda is.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .convergence import NotConverged
from .loop import Loop
from .vectors import dot

if TYPE_CHECKING:
    from .newton import Newton

Floats = NDArray[np.float64]


class ArcLength(Loop):
    """``factor`` is lambda; ``radius`` r, None before the first step; ``last`` the increment of the last step."""

    def __init__(self, newton: Newton) -> None:
        super().__init__(newton)
        self.psi = newton.options.arc_length_scale
        self.factor = self.grown = 0.0
        self.radius: float | None = None
        self.last: Floats | None = None
        self.external: Floats = np.zeros(0)

    def residual(self, internal: Floats, external: Floats) -> Floats:
        """lambda Fext - Fint."""
        self.external = external
        return internal + self.factor * external

    def solve(self) -> None:
        self.grown = 0.0
        self.newton.system.join = self.residual
        super().solve()
        self.last = self.newton.increment.copy()

    def direction(self, R0: Floats) -> Floats:
        """Solution for the residual, and as much of that for the loads as leads to the sphere."""
        u, uF = self.qn.solve(R0), self.qn.solve(self.external)
        force = dot(self.external, self.external)
        g = self._first(uF, force) if self.newton.count.iterations == 0 else self._next(u, uF, force)
        self.grown += g
        self.factor += g
        return u + g * uF

    def _first(self, uF: Floats, force: float) -> float:
        length = math.sqrt(dot(uF, uF) + self.psi * force)
        if not length > 0.0:
            raise NotConverged("no load acts that the arc-length method could scale")
        if self.last is None:
            g = float(self.newton.system.state.dt)
            self.radius = g * length
            return g
        assert self.radius is not None
        return math.copysign(self.radius / length, dot(uF, self.last))

    def _next(self, u: Floats, uF: Floats, force: float) -> float:
        assert self.radius is not None
        U, scale = self.newton.increment, self.psi**2 * force
        whole = U + u
        a = dot(uF, uF) + scale
        b = 2.0 * dot(uF, whole) + 2.0 * scale * self.grown
        c = dot(whole, whole) - self.radius**2 + scale * self.grown**2
        roots = np.roots([a, b, c])
        if np.iscomplexobj(roots):
            self.radius *= 0.5
            raise NotConverged("the arc-length method found no point at its distance; half of it is tried")

        def cosine(g: float) -> float:
            """Between the increment so far and the one with g."""
            to, grown = whole + g * uF, self.grown + g
            along = dot(U, to) + scale * self.grown * grown
            return along / math.sqrt(dot(to, to) + scale * grown**2)

        return max((float(g) for g in roots), key=cosine)

    # ---- what a failed try gives back -------------------------------------------------------------
    def snapshot(self) -> Any:
        return self.factor, self.radius, None if self.last is None else self.last.copy()

    def restore(self, saved: Any) -> None:
        """All but a radius that was halved since."""
        self.factor, radius, self.last = saved
        if radius is None or self.radius is None:
            self.radius = radius
        else:
            self.radius = min(radius, self.radius)
