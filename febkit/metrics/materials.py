"""Stress and permeability of the study's materials in closed form: no kernel is compiled for them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from . import tensors

if TYPE_CHECKING:
    from febkit.model import Component, Model

Floats = NDArray[np.float64]
# Cauchy stress (6, g, e) of the solid at F (3, 3, g, e), J (g, e), time
Stress = Callable[[Floats, Floats, float], Floats]
# spatial permeability K (6, g, e), or (1,) where isotropic and uniform
Permeability = Callable[[Floats, Floats, float], Floats]
# solvent supply (g, e), volume of fluid made per current volume and time, at F, J, pressure p (g, e), time
Supply = Callable[[Floats, Floats, Floats, float], Floats]


def of_parts(model: Model) -> dict[str, Component]:
    """Material of each part by the part's name."""
    named = {m.name: m for m in model.materials if m.name}
    named |= {str(m.id): m for m in model.materials if m.id is not None and str(m.id) not in named}
    return {d.block: named[d.material] for d in model.domains if d.material in named}


def solid(material: Component) -> Component:
    """The solid of a biphasic material, or the material itself."""
    return material.child("solid") or material


def closed_form(material: Component) -> bool:
    """True where the laws of all parts of this material are numbers known here."""
    if material.child("solute") is not None:
        return False
    known = material.child("permeability") is None or permeability(material) is not None
    return known and stress(material) is not None and material.child("solvent_supply") is None


def stress(material: Component) -> Stress | None:
    """Solid Cauchy stress in closed form; None where only the solver's own material has it."""
    spec = solid(material)
    make = _STRESS.get((spec.type or "").lower())
    numbers = _plain(spec, make[1]) if make else None
    return None if make is None or numbers is None else make[0](*numbers)


def permeability(material: Component) -> Permeability | None:
    """Constant isotropic permeability; None for others."""
    spec = material.child("permeability")
    numbers = _plain(spec, ("perm",)) if spec is not None and spec.type == "perm-const-iso" else None
    if numbers is None:
        return None
    k = np.array([numbers[0]])
    return lambda F, J, t: k


def neo_hookean(E: float, v: float) -> Stress:
    """(mu (b - 1) + lambda ln J 1)/J, mu = E/2(1+v), lambda = E v/(1+v)(1-2v).

    Source: FEBio user manual, "Neo-Hookean" (compressible); E in units of stress.
    """
    mu, lam = E / (2 * (1 + v)), E * v / ((1 + v) * (1 - 2 * v))

    def law(F: Floats, J: Floats, t: float) -> Floats:
        s = tensors.left_cauchy_green(F)
        s *= mu / J
        s[:3] += (lam * np.log(J) - mu) / J
        return s

    return law


def _plain(spec: Component, names: tuple[str, ...]) -> tuple[float, ...] | None:
    """Numbers of these parameters, None where one of them varies in time or space."""
    out = []
    for name in names:
        c = spec.need(name)
        if c.attrs or c.type:
            return None
        try:
            out.append(float(c.text))
        except ValueError:
            return None
    return tuple(out)


_STRESS: Mapping[str, tuple[Callable[..., Stress], tuple[str, ...]]] = {
    "neo-hookean": (neo_hookean, ("E", "v")),
}
