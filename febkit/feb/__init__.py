"""FEBio input files (.feb): read, written, converted, checked."""

from __future__ import annotations

from .read import read, read_bytes

TYPE_CHECKING = False
if TYPE_CHECKING:
    from .difference import Difference, diff
    from .findings import Finding
    from .validation import validate
    from .writer import to_bytes, write

# public name -> module, imported when first used: a solve only reads
_LAZY = {
    "Difference": "difference", "diff": "difference", "Finding": "findings", "validate": "validation",
    "to_bytes": "writer", "write": "writer",
}  # fmt: skip

__all__ = ["Difference", "Finding", "diff", "read", "read_bytes", "to_bytes", "validate", "write"]


def __dir__() -> list[str]:
    return sorted({*globals(), *_LAZY})


def __getattr__(name: str) -> object:
    if name in _LAZY:
        from importlib import import_module

        return getattr(import_module(f"{__name__}.{_LAZY[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
