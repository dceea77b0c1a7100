"""What the solver stands: a matrix of hard scenes, each solved or ended with a clear reason.

    python tests/benchmarks/stability.py            prints the Markdown table of docs/stability.md

A scene returns its run's result and a number that is known, here beside the bound it must keep; the same scenes are
tests (tests/solver/test_stability.py).
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # run as a script: helpers are beside the benchmarks

from febkit.solver.loads.base import patches
from febkit.solver.loads.pressure import Pressure
from febkit.solver.options import Options
from febkit.solver.permeabilities.const_iso import ConstIso
from febkit.solver.physics.biphasic import Biphasic
from febkit.solver.problem import TRANSIENT, AutoStep, Fixed, NewtonOptions, Prescribed, Problem, Step
from febkit.solver.result import Result
from febkit.solver.run import run
from febkit.solver.solids.neo_hookean import NeoHookean
from febkit.solver.values import Expression
from helpers import scenes
from helpers.scenes import UX, UY, UZ, P

E, V, K = 0.6, 0.2, 0.5


@dataclass
class Outcome:
    result: Result
    value: float
    what: str
    bound: float

    @property
    def good(self) -> bool:
        return self.result.converged and bool(self.value <= self.bound)


def aggregate(e: float, v: float) -> float:
    """Aggregate modulus."""
    return e * (1 - v) / ((1 + v) * (1 - 2 * v))


# ---- steps too small for the mesh --------------------------------------------------------------------
def small_step(ratio: float, tau: float) -> Outcome:
    """A column loaded at once; one step of ``ratio`` times h^2 / (6 c), c = H k (Vermeer and Verruijt, Int J Numer Anal
    Methods Geomech 5 (1981) 1): what the pressure exceeds the load by."""
    n, load = 10, 1e-6
    p = scenes.column(n, E, V, K)
    s = p.steps[0]
    s.loads = [Pressure(patches({"quad4": scenes.top_quads(n)}, p.X), pressure=load, linear=True)]
    s.dt, s.count = ratio * (1 / n) ** 2 / (6 * aggregate(E, V) * K), 1
    r = run(p, options=Options(threads=1, stabilise=tau))
    assert r.state.p is not None
    return Outcome(r, float(r.state.p.max() / load - 1.0), "pressure above the load", 0.02 if tau else 1.01)


# ---- cubes under compression ---------------------------------------------------------------------------
def cube(
    *, e: float = E, v: float = V, k: float = K, strain: float = 0.1, n: int = 4, distort: float = 0.0,
    size: float = 1.0, stiff: float = 1.0, grade: float = 1.0, seconds: float = 1.0, dt: float = 0.1, retries: int = 20,
) -> Problem:  # fmt: skip
    """A biphasic neo-Hookean cube compressed between lubricated plates in ``seconds``, drained at its sides.

    ``stiff``: modulus of the upper half over that of the lower; ``grade``: thickness of the lowest element layer over
    the highest's; the modulus is ``e``, lengths are in ``size``; min_residual (FEBio: 1e-20), a squared force, goes
    with both.
    """
    X, conn = scenes.grid((n, n, 2 * n))
    inside = ((X > 1e-9) & (X < 1 - 1e-9)).all(axis=1)
    X = scenes.distorted(X, distort / (2 * n), inside)
    if grade != 1.0:
        a = np.log(grade)
        X[:, 2] = np.expm1(a * X[:, 2]) / np.expm1(a)
    lower = X[conn].mean(axis=1)[:, 2] < np.median(X[conn].mean(axis=1)[:, 2])
    blocks = [
        scenes.block("hex8", conn[where], NeoHookean(E=m, v=v), Biphasic(ConstIso(k)))
        for where, m in ((lower, e), (~lower, e * stiff))
    ]
    ends = [np.flatnonzero(np.abs(X[:, 2] - z) < 1e-9) for z in (0.0, 1.0)]
    sides = np.flatnonzero((np.abs(X[:, :2] - 0.5) > 0.5 - 1e-9).any(axis=1))
    corner = [np.flatnonzero(np.abs(X[:, i]) < 1e-9) for i in (0, 1)]
    conditions: list[Any] = [
        Fixed(UZ, ends[0]), Fixed(UX, corner[0]), Fixed(UY, corner[1]), Fixed(P, sides),
        Prescribed(UZ, ends[1], scenes.ramp(-strain * size, seconds)),
    ]  # fmt: skip
    auto = AutoStep(max_retries=retries, dtmax=dt, dtmin=0.0, must_points=(seconds, 2 * seconds), aggressive=True)
    step = Step(analysis=TRANSIENT, dt=dt, duration=2 * seconds, auto=auto, conditions=conditions,
                newton=NewtonOptions(ptol=1e-3, min_residual=1e-20 * (e / E * size**2) ** 2))  # fmt: skip
    return Problem(X * size, blocks, [step])


def _volume(p: Problem, r: Result) -> float:
    """Smallest height of an element over its first one: above 0 where nothing is inside out."""
    z = np.concatenate([(p.X + r.state.u)[b.conn][:, :, 2] for b in p.blocks])
    z0 = np.concatenate([p.X[b.conn][:, :, 2] for b in p.blocks])
    return float(((z[:, 4:] - z[:, :4]) / (z0[:, 4:] - z0[:, :4])).min())


def compressed(what: str = "height of the flattest element lost", **kw: Any) -> Outcome:
    p = cube(**kw)
    r = run(p, options=Options(threads=1))
    return Outcome(r, 1.0 - _volume(p, r), what, 0.999)


def jump(method: str) -> Outcome:
    """30 % in 0.1 s by steps of 4 ms, then steps of 0.1 s at once."""
    p = cube(strain=0.3, seconds=0.1, dt=0.004)
    s = p.steps[0]
    assert s.auto is not None
    s.auto.dtmax_curve, s.auto.force = (lambda t: 0.004 if t < 0.0999 else 0.1), True
    s.auto.must_points, s.duration = (0.1,), 1.1
    s.newton = NewtonOptions(method=method, updates=0 if method == "full Newton" else 10, ptol=1e-3)
    r = run(p, options=Options(threads=1))
    return Outcome(r, 1.0 - _volume(p, r), "height of the flattest element lost", 0.999)


def thin(dt: float) -> Problem:
    """A confined block pressed by 10 % in 0.1 s through a layer drained on top whose elements are 1/400 thick, fixed
    steps: FEBio's loop turns them inside out, as the face moves by several of them in a step."""
    X, conn = scenes.grid((2, 2, 16))
    X[:, 2] = 1 - np.expm1(5.0 * (1 - X[:, 2])) / np.expm1(5.0)
    X[:, :2] *= 0.2
    top = np.flatnonzero(X[:, 2] > 1 - 1e-9)
    held: list[Any] = [Fixed(c, np.flatnonzero(np.abs(X[:, c] - 0.1) > 0.1 - 1e-9)) for c in (UX, UY)]
    conditions = [
        *held, Fixed(UZ, np.flatnonzero(X[:, 2] < 1e-9)), Fixed(P, top), Prescribed(UZ, top, scenes.ramp(-0.1, 0.1))
    ]
    step = Step(analysis=TRANSIENT, dt=dt, count=round(0.2 / dt), conditions=conditions)
    return Problem(X, [scenes.block("hex8", conn, NeoHookean(E=1.0, v=0.125), Biphasic(ConstIso(0.002)))], [step])


