"""Quadratic line, 3 nodes."""

from . import register
from .base import Shape

register(Shape(
    name="line3", dim=1, order=2, corners=2,
    nodes=(
        (-1,), (1,), (0,),
    ),
    span="1 r r2",
    rules={"G2": "line2", "G3": "line3"},
    center=(0,),
))
