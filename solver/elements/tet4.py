"""Linear tetrahedron, 4 nodes."""

from . import register
from .base import Shape

register(Shape(
    name="tet4", dim=3, order=1, corners=4,
    nodes=(
        (0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1),
    ),
    span="1 r s t",
    rules={"G1": "tet1", "G4": "tet4"},
    center=(0.25, 0.25, 0.25),
    facets=(
        ("tri3", (0, 1, 3)),
        ("tri3", (1, 2, 3)),
        ("tri3", (2, 0, 3)),
        ("tri3", (2, 1, 0)),
    ),
))
