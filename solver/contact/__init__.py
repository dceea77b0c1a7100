"""Contact by FEBio's type names; a file is read when its type is first asked for.

What a contact is to the solver is said in :mod:`.base`.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

TYPES = {
    "tied-node-on-facet": "tied_node",
    "tied-facet-on-facet": "tied_facet",
    "tied-elastic": "tied_elastic",
    "tied-biphasic": "tied_biphasic",
    "sliding-elastic": "sliding_elastic",
    "sliding-biphasic": "sliding_biphasic",
    "sliding-node-on-facet": "node_on_facet",
    "sliding-facet-on-facet": "facet_on_facet",
}
_classes: dict[str, Any] = {}


def register(cls: Any, *febio_types: str) -> None:
    """Make a class known by FEBio's type names; the last line of a contact's file."""
    _classes.update(dict.fromkeys(febio_types, cls))


def known(febio_type: str) -> bool:
    return febio_type in TYPES


def load(febio_type: str) -> Any:
    """The class of a contact type; KeyError where there is none."""
    import_module(f"{__name__}.{TYPES[febio_type]}")
    return _classes[febio_type]
