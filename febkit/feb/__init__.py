"""FEBio input files (.feb): read, written, converted, checked."""

from .read import read, read_bytes
from .write import write

__all__ = ["read", "read_bytes", "write"]
