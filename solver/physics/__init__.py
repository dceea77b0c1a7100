"""Physics by name; a file is read when its physics is first asked for.

What a physics is to the solver is said in :mod:`.base`.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

FILES = {
    "standard": "standard",
    "three-field": "three_field",
    "biphasic": "biphasic",
}
_classes: dict[str, Any] = {}


def register(cls: Any, name: str) -> None:
    """Make a physics known by its name; the last line of its file."""
    _classes[name] = cls


def load(name: str) -> Any:
    """The record of a physics; KeyError where there is none."""
    import_module(f"{__name__}.{FILES[name]}")
    return _classes[name]


def default() -> Any:
    """The physics of a block that says nothing of it: displacements alone."""
    return load("standard")()