def pushed(dt: float) -> Outcome:
    a, b = (run(thin(q), options=Options(threads=1)) for q in (dt, 5e-4))
    d = np.linalg.norm(a.state.u - b.state.u) / np.linalg.norm(b.state.u)
    return Outcome(a, float(d), "distance from steps of 0.5 ms", 2.0 * dt)


def drained(v: float) -> Outcome:
    """Slow compression by 1e-4: the reaction against E strain area (unconfined)."""
    p = cube(v=v, k=1e3, strain=1e-4, n=3)
    r = run(p, options=Options(threads=1))
    top = np.flatnonzero(np.abs(p.X[:, 2] - 1.0) < 1e-9)
    force = -r.state.reaction[top, 2].sum()
    return Outcome(r, float(abs(force / (E * 1e-4) - 1.0)), "error of the reaction", 2e-3)


def undrained(k: float) -> Outcome:
    """Compression by 1e-4 in no time for the fluid: the reaction of an incompressible solid, 3 G strain area."""
    p = cube(k=k, strain=1e-4, n=4)
    p.steps[0].conditions = [c for c in p.steps[0].conditions if getattr(c, "column", 0) != P]
    r = run(p, options=Options(threads=1))
    top = np.flatnonzero(np.abs(p.X[:, 2] - 1.0) < 1e-9)
    force = -r.state.reaction[top, 2].sum()
    return Outcome(r, float(abs(force / (1.5 * E / (1 + V) * 1e-4) - 1.0)), "error of the reaction", 2e-3)


def units(length: float, stress: float) -> Outcome:
    """The same cube in other units: difference of the displacements, relative (the tolerance of Newton is 1e-3: the
    line search, whose 1e-17 is FEBio's and in units, may take another path)."""
    k = length**2 / stress
    a, b = (run(cube(size=s, e=E * m, k=K * q, n=3), options=Options(threads=1)) for s, m, q in
            ((1.0, 1.0, 1.0), (length, stress, k)))  # fmt: skip
    d = np.linalg.norm(b.state.u / length - a.state.u) / np.linalg.norm(a.state.u)
    return Outcome(b, float(d), "difference to units of 1", 1e-3)


