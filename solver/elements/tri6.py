"""Quadratic triangle, 6 nodes."""

from . import register
from .base import Shape

register(Shape(
    name="tri6", dim=2, order=2, corners=3,
    nodes=(
        (0, 0), (1, 0), (0, 1), (0.5, 0), (0.5, 0.5), (0, 0.5),
    ),
    span="1 r s rs r2 s2",
    rules={"G7": "tri7", "G3": "tri3", "G4": "tri4"},
    center=(1 / 3, 1 / 3),
))
