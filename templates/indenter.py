"""A rigid indenter over the axis of a layer: a spherical tip, or a plane-ended cylinder with a rounded edge."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from febkit.model import InputError
from febkit.model.mesh import Floats, Ints

from .plan import disc


def indenter(p: Mapping[str, Any], apex: float) -> tuple[Floats, Ints, Ints]:
    """Nodes (node, 3), hexahedra (element, 8) and the quads (quad, 4) of the face that presses, out of the body.

    The tip touches z = ``apex`` on the axis. One layer of elements: the body is rigid, its shape is all that counts.
    """
    R = float(p["indenter_radius"])
    ball = p["pressed_by"] == "sphere"
    plan = disc(R * (0.9 if ball else 1.0), int(p["indenter_core"]), int(p["indenter_rings"]), bool(p["quarter"]))
    r = np.linalg.norm(plan.x, axis=1)
    tip = R - np.sqrt(R * R - r * r) if ball else _rounded(r, R, float(p["edge_radius"]))
    face = np.column_stack([plan.x, apex + tip])
    back = np.column_stack([plan.x, np.full(len(r), apex + tip.max() + 0.25 * R)])
    m = len(r)
    return np.concatenate([face, back]), np.concatenate([plan.quads, plan.quads + m], axis=1), plan.quads[:, ::-1]


def _rounded(r: Floats, R: float, edge: float) -> Floats:
    """Height over a plane end whose edge is a quarter of a circle of radius ``edge`` (its last tenth cut off)."""
    if edge >= R:
        raise InputError(f"edge_radius ({edge:g} mm) must be smaller than indenter_radius ({R:g} mm)")
    over = np.minimum(np.maximum(r - (R - edge), 0.0), 0.95 * edge)
    return np.asarray(edge - np.sqrt(edge * edge - over * over))
