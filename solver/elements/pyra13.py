"""Quadratic pyramid: a serendipity brick whose top face is drawn together, 13 nodes."""

from . import register
from .base import Shape

register(Shape(
    name="pyra13", dim=3, order=2, corners=5,
    nodes=(
        (-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (0, 0, 1), (0, -1, -1), (1, 0, -1),
        (0, 1, -1), (-1, 0, -1), (-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0),
    ),
    span="1-t t+t2 t-t2 r-rt s-st rs-rst r2-r2t s2-s2t r2s-r2st s2r-s2rt rt-rt2 st-st2 rst-rst2",
    rules={"G8": "hex8"},
    center=(0, 0, -0.5),
    facets=(
        ("tri6", (0, 1, 4, 5, 10, 9)),
        ("tri6", (1, 2, 4, 6, 11, 10)),
        ("tri6", (2, 3, 4, 7, 12, 11)),
        ("tri6", (3, 0, 4, 8, 9, 12)),
        ("quad8", (3, 2, 1, 0, 7, 6, 5, 8)),
    ),
))