# ---- rotation --------------------------------------------------------------------------------------------
def turned(degrees: float, steps: int) -> Outcome:
    """The skin of a cube turned about z: it must carry no stress, nor press the fluid."""
    X, conn = scenes.box("hex8", (3, 3, 3), 0.2)
    skin = scenes.skin(X)

    def x(x0: Any, y0: Any, z0: Any, t: float) -> Any:
        a = np.radians(degrees * t)
        return x0 * np.cos(a) - y0 * np.sin(a) - x0

    def y(x0: Any, y0: Any, z0: Any, t: float) -> Any:
        a = np.radians(degrees * t)
        return x0 * np.sin(a) + y0 * np.cos(a) - y0

    conditions: list[Any] = [
        Prescribed(UX, skin, Expression(x)), Prescribed(UY, skin, Expression(y)), Fixed(UZ, skin), Fixed(P, skin)
    ]  # fmt: skip
    newton = NewtonOptions(dtol=1e-8, ptol=1e-8, etol=0.0)
    step = Step(analysis=TRANSIENT, dt=1 / steps, count=steps, newton=newton, conditions=conditions)
    p = Problem(X, [scenes.block("hex8", conn, NeoHookean(E=E, v=V), Biphasic(ConstIso(K)))], [step])
    r = run(p, options=Options(threads=1))
    a = np.radians(degrees)
    R = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
    return Outcome(r, float(np.abs(X + r.state.u - X @ R.T).max()), "distance from the turned cube", 1e-6)


SCENES: dict[str, Callable[[], Outcome]] = {}
for _ratio in (1.0, 0.1, 0.01, 1e-4):
    SCENES[f"step {_ratio:g} of Vermeer and Verruijt's"] = lambda r=_ratio: small_step(r, 0.0)
    SCENES[f"step {_ratio:g} of Vermeer and Verruijt's, stabilised"] = lambda r=_ratio: small_step(r, 1.0)
for _k in (1e-12, 1e-6, 1e-3, 1.0):
    SCENES[f"permeability {_k:g}, 10 % in 1 s"] = lambda k=_k: compressed(k=k)
SCENES["permeability 1e-12, sealed: undrained"] = lambda: undrained(1e-12)
for _v in (0.0, 0.45, 0.49, 0.499, 0.4999):
    SCENES[f"Poisson's ratio {_v:g}, drained"] = lambda v=_v: drained(v)
for _c in (1e3, 1e6):
    SCENES[f"stiffness contrast {_c:g}"] = lambda c=_c: compressed(stiff=c)
for _s in (0.3, 0.6, 0.8):
    SCENES[f"compression by {_s:.0%}"] = lambda s=_s: compressed(strain=s)
SCENES["compression by 60 % in one step"] = lambda: compressed(strain=0.6, dt=1.0)
SCENES["compression by 30 % in 1 ms"] = lambda: compressed(strain=0.3, seconds=1e-3, dt=1e-4)
SCENES["distorted mesh (30 % of an edge), 30 %"] = lambda: compressed(strain=0.3, distort=0.3)
for _g in (1e2, 1e4):
    SCENES[f"mesh graded 1 : {_g:g}, 30 %"] = lambda g=_g: compressed(strain=0.3, grade=g)
for _method in ("BFGS", "full Newton"):
    SCENES[f"steps of 4 ms, then 0.1 s after the ramp, {_method}"] = lambda m=_method: jump(m)
for _dt in (0.02, 0.005):
    SCENES[f"elements thinner than a step, {_dt * 1e3:g} ms"] = lambda dt=_dt: pushed(dt)
for _steps in (9, 1):
    SCENES[f"turned by 90 degrees in {_steps} step{'s' * (_steps > 1)}"] = lambda n=_steps: turned(90.0, n)
for _l, _m in ((1e-6, 1.0), (1e6, 1.0), (1.0, 1e-9), (1.0, 1e9), (1e-6, 1e6)):
    SCENES[f"lengths in {_l:g}, stresses in {_m:g}"] = lambda a=_l, b=_m: units(a, b)


def main() -> None:
    print("| scene | ended | steps | retries | iterations | measured | is | bound |")
    print("|---|---|---|---|---|---|---|---|")
    for name, scene in SCENES.items():
        o = scene()
        t = o.result.totals
        ended = "solved" if o.result.converged else o.result.reason
        numbers = f"{t.steps} | {t.retries} | {t.iterations}"
        bad = "" if o.good else " **no**"
        print(f"| {name} | {ended} | {numbers} | {o.what} | {o.value:.2g} | {o.bound:g} |{bad}", flush=True)


if __name__ == "__main__":
    main()
