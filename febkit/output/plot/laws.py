"""The law of a part's solid and of the solids within it, at the integration points."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import numpy as np

from febkit.solver.points import Points
from febkit.solver.solids.base import Solid
from febkit.solver.solids.registry import field_name
from febkit.solver.solids.uncoupled import Uncoupled, distortional, distortional_energy

from .base import Floats, Part

_STEP = re.compile(r"([^.\[\]]+)(?:\[(\d+)\])?")
MIXTURES = ("SolidMixture", "UncoupledMixture")


def below(law: Any, path: str, pts: Points) -> tuple[Any, Points] | None:
    """What ``path`` ("solid[1].elastic") names in a law, and the points with the axes of all above it.

    None where there is no such thing.
    """
    for step in path.split(".") if path else ():
        found = _STEP.fullmatch(step.strip())
        child = getattr(law, field_name(found[1]), None) if found else None
        if isinstance(child, (tuple, list)):
            k = int(found[2] or 0)  # type: ignore[index]
            child = child[k] if k < len(child) else None
        if not isinstance(child, Solid):
            return None
        pts, law = law.inner(pts), child
    return law, pts


def solid(part: Part, path: str = "") -> tuple[Any, Points] | None:
    """The solid of a part, or one within it, and the points as it sees them."""
    return below(part.g.block.solid, path, part.points())


def component(part: Part, which: str) -> tuple[Any, Points] | None:
    """A solid of a mixture: "solid[1]", or "material[0].solid[1]" for the parts of the first material alone."""
    found = re.fullmatch(r"(?:material\[(\d+)\]\.)?(solid\[\d+\])", which)
    if found is None or type(part.g.block.solid).__name__ not in MIXTURES:
        return None
    if found[1] is not None:
        names = [m.name for m in part.view.model.materials]
        if int(found[1]) >= len(names) or names[int(found[1])] != part.material:
            return None
    return solid(part, found[2])


def stress(law: Solid, pts: Points) -> Floats:
    """Cauchy stress (n, 6)."""
    s = np.zeros((pts.n, 6))
    law.stress(pts, s, None)
    return s


def share(law: Solid, pts: Points) -> Floats:
    """Stress (n, 6) that a solid adds to an uncoupled mixture: the distortional one of an uncoupled solid."""
    s = np.zeros((pts.n, 6))
    distortional(law)(pts, s, None)
    return s


def tangent(law: Callable[[Points, Floats, Floats | None], None], pts: Points) -> Floats:
    """Spatial tangent (n, 6, 6) of a stress."""
    c = np.zeros((pts.n, 6, 6))
    law(pts, np.zeros((pts.n, 6)), c)
    return c


def energy(law: Solid, pts: Points) -> Floats | None:
    """Strain energy per reference volume (n,); None where the law gives none."""
    return _energy(law.energy, pts)


def distortional_part(law: Any, pts: Points) -> Floats | None:
    """Distortional strain energy of an uncoupled law (n,), None of another."""
    if not isinstance(law, Uncoupled):
        return None
    return _energy(lambda p: distortional_energy(law, p), pts)


def _energy(give: Callable[[Points], Any], pts: Points) -> Floats | None:
    try:
        return np.broadcast_to(give(pts), (pts.n,))
    except NotImplementedError:
        return None
