"""Physics by name; a file is read when its physics is first asked for.

What a physics is to the solver is said in :mod:`.base`.
"""

from __future__ import annotations

from typing import Any

from ..registry import Registry

FILES = {
    "standard": "standard",
    "biphasic": "biphasic",
    "multiphasic": "multiphasic",
    "three-field": "three_field",
    "assumed strain": "assumed_strain",
    "ut4": "nodal_tets",
    "beam": "beam",
    "linear truss": "truss",
    "elastic truss": "truss",
}
_all: Registry[Any] = Registry(__name__, FILES)
register, load = _all.register, _all.load


def default() -> Any:
    """The physics of a block that says nothing of it: displacements alone."""
    return load("standard")()
