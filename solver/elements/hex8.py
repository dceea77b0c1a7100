"""Trilinear brick, 8 nodes."""

from . import register
from .base import Shape

register(Shape(
    name="hex8", dim=3, order=1, corners=8,
    nodes=(
        (-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1),
        (-1, 1, 1),
    ),
    span="1 r s t rs st rt rst",
    rules={"G8": "hex8", "G6": "hex6", "G1": "hex1"},
    center=(0, 0, 0),
    facets=(
        ("quad4", (0, 1, 5, 4)),
        ("quad4", (1, 2, 6, 5)),
        ("quad4", (2, 3, 7, 6)),
        ("quad4", (3, 0, 4, 7)),
        ("quad4", (0, 3, 2, 1)),
        ("quad4", (4, 5, 6, 7)),
    ),
))
