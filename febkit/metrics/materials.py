"""Stress and permeability of the model's own materials, where the plotfile does not hold them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from febkit.model import InputError, UnsupportedError

from . import tensors

if TYPE_CHECKING:
    from febkit.model import Component, Model

Floats = NDArray[np.float64]
# Cauchy stress (6, g, e) of the solid at F (3, 3, g, e), J (g, e)
Stress = Callable[[Floats, Floats], Floats]
# spatial permeability K (6, g, e), or (1,) where isotropic and uniform
Permeability = Callable[[Floats, Floats], Floats]


def of_parts(model: Model) -> dict[str, Component]:
    """Material of each part by the part's name."""
    named = {m.name: m for m in model.materials if m.name}
    named |= {str(m.id): m for m in model.materials if m.id is not None and str(m.id) not in named}
    return {d.block: named[d.material] for d in model.domains if d.material in named}


def solid(material: Component) -> Component:
    """The solid of a biphasic material, or the material itself."""
    return material.child("solid") or material


def stress(material: Component) -> Stress:
    """Solid Cauchy stress; closed form where it is one line, the solver's own material otherwise."""
    spec = solid(material)
    make = _STRESS.get((spec.type or "").lower())
    numbers = _plain(spec, make[1]) if make else None
    if make is None or numbers is None:
        return _solver_stress(spec)
    return make[0](*numbers)


def permeability(material: Component) -> Permeability:
    """Spatial permeability of a biphasic material."""
    spec = material.child("permeability")
    if spec is None:
        raise InputError(
            f"material {material.name!r} has no permeability: it carries no fluid", material.where
        )
    numbers = _plain(spec, ("perm",)) if (spec.type or "").lower() == "perm-const-iso" else None
    if numbers is None:
        return _solver_permeability(spec)
    k = np.array([numbers[0]])
    return lambda F, J: k


def neo_hookean(E: float, v: float) -> Stress:
    """(mu (b - 1) + lambda ln J 1)/J, mu = E/2(1+v), lambda = E v/(1+v)(1-2v).

    Source: FEBio user manual, "Neo-Hookean" (compressible); E in units of stress.
    """
    mu, lam = E / (2 * (1 + v)), E * v / ((1 + v) * (1 - 2 * v))

    def law(F: Floats, J: Floats) -> Floats:
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


def _solver_stress(spec: Component) -> Stress:
    raise UnsupportedError(f'no stress law for a material of type "{spec.type}" here', spec.where)


def _solver_permeability(spec: Component) -> Permeability:
    raise UnsupportedError(f'no permeability law of type "{spec.type}" here', spec.where)
