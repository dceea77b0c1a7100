"""Ways to the parameters that fit best; all of them work on a :class:`.problem.Problem` and its bounds."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from .parameters import Parameters
from .problem import Problem, Stopped

Floats = NDArray[np.float64]
DAMPING, LARGEST = 1e-3, 1e6  # Marquardt's, at first and at last
LEAST, GOOD = 1e-3, 0.25  # what part of the promise a step keeps to be taken, and for its derivatives to be believed
SHRINK = 0.5
LATE = 0.1  # of the sum of squares: where less is promised, and not kept, it may be for the model's tolerances
SECANT = 0.75  # what part of it a step keeps for secants to do
SMALL = 5.0  # steps of differences: a step within it is as good as one
HOLDS = 4  # times that time steps are held anew
NEAR = 0.1  # standard errors: what time steps of its own would move a fit by, where they are not held anew
HEAVY = 1e6  # weight of linear constraints beside data


@dataclass(frozen=True, slots=True)
class Ended:
    """Where a method ended: z, whether by its own test, why; J: (m, n) derivatives there, where it has them."""

    z: Floats
    converged: bool
    reason: str
    J: Floats | None = None


@dataclass(frozen=True, slots=True)
class Tolerance:
    """A fit is done where the next step promises less than ``objective`` of the sum of squares, or moves no parameter
    by more than ``step`` of its size."""

    objective: float = 1e-8
    step: float = 1e-6


def steadied(problem: Problem, solve: Callable[[Floats | None], Ended], start: Floats | None = None) -> Ended:
    """What ``solve`` comes to from a start with the time steps held that runs take there, then from where it came to,
    until runs take these steps there by themselves, or others again that make no difference beside the data's noise."""
    p = problem.parameters
    z = np.clip(p.start if start is None else start, p.low, p.high)
    problem.hold_steps(z)
    ended = solve(z)
    for k in range(HOLDS):
        if not problem.hold_steps(ended.z, beside=ended.J is not None):
            break
        if k > 0 and ended.converged and ended.J is not None and _near(problem, ended.z, ended.J):
            break
        problem.forget(ended.z)
        ended = solve(ended.z)
    return ended


def _near(problem: Problem, z: Floats, J: Floats) -> bool:
    """Is the best that derivatives J promise within NEAR standard errors of z? Of s^2 = |r|^2 / (m - n) the sum of
    squares would fall by NEAR^2 at most."""
    r, spare = problem.residuals(z), J.shape[0] - J.shape[1]
    promised = r @ r - np.sum((r + J @ _step(problem.parameters, z, r, J, 0.0, math.inf, None)) ** 2)
    return bool(spare > 0 and promised * spare <= NEAR**2 * (r @ r))


def least_squares(problem: Problem, tolerance: Tolerance, most: int = 100, A: Floats | None = None,
                  b: Floats | None = None, start: Floats | None = None) -> Ended:  # fmt: skip
    """Levenberg and Marquardt's steps within the bounds, and on A values = b where that is given.

    Derivatives are those of :meth:`.problem.Problem.jacobian`: at every step where runs bring them, else at the start,
    at the end, and where a step does not do what they promise; between, Broyden's updates J += (dr - J dz) dz^T / dz.dz
    (Math. Comput. 19:577, 1965), of runs that are made anyway. These alone are made of what is at a bound, and they are
    derivatives where one parameter alone is not. A trial that fails is a step too long.
    """
    p = problem.parameters
    plane = None if A is None or b is None else (A * [q.size for q in p.every], b)
    z = np.clip(p.start if start is None else start, p.low, p.high)
    if plane is not None:
        z = _feasible(z, *plane, p.low, p.high)
    r = problem.residuals(z)
    if not np.isfinite(r).all():
        raise Stopped(f"the model does not solve at its starting values: {problem.why}")
    damping, reach, J, fresh, refused = DAMPING, math.inf, problem.jacobian(z), True, 0
    for _ in range(most):
        d = _step(p, z, r, J, damping, reach, plane)
        if settled(r, z, J, d, tolerance):
            if fresh:
                return Ended(z, True, "no step promises to do better", J)
            J, fresh, damping = problem.jacobian(z, J), True, min(damping, DAMPING)
            continue
        trial = np.clip(z + d, p.low, p.high)
        new = problem.residuals(trial)
        promised = r @ r - np.sum((r + J @ d) ** 2)
        gain = (r @ r - new @ new) / promised
        if not gain > LEAST:  # nan too, where the model fails
            refused += fresh
            late = refused > 1 or promised < LATE * (r @ r)
            if fresh and late and math.isfinite(gain) and problem.tighten(z):
                r, J = problem.residuals(z), problem.jacobian(z)
                continue
            reach = SHRINK * float(np.abs(d).max())
            if fresh or not math.isfinite(gain):
                damping *= 10.0
                if damping > LARGEST:
                    break
            else:
                J, fresh = problem.jacobian(z, J), True
            continue
        refused = 0
        damping *= 0.1 if gain > GOOD else 1.0
        reach *= 2.0 if gain > GOOD else 1.0
        J, fresh = J + np.outer(new - r - J @ d, d) / (d @ d), False
        z, r = trial, new
        alone = np.array_equal(d != 0.0, problem.free(z)) and np.count_nonzero(d) == 1
        if problem.brings_derivatives(z) or (gain < SECANT and not alone):
            J, fresh = problem.jacobian(z, J), True
        elif alone:  # the secant is a difference
            fresh = bool(np.abs(d).max() <= SMALL * problem.step * max(1.0, float(np.abs(z[d != 0.0]).max())))
    if damping > LARGEST:
        return Ended(z, False, "no trial does better, though derivatives promise it: loosen the tolerance of the fit, "
                     "or tighten those of the model", J if fresh else None)  # fmt: skip
    return Ended(z, False, f"not done after {most} steps", J if fresh else None)


