"""Quadratic tetrahedron with face and body bubbles, 15 nodes."""

from . import register
from .base import Shape

register(Shape(
    name="tet15", dim=3, order=2, corners=4,
    nodes=(
        (0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (0.5, 0, 0), (0.5, 0.5, 0), (0, 0.5, 0),
        (0, 0, 0.5), (0.5, 0, 0.5), (0, 0.5, 0.5), (1 / 3, 1 / 3, 0), (1 / 3, 0, 1 / 3),
        (1 / 3, 1 / 3, 1 / 3), (0, 1 / 3, 1 / 3), (0.25, 0.25, 0.25),
    ),
    span="1 r s t r2 s2 t2 rs st rt r2s+rs2 r2t+rt2 s2t+st2 rst r2st+rs2t+rst2",
    rules={"G15": "tet15", "G11": "tet11", "G8": "tet8", "G4": "tet4"},
    center=(0.25, 0.25, 0.25),
    facets=(
        ("tri7", (0, 1, 3, 4, 8, 7, 11)),
        ("tri7", (1, 2, 3, 5, 9, 8, 12)),
        ("tri7", (2, 0, 3, 6, 7, 9, 13)),
        ("tri7", (2, 1, 0, 5, 4, 6, 10)),
    ),
    linear_fit=True,
))
