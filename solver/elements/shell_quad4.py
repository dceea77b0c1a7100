"""Bilinear quadrilateral shell: displacements on both faces."""

from . import register
from .shell import thick

register(thick("quad4", 1, (0.0, 0.0), {"G8": "hex8", "G12": "hex12"}))
