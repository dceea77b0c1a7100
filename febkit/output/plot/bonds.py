"""Bonds of reactive solids: what is broken, intact, yielded; generations of reactive viscoelastic solids.

Of the solid of a part, or of one of a mixture ("damage['solid[1]']"). FEBio theory manual, "Reactive constitutive
models".
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from febkit.solver.matrices import det
from febkit.solver.points import Points
from febkit.solver.solids.damage_fibers import DamagedFiber
from febkit.solver.solids.reactive_viscoelastic import UncoupledReactiveViscoelastic
from febkit.solver.solids.uncoupled import Uncoupled, distortional, distortional_energy

from . import laws
from .base import Floats, Give, Part, mean, of_solids, register

MEMORY = {"ReactivePlasticity": (0, 12), "ReactivePlasticDamage": (2, 16)}  # history: head, and columns per family
MEASURE, FRACTION = 9, 10  # columns of the yield measure and of the yielded fraction
MIXED = (*laws.MIXTURES, "Multigeneration", "Generation")
DAMAGED = ("ElasticDamage", "UncoupledElasticDamage", "ReactivePlasticDamage", "ReactiveViscoelasticDamage",
           "ViscoelasticDamage", "UncoupledViscoelasticDamage", "ReactiveViscoelasticFatigue")  # fmt: skip
FATIGUE = ("ReactiveFatigue", "UncoupledReactiveFatigue")
VISCOUS = ("ReactiveViscoelastic", "UncoupledReactiveViscoelastic")


def families(law: Any, pts: Points, old: bool = False) -> Floats | None:
    """Memory of the bond families of a plastic solid (n, family, columns); None of another."""
    found = MEMORY.get(type(law).__name__)
    memory = pts.old if old else pts.new
    if found is None or memory is None:
        return None
    head, each = found
    return memory[:, law.offset + head : law.offset + law.history].reshape(pts.n, -1, each)


def broken(law: Any, pts: Points) -> Floats | None:
    """Fraction of bonds broken (n,); summed over the solids of mixtures and generations; None of what has no bonds."""
    name = type(law).__name__
    if name in MIXED:
        each = [b for b in (broken(q, pts) for q in law.children) if b is not None]
        return np.sum(each, axis=0) if each else None
    if name in ("ViscoelasticDamage", "UncoupledViscoelasticDamage"):
        return broken(law.elastic, pts)
    if name in DAMAGED or name in FATIGUE or name in MEMORY:
        return np.broadcast_to(law.broken(pts), (pts.n,))
    return None


def yielded(law: Any, pts: Points) -> Floats | None:
    """Fraction of bonds that have yielded (n,)."""
    own = families(law, pts)
    return None if own is None else own[:, :, FRACTION].sum(axis=1)


def _strong(law: Any) -> Any:
    """The solid whose bonds last: the elastic one of a reactive viscoelastic solid."""
    if type(law).__name__ == "ReactiveViscoelasticFatigue":
        law = law.viscoelastic
    return law.elastic if type(law).__name__ in VISCOUS else law


def fatigued(law: Any, pts: Points) -> Floats | None:
    """Fraction of bonds that have fatigued (n,)."""
    law = _strong(law)
    return law.fatigued(pts) if type(law).__name__ in FATIGUE else None


def intact(law: Any, pts: Points) -> Floats | None:
    """Fraction of bonds that are as they were (n,)."""
    law = _strong(law)
    D = broken(law, pts)
    if D is None or type(law).__name__ in MIXED:
        return None
    lost = (v for v in (yielded(law, pts), fatigued(law, pts)) if v is not None)
    return np.asarray(1.0 - D - sum(lost))


def octahedral(law: Any, pts: Points) -> Floats | None:
    """Octahedral plastic strain of the first family: 2^1/2 / 3 ((l1 - l2)^2 + (l2 - l3)^2 + (l3 - l1)^2)^1/2 of the
    plastic stretches (n,)."""
    own = families(law, pts)
    if own is None:
        return None
    Ui = own[:, 0, :9].reshape(-1, 3, 3)
    l = 1.0 / np.sqrt(np.linalg.eigvalsh(np.swapaxes(Ui, 1, 2) @ Ui))
    return np.asarray(np.sqrt(2.0) / 3.0 * np.sqrt(((l - np.roll(l, 1, axis=1)) ** 2).sum(axis=1)))


def yield_stress(law: Any, pts: Points) -> Floats | None:
    """Yield measure of the first family (n,)."""
    own = families(law, pts) if type(law).__name__ == "ReactivePlasticity" else None
    return None if own is None else own[:, 0, MEASURE]


def heat(law: Any, pts: Points) -> Floats | None:
    """Heat supply by yielding over the last step: what the strain energy of yielded bonds fell by, over dt (n,)."""
    now, old = families(law, pts), families(law, pts, old=True)
    if now is None or old is None or not pts.dt > 0:
        return None if now is None else np.zeros(pts.n)
    out = np.zeros(pts.n)
    for k in range(now.shape[1]):
        w = now[:, k, FRACTION]
        for sign, memory in ((1.0, old), (-1.0, now)):
            F = np.ascontiguousarray(pts.F @ memory[:, k, :9].reshape(-1, 3, 3))
            W = law.elastic.energy(pts.under(F, det(F)))
            out += sign * np.where(w > 0, w * W, 0.0)
    return out / pts.dt


Fraction = Callable[[Any, Points], "Floats | None"]


def of_bonds(value: Fraction, otherwise: float | None = None) -> Give:
    """A fraction of the solid of a part, or of one of a mixture; ``otherwise`` where a solid has no bonds."""

    def points(part: Part, which: str = "") -> Floats | None:
        found = laws.component(part, which) if which else laws.solid(part)
        if found is None:
            return None
        law, pts = found
        pts = law.inner(pts)
        v = value(law, pts)
        if v is None:
            return None if otherwise is None else np.full((part.g.m, part.g.g), otherwise)
        return part.shaped(v)

    return mean(points)


def continuous(name: str) -> Give:
    """A value of fibers with continuous damage, of the solid of a part or of what stands in brackets."""

    def points(part: Part, which: str = "") -> Floats | None:
        found = laws.solid(part, which)
        v = found[0].written(found[1], name) if found and isinstance(found[0], DamagedFiber) else None
        return None if v is None else part.shaped(v)

    return mean(points)


# ---- reactive viscoelasticity -----------------------------------------------------------------------------
def viscous(value: Callable[[Any, Points, tuple[Floats, Floats, Floats]], Floats]) -> Fraction:
    """A value (n,) of the generations (their records, their number, the rate) of a reactive viscoelastic solid."""

    def give(law: Any, pts: Points) -> Floats | None:
        if type(law).__name__ not in VISCOUS:
            return None
        stress = distortional(law.elastic)  # the whole of a solid that is not uncoupled
        return value(law, pts, law._advance(pts, stress))

    return give


def _recruited(law: Any, pts: Points, generations: tuple[Floats, Floats, Floats]) -> Floats:
    """Fraction recruited by the last generation, 1 before the first."""
    gen, count, _ = generations
    last = gen[np.arange(pts.n), np.maximum(count - 1, 0).astype(int), 3]
    return np.where(count > 0, last, 1.0)


def _reforming(law: Any, pts: Points, generations: tuple[Floats, Floats, Floats]) -> Floats:
    """Mass fraction of the bonds that reform."""
    return law._reforming(pts, *generations)  # type: ignore[no-any-return]


# ---- energies -----------------------------------------------------------------------------------------
def strong(law: Any, pts: Points) -> Floats:
    """Strain energy of strong bonds (n,): all of what has no weak ones."""
    name = type(law).__name__
    if name in laws.MIXTURES:
        own = sum((strong(q, law.inner(pts)) for q in law.children), start=np.zeros(pts.n))
        return own + (law.volumetric(pts.J, pts) if isinstance(law, Uncoupled) else 0.0)
    if name == "ReactiveViscoelasticDamage":
        return (1.0 - np.asarray(law.broken(pts))) * strong(law.viscoelastic, law.inner(pts))
    if name == "ReactiveViscoelastic":
        return law.elastic.energy(law.inner(pts))  # type: ignore[no-any-return]
    if isinstance(law, UncoupledReactiveViscoelastic):
        return distortional_energy(law.elastic, law.inner(pts)) + law.volumetric(pts.J, pts)  # type: ignore[arg-type]
    return np.broadcast_to(law.energy(pts), (pts.n,))


def weak(law: Any, pts: Points) -> Floats:
    """Strain energy of weak bonds (n,)."""
    name = type(law).__name__
    if name in laws.MIXTURES:
        return sum((weak(q, law.inner(pts)) for q in law.children), start=np.zeros(pts.n))
    if name == "ReactiveViscoelasticDamage":
        return (1.0 - np.asarray(law.broken(pts))) * weak(law.viscoelastic, law.inner(pts))
    if name not in VISCOUS or pts.t == 0:
        return np.zeros(pts.n)
    whole = law.dev_energy(pts) if isinstance(law, Uncoupled) else law.energy(pts)
    own = distortional_energy(law.elastic, law.inner(pts))
    left = 1.0 - np.asarray(law.elastic.broken(law.inner(pts)))
    return np.divide(whole - own, left, out=np.zeros(pts.n), where=np.broadcast_to(left > 0, (pts.n,)))


def of_energy(value: Callable[[Any, Points], Floats], distortion: bool = False) -> Give:
    """An energy of the solid of a part; ``distortion``: without the volumetric part, of uncoupled solids alone."""

    def points(part: Part) -> Floats | None:
        law, pts = part.g.block.solid, part.points()
        if distortion and not isinstance(law, Uncoupled):
            return None
        try:
            W = value(law, pts)
        except NotImplementedError:
            return None
        if distortion and value is strong and isinstance(law, Uncoupled):
            W = W - law.volumetric(pts.J, pts)
        return part.shaped(W)

    return mean(of_solids(points))


register("damage", of_bonds(broken, 0.0), more=True)
register("intact bond fraction", of_bonds(intact, 0.0), more=True)
register("yielded bond fraction", of_bonds(yielded, 0.0), more=True)
register("fatigue bond fraction", of_bonds(fatigued, 0.0), more=True)
register("octahedral plastic strain", of_bonds(octahedral, 0.0), more=True)
register("plasticity heat supply density", of_bonds(heat, 0.0), more=True)
register("plastic yield stress", of_bonds(yield_stress))
register("RVE generations", of_bonds(viscous(lambda law, pts, g: g[1])), more=True)
register("RVE reforming bonds", of_bonds(viscous(_reforming)), more=True)
register("RVE recruitment", of_bonds(viscous(_recruited)), more=True)
register("RVE strain", of_bonds(viscous(lambda law, pts, g: law._scalar(pts.F))), more=True)
register("strong bond SED", of_energy(strong))
register("weak bond SED", of_energy(weak))
register("deviatoric strong bond SED", of_energy(strong, distortion=True))
register("deviatoric weak bond SED", of_energy(weak, distortion=True))
register("continuous damage", continuous(""), more=True)
register("continuous damage D1", continuous("D1"), more=True)
register("continuous damage Ds", continuous("Ds"), more=True)
register("continuous damage D2", continuous("D2"), more=True)
register("continuous damage D3", continuous("D3"), more=True)
register("continuous damage P", continuous("P"), more=True)
register("continuous damage Psi0", continuous("Psi0"), more=True)
register("continuous damage beta", continuous("beta"), more=True)
register("continuous damage gamma", continuous("gamma"), more=True)
register("continuous damage D2beta", continuous("D2beta"), more=True)
