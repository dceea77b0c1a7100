"""Quadratic tetrahedron, 10 nodes."""

from . import register
from .base import Shape

register(Shape(
    name="tet10", dim=3, order=2, corners=4,
    nodes=(
        (0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (0.5, 0, 0), (0.5, 0.5, 0), (0, 0.5, 0),
        (0, 0, 0.5), (0.5, 0, 0.5), (0, 0.5, 0.5),
    ),
    span="1 r s t r2 s2 t2 rs st rt",
    rules={"G8": "tet8", "G4": "tet4", "G1": "tet1"},
    center=(0.25, 0.25, 0.25),
    facets=(
        ("tri6", (0, 1, 3, 4, 8, 7)),
        ("tri6", (1, 2, 3, 5, 9, 8)),
        ("tri6", (2, 0, 3, 6, 7, 9)),
        ("tri6", (2, 1, 0, 5, 4, 6)),
    ),
    linear_fit=True,
))
