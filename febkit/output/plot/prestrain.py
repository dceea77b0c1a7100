"""Solids with prestrain F0: stretches of their fibers, the correction of F0, and how compatible it is."""

from __future__ import annotations

from typing import Any

import numpy as np

from febkit.solver.points import Points
from febkit.solver.solids.fiber import directions

from .base import Floats, Part, mean, register
from .recovery import patches

NAMES = ("Prestrained", "PrestrainedUncoupled")
CURL = ((1, 2, 2, 1), (2, 0, 0, 2), (0, 1, 1, 0))  # C_i. = d_a F_.b - d_c F_.d


def prestrained(part: Part) -> tuple[Any, Points] | None:
    """The law and the points as it sees them, with its own axes."""
    law: Any = part.g.block.solid
    return (law, law.inner(part.points())) if type(law).__name__ in NAMES else None


def gradient(law: Any, pts: Points) -> Floats:
    """F0 (n, 3, 3)."""
    F0 = np.eye(3) if law.prestrain is None else law.prestrain.gradient(pts)
    return np.broadcast_to(F0, (pts.n, 3, 3))


def stretches(part: Part) -> tuple[Floats, Floats] | None:
    """|F0 a| and |F F0 a| of the fiber a (m, g)."""
    found = prestrained(part)
    fiber = getattr(found[0].elastic, "fiber", None) if found is not None else None
    if found is None or fiber is None:
        return None
    law, pts = found
    a = np.broadcast_to(directions(fiber, pts), (pts.n, 3))
    there = np.einsum("nij,nj->ni", gradient(law, pts), a)
    now = np.einsum("nij,nj->ni", pts.F, there)
    return part.shaped(np.linalg.norm(there, axis=1)), part.shaped(np.linalg.norm(now, axis=1))


def target(part: Part) -> Floats | None:
    both = stretches(part)
    return None if both is None else both[0]


def present(part: Part) -> Floats | None:
    both = stretches(part)
    return None if both is None else both[1]


def error(part: Part) -> Floats | None:
    """| |F F0 a| / |F0 a| - 1 |."""
    both = stretches(part)
    return None if both is None else np.abs(both[1] / both[0] - 1.0)


def correction(part: Part) -> Floats | None:
    """What multiplies F0 from the left (m, g, 9): nothing corrects it here."""
    return None if prestrained(part) is None else part.shaped(np.eye(3).reshape(1, 9))


def recovered_correction(part: Part) -> Floats | None:
    """The same at the nodes (node, 9)."""
    v = correction(part) if part.group is not None and not part.shell else None
    return None if v is None else patches(part, v)


def compatibility(part: Part) -> Floats | None:
    """Mean norm over each element of the curl of F0, recovered at the nodes and differentiated by present positions."""
    found = prestrained(part) if part.group is not None and not part.shell else None
    if found is None:
        return None
    g, order = part.g, part.mesh.nodes()
    F0 = patches(part, part.shaped(gradient(*found).reshape(-1, 9)))
    at = np.zeros((int(order.max()) + 1, 9))
    at[order] = F0  # type: ignore[assignment]
    spatial = np.einsum("gad,egdj,egji->egai", g.dN, g.iJ0, np.linalg.inv(g.F))
    d = np.einsum("egai,eak->egik", spatial, at[g.conn]).reshape(g.m, g.g, 3, 3, 3)  # d_i F_jk
    C = np.stack([d[:, :, a, :, b] - d[:, :, c, :, e] for a, b, c, e in CURL], axis=2)
    return np.asarray(np.sqrt((C**2).sum(axis=(2, 3))).mean(axis=1))


register("in-situ target stretch", mean(target))
register("prestrain stretch", mean(present))
register("prestrain stretch error", mean(error))
register("prestrain correction", mean(correction))
register("SPR prestrain correction", recovered_correction)
register("prestrain compatibility", compatibility)
