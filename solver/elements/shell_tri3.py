"""Linear triangular shell: displacements on both faces."""

from . import register
from .shell import thick

register(thick("tri3", 1, (1 / 3, 1 / 3), {"G6": "penta6", "G9": "penta9"}))
