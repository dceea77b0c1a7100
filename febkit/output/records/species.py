"""Log items of mixtures: what their points have of each solute and solid-bound molecule.

Items with a number mean the species by its place in the material, 1 where none is said; but for
``sbm1_referential_apparent_density``, which means the model's first, as in FEBio.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial

from febkit.output.plot.base import Part

from . import Floats

# item, with its place and axis -> what the mixture keeps of it
ITEMS = {
    re.compile(r"c([1-8]?)"): "ca",
    re.compile(r"j([1-8]?)([xyz])"): "j",
    re.compile(r"sbm([1-8])"): "bound",
}
INTEGRALS = {re.compile(r"c([1-8])_integral"): "ca", re.compile(r"sbm([1-8])_integral"): "bound"}
_DENSITY = re.compile(r"sbm([1-8])_referential_apparent_density")


def datum(name: str) -> Callable[[Part], Floats | None] | None:
    """What gives the means over elements (m,) of an item; None where no species is meant."""
    for pattern, what in ITEMS.items():
        found = pattern.fullmatch(name)
        if found is not None:
            axis = "xyz".index(found[2]) if found.lastindex == 2 else None
            return partial(_mean, what, int(found[1] or 1) - 1, axis)
    found = _DENSITY.fullmatch(name)
    return None if found is None else partial(_density, int(found[1]) - 1)


def integral(name: str) -> Callable[[Part], float] | None:
    """What gives the integral of an item over the present volume of a solid part."""
    for pattern, what in INTEGRALS.items():
        found = pattern.fullmatch(name)
        if found is not None:
            return partial(_integral, what, int(found[1]) - 1)
    return None


def points(part: Part, what: str, k: int) -> Floats | None:
    """"ca", "j" or "bound" of species k of a mixture (m, g[, 3]); None where it has none so many."""
    at = getattr(part.g.physics, "at", None) if part.group is not None else None
    if at is None or k >= getattr(at, what).shape[1]:
        return None
    v = getattr(at, what)[:, k]
    return v.reshape(part.g.m, part.g.g, *v.shape[1:])  # type: ignore[no-any-return]


def _mean(what: str, k: int, axis: int | None, part: Part) -> Floats | None:
    v = points(part, what, k)
    return None if v is None else (v if axis is None else v[..., axis]).mean(axis=1)


def _density(sbm: int, part: Part) -> Floats | None:
    v = part.at_points("sbm referential apparent density") if part.group is not None else None
    return None if v is None or sbm >= v.shape[2] else v[..., sbm].mean(axis=1)


def _integral(what: str, k: int, part: Part) -> float:
    v = None if part.shell else points(part, what, k)
    return 0.0 if v is None else float((v * part.g.wJ0 * part.g.J).sum())
