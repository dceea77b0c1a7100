"""A time step solved by nonlinear conjugate gradients: residuals alone, no tangent. FEBio User Manual, "CG-solid".

Direction u = R + beta u', with y = R - R' against the last R', u': beta = -(y - 2 u' y.y / u'.y).R / u'.y and at least
-1 / (|u'| min(0.01, |R|)) (Hager and Zhang, SIAM J Optim 16 (2005) 170), or beta = 0; then a search for the step at
which u.R is small enough. FEBio's steps are kept one by one: which of several equilibria is found depends on them.
"""

from __future__ import annotations

from math import inf, isfinite, sqrt
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .convergence import Iteration, Norm, NotConverged
from .finite import NotFinite, whole
from .group import ElementFailure
from .vectors import dot

if TYPE_CHECKING:
    from .newton import Newton

Floats = NDArray[np.float64]
STEEPEST = "steepest descent"
FIRST = 1e-6  # length of step with which a search begins
FAILED = -1.0  # what stands for a search that found none
LINEAR = 4  # guesses by a straight line, before those by a parabola
ENOUGH = 5  # guesses after which any improvement will do
ZERO = 1e-20  # work that counts as none
DIVERGED = 1000.0  # growth of the energy after which directions begin anew


class ConjugateGradients:
    """See above."""

    stale = renewed = guessed = False

    def __init__(self, newton: Newton) -> None:
        self.newton = newton

    def solve(self) -> None:
        """Solve the present time step. Raises NotConverged, NotFinite and ElementFailure."""
        n = self.newton
        n.move(n.begin())
        self.R1 = n.residual()
        R: Floats | None = self.R1
        self.last: tuple[Floats, Floats] | None = None  # direction and residual of the last iteration
        self.lengths = FIRST, FIRST  # of the last two steps
        while R is not None:
            R = self._iterate(R)
            n.system.progress.iterations = n.count.iterations

    def _iterate(self, R: Floats) -> Floats | None:
        """One iteration: the residual after it, None where the step is solved."""
        n, k = self.newton, self.newton.count
        u, along = self._direction(R)
        if not whole(u):
            raise NotConverged("the direction of the conjugate gradients is not finite")
        self.last = u, R
        s = self._search(u, R, self.lengths[0])
        if s != FAILED:
            older = s if k.iterations == 0 else self.lengths[1]
            self.lengths = older, s if s > 0 else self.lengths[1]
            n.increment = n.system.compose(n.increment, s * u)
            n.system.settle()
        if k.iterations == 0:
            self.first = dot(R, R), abs(dot(u, R)) * s, dot(u, u) * s * s
            self.most = self.first[1]
        converged = self._judge(u, s)
        k.iterations += 1
        if converged:
            return None if not n.augments or n.augment() else n.residual()
        if s == FAILED and not along:
            raise NotConverged("the search along the residual found no step")
        return self.R1

    def _direction(self, R: Floats) -> tuple[Floats, bool]:
        """Where to go from residual R, and whether that leans on the last direction."""
        if self.last is None or self.newton.options.descent == STEEPEST:
            return R.copy(), False
        u, before = self.last
        y = R - before
        uy = dot(u, y)
        if uy == 0.0:
            return R.copy(), False
        beta = -dot(y - 2.0 * u * (dot(y, y) / uy), R) / uy
        least = -1.0 / (sqrt(dot(u, u)) * min(0.01, sqrt(dot(R, R))))
        return R + max(least, beta) * u, True

    def _judge(self, u: Floats, s: float) -> bool:
        """Are the norms small enough? Where not, directions may have to begin anew."""
        n, o, k = self.newton, self.newton.options, self.newton.count
        residual, energy = dot(self.R1, self.R1), s * abs(dot(u, self.R1))
        moved, total = dot(u, u) * s * s, dot(n.increment, n.increment)
        r0, e0, u0 = self.first
        norms = {
            "residual": Norm(r0, residual, o.rtol * r0), "energy": Norm(e0, energy, o.etol * e0),
            n.system.layout.fields[0].name: Norm(u0, moved, o.dtol**2 * total),
        }  # fmt: skip
        n.watch(Iteration(n.system.state.time, k.iterations + 1, 0, k.residuals, k.reforms, s, norms))
        tested = zip(norms.values(), (o.rtol, o.etol, o.dtol))
        bad = any(tol > 0 and norm.now > norm.required for norm, tol in tested) or energy > self.most
        if not (bad or (o.line_tolerance > 0 and s < o.line_minimum)) or residual < o.min_residual:
            return True
        if s == FAILED or abs(s) < o.line_minimum:
            self._anew()
        elif energy > DIVERGED * self.most:
            self.most, self.first = energy, (residual, energy, u0)
            self._anew()
        return False

    def _anew(self) -> None:
        self.last, self.lengths = None, (FIRST, FIRST)
        self.newton.count.reforms += 1

    # ---- how far along a direction ----------------------------------------------------------------
    def _at(self, step: Floats) -> bool:
        """Move there and take the residual; False where elements turn inside out, or nothing is finite."""
        try:
            self.newton.move(step)
            self.R1 = self.newton.residual()
        except (ElementFailure, NotFinite):
            return False
        return True

    def _search(self, u: Floats, R: Floats, s: float) -> float:
        """The length of the step along u from residual R, begun at s; FAILED where none was found."""
        o = self.newton.options
        f0 = dot(u, R)
        while not self._at(s * u):
            if not s > 10.0 * o.line_minimum:
                return FAILED
            s *= 0.1
        a, fa, b, fb = 0.0, f0, s, dot(u, self.R1)
        tried, work = [a, b], [fa, fb]
        for k in range(o.line_iterations):
            if not _ratio(fb, f0) > o.line_tolerance:
                return s
            s = _line(a, fa, b, fb) if k < LINEAR else _parabola(tried[:k], work[:k])
            s, f = self._guess(u, s, min(abs(fa), abs(fb)))
            if abs(fa) < abs(fb):
                b, fb = s, f
            else:
                a, fa = s, f
            tried.append(s)
            work.append(f)
            r = abs(f / f0) if f0 else inf
            more = (r > o.line_tolerance and k < ENOUGH) or (r >= 1.0 and k >= LINEAR - 1)
            if not more and k + 1 < o.line_iterations:
                return s
        return FAILED

    def _guess(self, u: Floats, s: float, least: float) -> tuple[float, float]:
        """The step s, or a tenth of it and so on where elements turn inside out or the work is no guess's; its work."""
        o = self.newton.options
        if not isfinite(s):
            raise NotConverged("the search along a direction of the conjugate gradients came to no number")
        while not self._at(s * u):
            s *= 0.1
            if not s > o.line_minimum:
                break
        f = dot(u, self.R1)
        if abs(f) > 100.0 * least:
            s *= 0.1
            while not self._at(s * u):
                s *= 0.1
                if s == 0.0:
                    raise NotConverged("elements turn inside out wherever the conjugate gradients go")
            f = dot(u, self.R1)
        return s, f


def _ratio(f: float, f0: float) -> float:
    return 0.0 if abs(f) < ZERO else abs(f / f0) if f0 else inf


def _line(a: float, fa: float, b: float, fb: float) -> float:
    """Where a straight line through two points is zero; far beyond where it hardly falls."""
    if abs(fb - fa) < abs(fb * 0.01):
        return max(a, b) * 200.0 if b else a * 200.0 if a else FIRST
    return (a * fb - b * fa) / (fb - fa)


def _parabola(x: list[float], f: list[float]) -> float:
    """Where the parabola of least squares through points has its vertex."""
    powers = [sum(q**i for q in x) for i in range(5)]
    B = np.array([[powers[i + j] for j in range(3)] for i in range(3)])
    y = np.array([sum(q**i * v for q, v in zip(x, f)) for i in range(3)])
    try:
        c = np.linalg.solve(B, y)
    except np.linalg.LinAlgError:
        return float("nan")
    return float(-0.5 * c[1] / c[2])
