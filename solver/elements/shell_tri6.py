"""Quadratic triangular shell: displacements on both faces."""

from . import register
from .shell import thick

register(thick("tri6", 1, (1 / 3, 1 / 3), {"G14": "penta14", "G21": "penta21"}))