def _step(p: Parameters, z: Floats, r: Floats, J: Floats, damping: float, reach: float,
          plane: tuple[Floats, Floats] | None) -> Floats:  # fmt: skip
    """The d within the bounds that makes |r + J d|^2 + damping |D d|^2 least, D the sizes of J's columns."""
    size = np.sqrt((J**2).sum(axis=0))
    D = np.where(size > 0, size, max(float(size.max()), 1e-300))
    left, right = [J / D, math.sqrt(damping) * np.eye(len(z))], [-r, np.zeros(len(z))]
    if plane is not None:  # met to rounding, by its weight
        A, b = plane
        left.append(HEAVY * A / D / np.linalg.norm(A / D))
        right.append(HEAVY * (b - A @ z) / np.linalg.norm(A / D))
    low, high = np.maximum(p.low - z, -reach) * D, np.minimum(p.high - z, reach) * D
    x = np.linalg.lstsq(np.vstack(left), np.concatenate(right), rcond=None)[0]
    if (x < low).any() or (x > high).any():
        from scipy.optimize import lsq_linear  # takes longer to import than a small model to run

        x = lsq_linear(np.vstack(left), np.concatenate(right), (low, high), method="bvls").x
    return np.asarray(x / D)


def settled(r: Floats, z: Floats, J: Floats, d: Floats, tolerance: Tolerance) -> bool:
    """Does a step promise too little, to first order, or move too little?"""
    promised = r @ r - np.sum((r + J @ d) ** 2)
    still = np.abs(d) <= tolerance.step * np.maximum(1.0, np.abs(z))
    return bool(promised <= tolerance.objective * (r @ r) or still.all())


def _best(problem: Problem) -> Floats:
    if problem.best is None:
        raise Stopped(f"the model does not solve at its starting values: {problem.why}")
    return problem.best.z


def _feasible(z: Floats, A: Floats, b: Floats, low: Floats, high: Floats) -> Floats:
    """The nearest place within the bounds where A z = b. Raises Stopped where there is none."""
    from scipy.optimize import lsq_linear

    both = np.vstack([np.eye(len(z)), HEAVY * A]), np.concatenate([z, HEAVY * b])
    out = np.asarray(lsq_linear(*both, (low, high), method="bvls").x)
    if np.abs(A @ out - b).max() > 1e-6 * (1 + np.abs(b).max()):
        raise Stopped("the linear constraints cannot be met within the bounds")
    return out


def powell(problem: Problem, tolerance: Tolerance, most: int = 0) -> Ended:
    """Powell's conjugate directions within the bounds: no derivatives."""
    from scipy import optimize

    p = problem.parameters
    out = optimize.minimize(
        problem.objective, np.clip(p.start, p.low, p.high), method="Powell", bounds=list(zip(p.low, p.high)),
        options={"ftol": tolerance.objective, "xtol": max(tolerance.step, 1e-4), **({"maxiter": most} if most else {})},
    )  # fmt: skip
    return Ended(_best(problem), bool(out.success), str(out.message))


def scan(problem: Problem, steps: Sequence[float]) -> Ended:
    """Every place of a grid: from low to high by ``steps`` (values), the first parameter fastest."""
    axes = []
    for q, step in zip(problem.parameters.every, steps):
        axes.append(q.low + step * np.arange(int(np.floor((q.high - q.low) / step * (1 + 1e-12))) + 1))
    for point in product(*reversed(axes)):
        values = point[::-1]
        problem.predictions(np.array([q.inner(v) for q, v in zip(problem.parameters.every, values)]))
    return Ended(_best(problem), True, "the whole grid was tried")


def everywhere(problem: Problem, seed: int = 0, generations: int = 20, crowd: int = 8) -> Floats:
    """The best place that differential evolution finds in the whole of the bounds: where a fit may start."""
    from scipy import optimize

    p = problem.parameters
    optimize.differential_evolution(
        problem.objective, list(zip(p.low, p.high)), popsize=crowd, maxiter=generations, seed=seed, polish=False,
        init="sobol", x0=np.clip(p.start, p.low, p.high), tol=0.05,
    )  # fmt: skip
    return _best(problem)
