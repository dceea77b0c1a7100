"""Serendipity quadratic wedge, 15 nodes."""

from . import register
from .base import Shape

register(Shape(
    name="penta15", dim=3, order=2, corners=6,
    nodes=(
        (0, 0, -1), (1, 0, -1), (0, 1, -1), (0, 0, 1), (1, 0, 1), (0, 1, 1), (0.5, 0, -1),
        (0.5, 0.5, -1), (0, 0.5, -1), (0.5, 0, 1), (0.5, 0.5, 1), (0, 0.5, 1), (0, 0, 0), (1, 0, 0),
        (0, 1, 0),
    ),
    span="1 r s t r2 s2 rs rt st r2t s2t rst t2 rt2 st2",
    rules={"G21": "penta21", "G8": "penta8"},
    center=(1 / 3, 1 / 3, 0),
    facets=(
        ("quad8", (0, 1, 4, 3, 6, 13, 9, 12)),
        ("quad8", (1, 2, 5, 4, 7, 14, 10, 13)),
        ("quad8", (0, 3, 5, 2, 12, 11, 14, 8)),
        ("tri6", (0, 2, 1, 8, 7, 6)),
        ("tri6", (3, 4, 5, 9, 10, 11)),
    ),
))
