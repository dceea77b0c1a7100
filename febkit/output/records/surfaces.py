"""<surface_data surface="...">: one value of a surface, numbered from 1 as the surfaces of the mesh."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from febkit.model.sets import surface
from febkit.output import plot
from febkit.output.plot.base import Face

from . import Column, Floats, Ints, places

if TYPE_CHECKING:
    from febkit.model import LogEntry
    from febkit.output.plot import View

GAP = "max contact gap"
# item -> plot variable
ITEMS = {"volume": "enclosed volume", "volume change": "enclosed volume change", "contact area": "contact area"}


def rows(view: View, entry: LogEntry) -> tuple[Ints, Ints]:
    names = [f.name for f in view.faces]
    own = [names.index(surface(view.model.mesh, entry.set, entry.where).name) + 1] if entry.set else None
    return places(entry, np.arange(1, len(names) + 1), None if own is None else np.array(own, np.int64))


def column(view: View, name: str, entry: LogEntry) -> Column | None:
    if name == GAP:
        return lambda: np.array([_largest_gap(f) for f in view.faces])
    if name not in ITEMS:
        return None
    give = plot.find(ITEMS[name])
    assert give is not None

    def values() -> Floats:
        every = [give(f) for f in view.faces]
        return np.array([0.0 if v is None else float(v) for v in every])

    return values


def _largest_gap(face: Face) -> float:
    """The largest positive gap at the points of a surface in contact."""
    from febkit.output.plot.contacts import at_points

    found = at_points(face, "gap")
    return 0.0 if found is None else float(np.max(found[1], initial=0.0))
