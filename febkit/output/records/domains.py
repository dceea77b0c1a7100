"""<domain_data>: one value of a domain, numbered from 1 as in the plotfile; functions of element data among them.

avg('sx') is the mean over elements, integrate('sx') the sum of values times reference volumes, pct('sx',0.9) the value
that nine in ten elements do not exceed (FEBio 4.11 reads no second argument, and so never has a pct).
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from febkit.model import InputError
from febkit.output import plot
from febkit.output.plot.base import Part, full

from . import Column, Floats, Ints, places, species
from .elements import datum

if TYPE_CHECKING:
    from febkit.model import LogEntry
    from febkit.output.plot import View

WHOLE = ("volume", "total energy", "normalized internal energy")
CALL = re.compile(r"(avg|integrate|pct)\s*\(\s*'([^']+)'\s*(?:,\s*'?([\d.eE+-]+)'?\s*)?\)")


def rows(view: View, entry: LogEntry) -> tuple[Ints, Ints]:
    names = [p.name for p in view.parts]
    if entry.set and entry.set not in names:
        raise InputError(f'there is no domain "{entry.set}"', entry.where)
    own = np.array([names.index(entry.set) + 1], np.int64) if entry.set else None
    return places(entry, np.arange(1, len(names) + 1), own)


def column(view: View, name: str, entry: LogEntry) -> Column | None:
    of_part = call(name) or dict(zip(WHOLE, (volume, energy))).get(name) or species.integral(name)
    if name == WHOLE[-1]:
        of_part = Work(view)
    return None if of_part is None else partial(_each, view, of_part)


def _each(view: View, of_part: Callable[[Part], float]) -> Floats:
    return np.array([of_part(p) for p in view.parts])


def call(name: str) -> Callable[[Part], float] | None:
    """A function of element data."""
    found = CALL.fullmatch(name)
    of_elements = datum(found[2]) if found is not None else None
    if found is None or of_elements is None or (found[1] == "pct") != (found[3] is not None):
        return None
    return partial(FUNCTIONS[found[1]], of_elements, float(found[3] or 0.0))


def _avg(of_elements: Callable[[Part], Floats | None], _: float, part: Part) -> float:
    v = of_elements(part)
    return 0.0 if v is None else float(np.mean(v))


def _integrate(of_elements: Callable[[Part], Floats | None], _: float, part: Part) -> float:
    v = of_elements(part)
    return 0.0 if v is None or part.group is None else float(v @ part.group.wJ0.sum(axis=1))


def _pct(of_elements: Callable[[Part], Floats | None], at: float, part: Part) -> float:
    v = of_elements(part)
    return 0.0 if v is None else float(np.sort(v)[int(at * (len(v) - 1.0))])


FUNCTIONS: dict[str, Callable[..., float]] = {"avg": _avg, "integrate": _integrate, "pct": _pct}


def volume(part: Part) -> float:
    """Present volume."""
    return 0.0 if part.group is None else float((part.g.wJ0 * part.g.J).sum())


def energy(part: Part) -> float:
    """Strain and kinetic energy of a solid part."""
    give = plot.find("total energy")
    v = None if give is None else give(part)
    return 0.0 if v is None else float(v)


class Work:
    """Work of the stresses per volume and per the constant P, summed over the steps (time times mean stress : D)."""

    def __init__(self, view: View) -> None:
        self.sums: dict[str, float] = {}
        self.unit = float(view.model.constants.get("P", 0.0)) or 1.0

    def __call__(self, part: Part) -> float:
        from febkit.output.plot.kinematics import rate

        s = part.at_points("stress") if part.group is not None and not part.shell else None
        if s is None:
            return 0.0
        w = part.g.element.weights
        stress = full(np.einsum("g,egk->ek", w, s) / w.sum())
        D = full(rate(part)).sum(axis=1) / w.sum()
        V = part.g.wJ0.sum(axis=1)
        done = float((np.einsum("eij,eij->e", stress, D) * V).sum()) * part.state.dt
        self.sums[part.name] = self.sums.get(part.name, 0.0) + done
        return self.sums[part.name] / (self.unit * float(V.sum()))
