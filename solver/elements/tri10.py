"""Cubic triangle, 10 nodes; the two on the last edge run from the first corner."""

from . import register
from .base import Shape

A, B = 1 / 3, 2 / 3
register(Shape(
    name="tri10", dim=2, order=3, corners=3,
    nodes=((0, 0), (1, 0), (0, 1), (A, 0), (B, 0), (B, A), (A, B), (0, A), (0, B), (A, A)),
    span="1 r s r2 s2 rs r3 s3 r2s rs2",
    rules={"G7": "tri7"},
    center=(A, A),
    linear_fit=True,
))
