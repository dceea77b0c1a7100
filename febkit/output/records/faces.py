"""<face_data surface="...">: values of the facets of a surface, numbered from 1."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from febkit.model.sets import surface
from febkit.output import plot
from febkit.output.plot.base import Face

from . import Column, Floats, Ints, places

if TYPE_CHECKING:
    from febkit.model import LogEntry
    from febkit.output.plot import View

# item -> plot variable, component
ITEMS: dict[str, tuple[str, int]] = {
    "facet area": ("facet area", 0),
    "contact gap": ("contact gap", 0),
    "contact pressure": ("contact pressure", 0),
    **{f"contact_traction.{c}": ("surface traction", k) for k, c in enumerate("xyz")},
}


def face(view: View, entry: LogEntry) -> Face:
    """The surface that a record is about."""
    found = surface(view.model.mesh, entry.set or "", entry.where)
    return next(f for f in view.faces if f.name == found.name)


def rows(view: View, entry: LogEntry) -> tuple[Ints, Ints]:
    return places(entry, np.arange(1, len(face(view, entry).mesh.rows()) + 1), None)


def column(view: View, name: str, entry: LogEntry) -> Column | None:
    return partial(_values, face(view, entry), *ITEMS[name]) if name in ITEMS else None


def _values(of: Face, variable: str, k: int) -> Floats:
    give = plot.find(variable)
    v = None if give is None else give(of)
    n = len(of.mesh.rows())
    return np.zeros(n) if v is None else np.asarray(v).reshape(n, -1)[:, k]
