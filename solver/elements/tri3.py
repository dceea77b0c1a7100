"""Linear triangle, 3 nodes."""

from . import register
from .base import Shape

register(Shape(
    name="tri3", dim=2, order=1, corners=3,
    nodes=(
        (0, 0), (1, 0), (0, 1),
    ),
    span="1 r s",
    rules={"G3": "tri3", "G1": "tri1", "G7": "tri7"},
    center=(1 / 3, 1 / 3),
))
