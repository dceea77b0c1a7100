"""Linear line, 2 nodes."""

from . import register
from .base import Shape

register(Shape(
    name="line2", dim=1, order=1, corners=2,
    nodes=(
        (-1,), (1,),
    ),
    span="1 r",
    rules={"G1": "line1", "G2": "line2"},
    center=(0,),
))
