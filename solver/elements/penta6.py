"""Linear wedge, 6 nodes."""

from . import register
from .base import Shape

register(Shape(
    name="penta6", dim=3, order=1, corners=6,
    nodes=(
        (0, 0, -1), (1, 0, -1), (0, 1, -1), (0, 0, 1), (1, 0, 1), (0, 1, 1),
    ),
    span="1 r s t rt st",
    rules={"G6": "penta6"},
    center=(1 / 3, 1 / 3, 0),
    facets=(
        ("quad4", (0, 1, 4, 3)),
        ("quad4", (1, 2, 5, 4)),
        ("quad4", (0, 3, 5, 2)),
        ("tri3", (0, 2, 1)),
        ("tri3", (3, 4, 5)),
    ),
))
