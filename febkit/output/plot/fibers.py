"""Local axes and fibers, of the solid of a part or of one within it ("fiber stretch['solid[1]']")."""

from __future__ import annotations

import numpy as np

from febkit.solver.points import Points
from febkit.solver.solids.fiber import directions

from . import laws
from .base import Floats, Part, mean, of_solids, register


def axes(pts: Points) -> Floats:
    """Local axes (n, 3, 3) as columns."""
    return np.broadcast_to(np.eye(3) if pts.Q is None else pts.Q, (pts.n, 3, 3))


def own_axes(part: Part, path: str = "") -> Floats | None:
    """Axes at the first point of each element (m, 9), by rows."""
    found = laws.solid(part, path) if part.group is not None else None
    if found is None:
        return None
    return axes(found[0].inner(found[1])).reshape(part.g.m, part.g.g, 9)[:, 0]


def spun(part: Part, path: str = "") -> Floats | None:
    """F a, a the fiber (m, g, 3)."""
    found = laws.solid(part, path)
    fiber = getattr(found[0], "fiber", None) if found is not None else None
    if fiber is None:
        return None
    assert found is not None
    law, pts = found
    a = np.broadcast_to(directions(fiber, law.inner(pts)), (pts.n, 3))
    return part.shaped(np.einsum("nij,nj->ni", pts.F, a))


def stretch(part: Part, path: str = "") -> Floats | None:
    """|F a|."""
    a = spun(part, path)
    return None if a is None else np.linalg.norm(a, axis=-1)


def direction(part: Part, path: str = "") -> Floats | None:
    """F a / |F a|."""
    a = spun(part, path)
    return None if a is None else a / np.linalg.norm(a, axis=-1, keepdims=True)


def vector(part: Part, path: str = "") -> Floats | None:
    """The mean direction of each element, a unit vector (m, 3)."""
    a = direction(part, path) if part.group is not None else None
    if a is None:
        return None
    total = a.mean(axis=1)
    return total / np.linalg.norm(total, axis=-1, keepdims=True)


def axis_stretch(part: Part, path: str = "") -> Floats | None:
    """|F e1|, e1 the first local axis."""
    found = laws.solid(part, path)
    if found is None:
        return None
    law, pts = found
    e = axes(law.inner(pts))[:, :, 0]
    return part.shaped(np.linalg.norm(np.einsum("nij,nj->ni", pts.F, e), axis=-1))


register("material axes", own_axes, more=True)
register("fiber vector", vector, more=True)
register("fiber stretch", mean(of_solids(stretch)), more=True)
register("deviatoric fiber stretch", mean(of_solids(axis_stretch)), more=True)
