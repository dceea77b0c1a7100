"""Velocities, accelerations, momenta and kinetic energies; per reference volume where they are densities.

FEBio's elements of mixtures keep no velocities, and write zeros; here they are those of the solid.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .base import Floats, Give, Part, integral, mean, register, shared, total
from .energies import energy, reference_density


def within(part: Part, now: Floats, old: Floats, weight: str) -> Floats:
    """A nodal field at the points, at the time within the step at which forces are taken (rhoi)."""
    system = part.run.system
    alpha = getattr(system, weight) if system is not None else 1.0
    return part.interpolated(now if alpha == 1.0 else alpha * now + (1.0 - alpha) * old)


@shared
def velocity(part: Part) -> Floats:
    """(m, g, 3)."""
    return within(part, part.state.velocity, part.state.velocity_old, "alphaf")


@shared
def acceleration(part: Part) -> Floats:
    """(m, g, 3)."""
    return within(part, part.state.acceleration, part.state.acceleration_old, "alpham")


@shared
def position(part: Part) -> Floats:
    """Positions of the points (m, g, 3)."""
    s = part.state
    return within(part, s.x, s.X + s.u_old, "alphaf")


@shared
def end_velocity(part: Part) -> Floats:
    """Velocities at the end of the step (m, g, 3)."""
    return part.interpolated(part.state.velocity)


@shared
def end_position(part: Part) -> Floats:
    """Positions at the end of the step (m, g, 3)."""
    return part.interpolated(part.state.x)


Field = Callable[[Part], Floats]


def kinetic(v: Field) -> Field:
    """rho v . v / 2."""
    return lambda part: 0.5 * reference_density(part) * (v(part) ** 2).sum(axis=-1)


def linear(v: Field) -> Field:
    """rho v."""
    return lambda part: reference_density(part)[..., None] * v(part)


def angular(x: Field, v: Field) -> Field:
    """rho x x v."""
    return lambda part: reference_density(part)[..., None] * np.cross(x(part), v(part))


def whole(part: Part) -> Floats | None:
    """Strain energy and kinetic energy."""
    W = energy(part)
    return None if W is None else W + kinetic(velocity)(part)


def per_volume(points: Field) -> Give:
    """The mean over the reference volume of each element."""
    whole = integral(points)

    def give(part: Part) -> Floats | None:
        out = whole(part)
        return None if out is None else out / part.g.wJ0.sum(axis=1)

    return give


def centre(x: Field) -> Give:
    """The centre of mass of each element (m, 3)."""
    mass = integral(reference_density)
    first = integral(lambda part: reference_density(part)[..., None] * x(part))

    def give(part: Part) -> Floats | None:
        m = mass(part)
        return None if m is None else first(part) / m[:, None]  # type: ignore[operator]

    return give


register("velocity", mean(velocity))
register("acceleration", mean(acceleration))
register("kinetic energy density", per_volume(kinetic(end_velocity)))
register("element kinetic energy", integral(kinetic(velocity)))
register("current element kinetic energy", integral(kinetic(end_velocity)))
register("element center of mass", centre(position))
register("current element center of mass", centre(end_position))
register("element linear momentum", integral(linear(velocity)))
register("current element linear momentum", integral(linear(end_velocity)))
register("element angular momentum", integral(angular(position, velocity)))
register("current element angular momentum", integral(angular(end_position, end_velocity)))
register("total energy", total(whole))
register("total linear momentum", total(linear(velocity)))
register("total angular momentum", total(angular(position, velocity)))
