"""FEBio's parameter paths: ``fem.material('cartilage').solid.E``, as its optimisation files and logs write them."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from febkit.model import InputError

from .node import Node
from .sets import missing

if TYPE_CHECKING:
    from .model import Model

# one piece: name, name[0], name('other'), name(1)
_PIECE = re.compile(r"""([A-Za-z_][\w -]*?)\s*(?:\[\s*(\d+)\s*\]|\(\s*(?:'([^']*)'|"([^"]*)"|(\d+))\s*\))?""")
_LISTS = {
    "bc": "boundary", "nodal_load": "loads", "surface_load": "loads", "body_load": "loads", "load": "loads",
    "contact": "contact", "surface_pair_interaction": "contact", "constraint": "constraints", "rigid_bc": "rigid",
    "rigid_load": "rigid", "rigid_connector": "rigid", "ic": "initial_conditions", "initial": "initial_conditions",
}  # fmt: skip
_ANY = ("load", "initial", "surface_pair_interaction")  # lists by these names hold components of other tags
AXES = "xyz"
SAY = "write fem.material('name').parameter, name.parameter or fem.bc[0].value"


@dataclass(frozen=True, slots=True)
class Piece:
    """``name[place]``, ``name('label')`` or ``name``."""

    name: str
    place: int | None = None
    label: str | None = None

    def __str__(self) -> str:
        return self.label if self.label is not None else str(self.place or 0)


@dataclass(frozen=True, slots=True)
class Parameter:
    """What a path leads to: ``get()`` its value, ``put(value)`` another."""

    get: Callable[[], Any]
    put: Callable[[Any], None]


def pieces(path: str) -> list[Piece]:
    """The pieces of a path, none where it is no path."""
    out = []
    for text in re.split(r"\.(?=(?:[^'\"]|'[^']*'|\"[^\"]*\")*$)", path):  # dots outside quotes
        m = _PIECE.fullmatch(text.strip())
        if m is None:
            return []
        name, zero, single, double, one = m.groups()
        place = int(zero) if zero else int(one) - 1 if one else None
        out.append(Piece(name, place, single if single is not None else double))
    return out


def find(model: Model, path: str) -> Parameter:
    """The parameter of a path: FEBio's own, ``fem.`` left out or not, or ``material.parameter``.

    Beyond parameters of materials and conditions: ``fem.a``, a global variable; ``...points[1].y`` of a curve, a load
    controller's too; ``...ksi[0]`` and ``...force.x``, one number of several.
    Raises InputError that says which piece of the path does not exist.
    """
    first, *rest = pieces(path) or [Piece("")]
    if first == Piece("fem") and rest:
        first, *rest = rest
        if not rest:
            return _variable(model, path, first.name)
    if not rest:
        raise InputError(f"{path!r} is no parameter path: {SAY}")
    if first.name == "load_controller":
        return _curve(model, path, first, rest)
    return _within(path, _first(model, path, first), rest)


def _variable(model: Model, path: str, name: str) -> Parameter:
    held = model.record.variables
    if name not in held:
        raise InputError(f"{path}: {missing('global variable', name, held)}")
    return Parameter(
        lambda: model.record.variables[name],
        lambda v: model._put(variables={**model.record.variables, name: float(v)}),
    )


def _curve(model: Model, path: str, first: Piece, rest: list[Piece]) -> Parameter:
    """A number of a load controller's points."""
    every = {c.name if first.label is not None else k: c.id for k, c in enumerate(model.record.controllers)}
    number = every.get(first.label if first.label is not None else first.place or 0)
    if number is None:
        raise InputError(f"{path}: {missing('load_controller', str(first), map(str, every))}")
    if [p.name for p in rest] not in (["points", "x"], ["points", "y"]):
        raise InputError(f"{path}: of a load controller the points are parameters: load_controller[0].points[1].y")
    at, k = _place(path, rest[0], len(model.curves[number].points)), AXES.index(rest[1].name)

    def put(value: Any) -> None:
        curve = model.curves[number]
        points = [list(p) for p in curve.points]
        points[at][k] = float(value)
        model.curves[number] = replace(curve, points=tuple((t, v) for t, v in points))

    return Parameter(lambda: model.curves[number].points[at][k], put)


def _first(model: Model, path: str, piece: Piece) -> Node:
    names = list(model.materials)
    if piece.name == "material":
        place = piece.place or 0
        key = piece.label if piece.label is not None else names[place] if place < len(names) else None
        if key not in names:
            raise InputError(f"{path}: {missing('material', str(piece), names)}")
        return model.materials[key]
    if piece.name not in _LISTS:
        if piece.name in names:
            return model.materials[piece.name]
        raise InputError(f"{path}: {missing('list or material', piece.name, ['material', *_LISTS, *names])}")
    for stage in (model, *model.steps):
        held: Any = getattr(stage, _LISTS[piece.name])
        of_kind = [k for k, c in enumerate(held._held()) if piece.name == c.tag or piece.name in _ANY]
        for n, k in enumerate(of_kind):
            if held._held()[k].name == piece.label if piece.label is not None else n == (piece.place or 0):
                node: Node = held[k]
                return node
    raise InputError(f"{path}: the model has no {piece.name} {piece}")


def _within(path: str, node: Node, rest: list[Piece]) -> Parameter:
    piece, *further = rest
    try:
        tag = node._tag(piece.name)
    except AttributeError as e:
        raise InputError(f"{path}: {e}") from None
    if not further:
        return _number(path, node, tag, piece.place)
    if tag == "points" and tag in node and [p.name for p in further] in (["x"], ["y"]):
        every = node[tag].all(next(iter(node[tag]), ""))
        return _number(path, every[_place(path, piece, len(every))], None, AXES.index(further[0].name))
    if tag not in node:
        raise InputError(f"{path}: the model gives no {tag}")
    if len(further) == 1 and further[0].name in AXES and not node[tag].component.children:
        return _number(path, node, tag, AXES.index(further[0].name))
    every = node.all(tag)
    if piece.label is not None:
        every = [n for n in every if n.name == piece.label]
    return _within(path, every[_place(path, piece, len(every))], further)


def _place(path: str, piece: Piece, size: int) -> int:
    if (piece.place or 0) >= size:
        raise InputError(f"{path}: there are {size} {piece.name}")
    return piece.place or 0


def _number(path: str, node: Node, tag: str | None, at: int | None) -> Parameter:
    """A parameter of a node (the node's own value where no tag is named), or one number of it."""

    def get() -> Any:
        value: Any = node.value if tag is None else getattr(node, tag)
        return value if at is None else _several(path, value, at)[at]

    def put(value: Any) -> None:
        if at is not None:
            several = list(_several(path, node.value if tag is None else getattr(node, tag), at))
            several[at] = value
            value = several[0] if len(several) == 1 else tuple(several)
        if tag is None:
            node.value = value
        else:
            node[tag] = value

    return Parameter(get, put)


def _several(path: str, value: Any, at: int) -> Any:
    if isinstance(value, str) or value is None or at >= np.size(value):
        raise InputError(f"{path}: the parameter is {value!r}, of which there is no number {at}")
    return np.atleast_1d(value).tolist()
