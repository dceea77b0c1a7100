"""FEBio's parameter paths: ``fem.material('cartilage').solid.E``, as its optimisation files and logs write them; a
material's name alone will do, ``cartilage.solid.E``."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from febkit.model import InputError

from .node import Node
from .sets import missing

if TYPE_CHECKING:
    from .model import Model

# fem.material('name').rest, fem.material[0].rest, fem.material(1).rest
_FIRST = re.compile(
    r"""^\s*(?:fem\.)?(\w+)\s*(?:\(\s*['"]([^'"]+)['"]\s*\)|\[\s*(\d+)\s*\]|\(\s*(\d+)\s*\))?"""
    r"""\s*((?:\.\s*[\w-]+(?:\[\d+\])?)+)\s*$"""
)
_LISTS = {
    "bc": "boundary", "nodal_load": "loads", "surface_load": "loads", "body_load": "loads", "load": "loads",
    "contact": "contact", "surface_pair_interaction": "contact", "constraint": "constraints", "rigid_bc": "rigid",
    "rigid_load": "rigid", "rigid_connector": "rigid", "ic": "initial_conditions",
}  # fmt: skip


def find(model: Model, path: str) -> tuple[Node, str]:
    """The node that holds a parameter, and the parameter's name.

    Raises InputError that says which piece of the path does not exist.
    """
    m = _FIRST.match(path)
    if m is None:
        raise InputError(f"{path!r} is no parameter path: write fem.material('name').parameter or fem.bc[0].value")
    what, name, zero, one, rest = m.groups()
    node = _first(model, path, what, name, int(zero) if zero else int(one) - 1 if one else None)
    *inner, last = [p.strip() for p in rest.split(".") if p.strip()]
    for piece in inner:
        node = _next(path, node, piece)
    return node, last


def _first(model: Model, path: str, what: str, name: str | None, place: int | None) -> Node:
    if what == "material":
        names = list(model.materials)
        key = name if name is not None else names[place or 0] if (place or 0) < len(names) else None
        if key not in names:
            raise InputError(f"{path}: {missing('material', str(name or place), names)}")
        return model.materials[key]
    if what not in _LISTS and what in model.materials:
        return model.materials[what]
    if what not in _LISTS:
        raise InputError(f"{path}: {missing('list', what, ['material', *_LISTS])}")
    for stage in (model, *model.steps):
        held: Any = getattr(stage, _LISTS[what])
        of_kind = [k for k, c in enumerate(held._held()) if what in (c.tag, "load", "surface_pair_interaction")]
        for n, k in enumerate(of_kind):
            if held._held()[k].name == name if name is not None else n == (place or 0):
                node: Node = held[k]
                return node
    raise InputError(f"{path}: the model has no {what} {name or place or 0}")


def _next(path: str, node: Node, piece: str) -> Node:
    tag, _, number = piece.partition("[")
    try:
        every = node.all(node[tag].component.tag)
    except (KeyError, AttributeError) as e:
        raise InputError(f"{path}: {e.args[0] if e.args else piece}") from None
    place = int(number.rstrip("]")) if number else 0
    if place >= len(every):
        raise InputError(f"{path}: there are {len(every)} {tag}")
    return every[place]
