"""FEBio input files (.feb): read, written, converted, checked."""

from .diff import Difference, diff
from .findings import Finding
from .read import read, read_bytes
from .validate import validate
from .write import to_bytes, write

__all__ = ["Difference", "Finding", "diff", "read", "read_bytes", "to_bytes", "validate", "write"]
