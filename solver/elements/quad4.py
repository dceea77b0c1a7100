"""Bilinear quadrilateral, 4 nodes."""

from . import register
from .base import Shape

register(Shape(
    name="quad4", dim=2, order=1, corners=4,
    nodes=(
        (-1, -1), (1, -1), (1, 1), (-1, 1),
    ),
    span="1 r s rs",
    rules={"G4": "quad4", "G16": "quad16"},
    center=(0, 0),
))
