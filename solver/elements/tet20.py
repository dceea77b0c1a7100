"""Cubic tetrahedron, 20 nodes: corners, two on each edge, one on each facet."""

from . import register
from .base import Shape

A, B = 1 / 3, 2 / 3
register(Shape(
    name="tet20", dim=3, order=3, corners=4,
    nodes=(
        (0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (A, 0, 0), (B, 0, 0), (B, A, 0), (A, B, 0), (0, A, 0), (0, B, 0),
        (0, 0, A), (0, 0, B), (B, 0, A), (A, 0, B), (0, B, A), (0, A, B), (A, 0, A), (A, A, A), (0, A, A), (A, A, 0),
    ),
    span="1 r s t r2 s2 t2 rs st rt r3 s3 t3 r2s rs2 s2t st2 r2t rt2 rst",
    rules={"G15": "tet15"},
    center=(0.25, 0.25, 0.25),
    facets=(
        ("tri10", (0, 1, 3, 4, 5, 12, 13, 10, 11, 16)),
        ("tri10", (1, 2, 3, 6, 7, 14, 15, 12, 13, 17)),
        ("tri10", (2, 0, 3, 9, 8, 10, 11, 14, 15, 18)),
        ("tri10", (2, 1, 0, 7, 6, 5, 4, 9, 8, 19)),
    ),
    linear_fit=True,
))
