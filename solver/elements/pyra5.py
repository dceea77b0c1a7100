"""Linear pyramid: a brick whose top face is drawn together, 5 nodes."""

from . import register
from .base import Shape

register(Shape(
    name="pyra5", dim=3, order=1, corners=5,
    nodes=(
        (-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (0, 0, 1),
    ),
    span="1 t r-rt s-st rs-rst",
    rules={"G8": "hex8"},
    center=(0, 0, -0.5),
    facets=(
        ("tri3", (0, 1, 4)),
        ("tri3", (1, 2, 4)),
        ("tri3", (2, 3, 4)),
        ("tri3", (3, 0, 4)),
        ("quad4", (3, 2, 1, 0)),
    ),
))
