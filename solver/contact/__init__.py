"""Contact by FEBio's type names; a file is read when its type is first asked for.

What a contact is to the solver is said in :mod:`.base`.
"""

from __future__ import annotations

from typing import Any

from ..registry import Registry

TYPES = {
    "tied-node-on-facet": "tied_node",
    "tied-facet-on-facet": "tied_facet",
    "tied-elastic": "tied_elastic",
    "tied-biphasic": "tied_biphasic",
    "tied-multiphasic": "tied_multiphasic",
    "sticky": "sticky",
    "contact potential": "potential",
    "sliding-elastic": "sliding_elastic",
    "sliding-biphasic": "sliding_biphasic",
    "sliding-biphasic-solute": "sliding_biphasic_solute",
    "sliding-multiphasic": "sliding_multiphasic",
    "sliding-node-on-facet": "node_on_facet",
    "sliding-facet-on-facet": "facet_on_facet",
}
FRICTION = {  # the names of types with friction
    "sliding-elastic": "sliding-elastic with friction",
    "sliding-biphasic": "sliding-biphasic with friction",
    "sliding-multiphasic": "sliding-multiphasic with friction",
    "sliding-node-on-facet": "sliding-node-on-facet with friction",
}
FILES = {
    **TYPES,
    "sliding-elastic with friction": "sliding_friction",
    "sliding-biphasic with friction": "biphasic_friction",
    "sliding-multiphasic with friction": "multiphasic_friction",
    "sliding-node-on-facet with friction": "node_friction",
}
_all: Registry[Any] = Registry(__name__, FILES)
register = _all.register


def known(febio_type: str) -> bool:
    return febio_type in TYPES


def load(febio_type: str, friction: bool = False) -> Any:
    """The class of a contact type, with friction where it is asked for; KeyError where there is none."""
    return _all.load(FRICTION[febio_type] if friction else febio_type)
