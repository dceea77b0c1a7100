"""Densities and energies: per reference volume (m, g) where they are densities, else of an element or a part."""

from __future__ import annotations

import numpy as np

from . import laws
from .base import Floats, Part, full, integral, mean, of_solids, register, shared
from .kinematics import velocity_gradient


@shared
def reference_density(part: Part) -> Floats:
    """Mass of the solid per reference volume (m, g)."""
    return part.shaped(part.g.block.solid.density(part.g.points()))


def density(part: Part) -> Floats:
    """Mass of the solid per present volume."""
    return reference_density(part) / part.g.J


@shared
def energy(part: Part) -> Floats | None:
    """Strain energy; of three-field elements by the points' own J, as FEBio has it."""
    return _shaped(part, laws.energy(part.g.block.solid, part.points()))


def specific(part: Part) -> Floats | None:
    """Strain energy per mass."""
    W = energy(part)
    return None if W is None else W / reference_density(part)


def _shaped(part: Part, W: Floats | None) -> Floats | None:
    return None if W is None else part.shaped(W)


def distortional(part: Part) -> Floats | None:
    """Distortional strain energy of an uncoupled solid."""
    return _shaped(part, laws.distortional_part(part.g.block.solid, part.points()))


def of_component(part: Part, which: str = "") -> Floats | None:
    """Strain energy of a solid of a mixture."""
    found = laws.component(part, which)
    return None if found is None else _shaped(part, laws.energy(*found))


def distortional_of_component(part: Part, which: str = "") -> Floats | None:
    """Distortional strain energy of an uncoupled solid of a mixture."""
    found = laws.component(part, which)
    return None if found is None else _shaped(part, laws.distortional_part(*found))


def specific_of_component(part: Part, which: str = "") -> Floats | None:
    """Strain energy per mass of a solid of a mixture."""
    found = laws.component(part, which)
    W = None if found is None else laws.energy(*found)
    return None if found is None or W is None else part.shaped(W / found[0].density(found[1]))


def power(part: Part) -> Floats | None:
    """J sigma : L, the power of the stress."""
    s = part.at_points("stress")
    return None if s is None else part.g.J * np.einsum("egij,egij->eg", full(s), velocity_gradient(part))


@shared
def end_energy(part: Part) -> Floats | None:
    """Strain energy at the end of the step, where forces are taken within it (rhoi)."""
    system = part.run.system
    if system is None or system.alphaf == 1.0:
        return energy(part)
    g, pts = part.g, part.points()
    F, J = np.empty_like(g.F), np.empty_like(g.J)
    g.deform(part.state.u, F, J)
    pts.F, pts.J = F.reshape(-1, 3, 3), J.reshape(-1)
    return _shaped(part, laws.energy(g.block.solid, pts))


register("density", mean(density))
register("strain energy density", mean(of_solids(energy)))
register("specific strain energy", mean(specific))
register("deviatoric strain energy density", mean(of_solids(distortional)))
register("mixture strain energy density", mean(of_solids(of_component)), more=True)
register("mixture deviatoric strain energy density", mean(of_solids(distortional_of_component)), more=True)
register("mixture specific strain energy", mean(of_solids(specific_of_component)), more=True)
register("element strain energy", integral(energy))
register("current element strain energy", integral(end_energy))
register("element stress power", integral(power))
