"""Constructors of materials: ``febkit.materials.NeoHookean(E=0.6, v=0.1)``.

Each carries FEBio's parameters, with defaults and help made from the solver's own records; every FEBio material is
there by its type name as well: ``febkit.materials.of("neo-Hookean", E=0.6, v=0.1)``. A parameter is a number, a formula
of X, Y, Z and t (text), or, for a property, another material.
"""

from __future__ import annotations

import re
from functools import cache
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

    from febkit.modelling.node import Node

MIXTURES = ("biphasic", "biphasic-solute", "triphasic", "multiphasic", "rigid body")


@cache
def names() -> dict[str, str]:
    """FEBio's type of each constructor's name."""
    from febkit.feb.features import table
    from febkit.solver import permeabilities, supplies
    from febkit.solver.solids.registry import tables

    kinds = [t for types in tables().values() for t in types]
    kinds += [*permeabilities.TYPES, *supplies.TYPES, *table()["material"]]
    out: dict[str, str] = {}
    for kind in kinds:
        out.setdefault(name_of(kind), kind)
    return out


def name_of(kind: str) -> str:
    """The constructor's name of a FEBio type: "neo-Hookean" is NeoHookean, "2D trans iso ..." ends in 2D."""
    words = [w for w in re.split(r"\W+", kind) if w]
    if words and words[0][0].isdigit():
        words = [*words[1:], words[0]]
    return "".join(w[0].upper() + w[1:] for w in words)


def of(type: str, /, **parameters: Any) -> Node:
    """A material, or a property of one, by FEBio's type name. InputError names a parameter that FEBio does not know."""
    from febkit.feb.features import anywhere
    from febkit.model import Component, InputError
    from febkit.modelling.node import Node
    from febkit.modelling.sets import missing

    if type not in anywhere():
        raise InputError(missing("material", type, [*names().values()]))
    node = Node.of(Component("material", type), type)
    for name, value in parameters.items():
        if isinstance(value, (list, tuple)) and value and all(isinstance(v, Node) for v in value):
            for v in value:
                node.add(name, v)
        elif value is not None:
            try:
                setattr(node, name, value)
            except AttributeError as e:
                raise InputError(str(e)) from None
    return node


@cache
def constructor(name: str) -> Callable[..., Node]:
    """The constructor called ``name``, with its own signature and help. KeyError where there is none."""
    import inspect

    from febkit.model import Component
    from febkit.modelling import schema

    kind = names()[name]

    def make(**parameters: Any) -> Node:
        return of(kind, **parameters)

    c = Component("material", kind)
    cls = schema.record(c)
    known = sorted(schema.parameters(c), key=lambda t: (t == "density", t))
    if cls is not None:
        first = [*cls.parameters, *getattr(cls, "properties", {})]
        place = {schema.attribute(f): k for k, f in enumerate(first)}
        known.sort(key=lambda t: place.get(schema.attribute(t), 99))
    empty = inspect.Parameter.empty
    parameters = []
    for t in known:
        value = schema.default(c, t)
        parameters.append(inspect.Parameter(
            schema.attribute(t), inspect.Parameter.KEYWORD_ONLY, default=empty if cls is not None and value is None and
            t in getattr(cls, "parameters", ()) else value))  # fmt: skip
    make.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    make.__name__ = make.__qualname__ = name
    doc = inspect.getdoc(cls) if cls is not None else ""
    make.__doc__ = f'FEBio\'s "{kind}".\n\n{doc}'.rstrip()
    return make


def __getattr__(name: str) -> Any:
    if not name.startswith("_") and name in names():
        return constructor(name)
    from difflib import get_close_matches

    close = [] if name.startswith("_") else get_close_matches(name, names(), 1, 0.6)
    hint = f"; did you mean {close[0]}?" if close else ""
    raise AttributeError(f"febkit.materials has no {name}{hint}")


def __dir__() -> list[str]:
    return sorted({"of", *names()})
