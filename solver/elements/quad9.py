"""Biquadratic quadrilateral, 9 nodes."""

from . import register
from .base import Shape

register(Shape(
    name="quad9", dim=2, order=2, corners=4,
    nodes=(
        (-1, -1), (1, -1), (1, 1), (-1, 1), (0, -1), (1, 0), (0, 1), (-1, 0), (0, 0),
    ),
    span="1 r s rs r2 s2 r2s rs2 r2s2",
    rules={"G9": "quad9"},
    center=(0, 0),
))
