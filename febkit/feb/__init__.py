"""FEBio input files (.feb): read, written, converted, checked."""

from .read import read, read_bytes

__all__ = ["read", "read_bytes"]
