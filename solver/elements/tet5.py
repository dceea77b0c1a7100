"""Linear tetrahedron with a bubble, 5 nodes."""

from . import register
from .base import Shape

register(Shape(
    name="tet5", dim=3, order=1, corners=4,
    nodes=(
        (0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (0.25, 0.25, 0.25),
    ),
    span="1 r s t rst-r2st-rs2t-rst2",
    rules={"G4": "tet4"},
    center=(0.25, 0.25, 0.25),
    facets=(
        ("tri3", (0, 1, 3)),
        ("tri3", (1, 2, 3)),
        ("tri3", (2, 0, 3)),
        ("tri3", (2, 1, 0)),
    ),
    linear_fit=True,
))
