"""From tissue to cell: series of a solved tissue at points, and the boundary of a cell model made of them."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .boundary import Driven, drive, with_solutes, write, write_section
    from .checks import Checks, check, same_units
    from .driving import checked, read_driving, read_points
    from .errors import estimate
    from .field import Field, from_dataset, from_mesh
    from .histories import Handoff, handoff, overlay, surface_nodes
    from .location import locate
    from .taylor import RECOVERIES, series

# public name -> module; imported when first used, so that the command line starts fast
_HOME = {
    "Driven": "boundary", "drive": "boundary", "with_solutes": "boundary", "write": "boundary",
    "write_section": "boundary",
    "Checks": "checks", "check": "checks", "same_units": "checks", "checked": "driving", "read_driving": "driving",
    "estimate": "errors", "read_points": "driving", "Field": "field", "from_dataset": "field", "from_mesh": "field",
    "Handoff": "histories", "handoff": "histories", "overlay": "histories", "surface_nodes": "histories",
    "locate": "location", "RECOVERIES": "taylor", "series": "taylor",
}

__all__ = ["RECOVERIES", "Checks", "Driven", "Field", "Handoff", "check", "checked", "drive", "estimate",
           "from_dataset", "from_mesh", "handoff", "locate", "overlay", "read_driving", "read_points", "same_units",
           "series", "surface_nodes", "with_solutes", "write", "write_section"]


def __dir__() -> list[str]:
    return sorted({*globals(), *_HOME})


def __getattr__(name: str) -> Any:
    if name in _HOME:
        return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
