"""FEBio input files (.feb): read, written, converted, checked."""

from .diff import Difference, diff
from .read import read, read_bytes
from .write import to_bytes, write

__all__ = ["Difference", "diff", "read", "read_bytes", "to_bytes", "write"]
