"""Serendipity quadratic quadrilateral shell: displacements on both faces."""

from . import register
from .shell import thick

register(thick("quad8", 1, (0.0, 0.0), {"G18": "hex18", "G27": "hex27"}))
