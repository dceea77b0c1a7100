"""Springs of <Discrete>: one domain for each set of them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from febkit.solver.loads.springs import Springs

from .base import Floats, Part, register


def springs(part: Part) -> Springs | None:
    """What acts in a domain of springs: the sets of <Discrete> come in their order."""
    if part.kind != "discrete":
        return None
    sets = [p for p in part.view.parts if p.kind == "discrete"]
    acting = [a for a in part.run.problem.common.loads if isinstance(a, Springs)]
    return acting[sets.index(part)]


def of_springs(value: Callable[[Springs, Part], Floats]) -> Callable[[Part], Floats | None]:
    """A value of each spring (m, ...)."""

    def give(part: Part) -> Floats | None:
        own = springs(part)
        return None if own is None else value(own, part)

    return give


def line(s: Springs, part: Part) -> Floats:
    """From the first node to the second (m, 3)."""
    x = part.state.x[s.nodes]
    return x[:, 1] - x[:, 0]


def length(s: Springs, part: Part) -> Floats:
    return np.linalg.norm(line(s, part), axis=1)


def elongation(s: Springs, part: Part) -> Floats:
    """L - L0, L0 the distance of the nodes in the reference."""
    return length(s, part) - s.rest


def stretch(s: Springs, part: Part) -> Floats:
    """L / L0."""
    return length(s, part) / s.rest


def direction(s: Springs, part: Part) -> Floats:
    L = length(s, part)
    return line(s, part) / np.where(L > 0, L, 1.0)[:, None]


def signed(s: Springs, part: Part) -> Floats:
    """The force with which a spring pulls (m,), negative where it pushes."""
    return (force(s, part) * direction(s, part)).sum(axis=1)


def force(s: Springs, part: Part) -> Floats:
    """On the first node (m, 3)."""
    return s.forces(part.state)


def energy(s: Springs, part: Part) -> Floats:
    """Strain energy; FEBio has none of nonlinear springs and muscles, and writes zeros."""
    return s.energies(part.state)


register("discrete element length", of_springs(length))
register("discrete element elongation", of_springs(elongation))
register("discrete element percent elongation", of_springs(lambda s, part: elongation(s, part) / s.rest))
register("discrete element stretch", of_springs(stretch))
register("discrete element direction", of_springs(direction))
register("discrete element force", of_springs(force))
register("discrete element signed force", of_springs(signed))
register("discrete element strain energy", of_springs(energy))
