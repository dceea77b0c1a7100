"""One node of a model's parameter trees, as Python attributes: ``m.materials["cartilage"].solid.E = 0.8``."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from febkit.model import Component, InputError

from . import schema
from .text import Value, is_number, is_numbers, listed, parsed, written

Find = Callable[[], Component]
Put = Callable[[Component], None]


class Node:
    """A material, condition, load, control, ... or a property of one, seen through its parameters.

    Attributes are FEBio's parameter names (blanks and hyphens as ``_``, Python's own words with a ``_`` behind): a
    number, a tuple of numbers or text; a property (``solid``, ``permeability``) is a Node itself. ``node["E"]`` is the
    parameter as a Node even where it is a number, for its formula (``.formula``) or load curve (``.curve``).
    ``.type`` and ``.name`` are those of the file. What is set is checked at once: the name against FEBio's list, the
    value against FEBio's range.
    """

    __slots__ = ("_find", "_put", "_where")
    _find: Find
    _put: Put
    _where: str

    def __init__(self, find: Find, put: Put, where: str = "") -> None:
        object.__setattr__(self, "_find", find)
        object.__setattr__(self, "_put", put)
        object.__setattr__(self, "_where", where)

    @classmethod
    def of(cls, component: Component, where: str = "") -> Node:
        """A node on its own, not yet part of a model."""
        held = [component]

        def put(c: Component) -> None:
            held[0] = c

        return cls(lambda: held[0], put, where or component.type or component.tag)

    # ---- the record below -------------------------------------------------------------------------
    @property
    def component(self) -> Component:
        """The frozen record."""
        return self._find()

    @property
    def type(self) -> str | None:
        """FEBio's type name."""
        return self._find().type

    @property
    def name(self) -> str | None:
        """Its name in the model."""
        return self._find().name

    # ---- a parameter of its own -------------------------------------------------------------------
    @property
    def value(self) -> Value:
        """The text of this node as a number, a tuple of numbers or text; of a condition, that of its <value>."""
        c = self._find()
        if c.child("value") is not None:
            return self._child("value").value
        inner = c.child("math") or c.child("const") or c.child("map")
        return parsed((inner or c).text)

    @value.setter
    def value(self, v: Any) -> None:
        c = self._find()
        if "value" in schema.parameters(c) or c.child("value") is not None:
            self["value"] = v
        else:
            self._put(_leaf(c.tag, v, c))

    @property
    def formula(self) -> str | None:
        """The formula that gives this parameter, of X, Y, Z and t; None where it is a number or a map."""
        c = self._find()
        return (c.child("math") or c).text if c.type == "math" else None

    @formula.setter
    def formula(self, text: str) -> None:
        from febkit.model.math import compile as check

        c = self._find()
        check(text, None, {}, c.where)
        self._put(replace(c, type="math", text=text, children=()))

    @property
    def map(self) -> str | None:
        """The name of the map in mesh data that gives this parameter."""
        c = self._find()
        return (c.child("map") or c).text if c.type == "map" else None

    @map.setter
    def map(self, name: str) -> None:
        self._put(replace(self._find(), type="map", text=name, children=()))

    @property
    def curve(self) -> int | None:
        """Id of the load controller that multiplies this parameter: ``m.curves[id]``."""
        return self._find().lc

    @curve.setter
    def curve(self, controller: int | None) -> None:
        c = self._find()
        attrs = {k: v for k, v in c.attrs.items() if k != "lc"}
        self._put(replace(c, attrs=attrs if controller is None else attrs | {"lc": str(int(controller))}))

    # ---- parameters below -------------------------------------------------------------------------
    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        tag = self._tag(name)
        child = self._find().child(tag)
        if child is None:
            return schema.default(self._find(), tag)
        node = self._child(tag)
        own = child.children and child.type not in schema.VALUES
        return node if own or (child.type and child.type not in schema.VALUES) else node.value

    def __setattr__(self, name: str, value: Any) -> None:
        if name in ("value", "formula", "map", "curve"):
            object.__setattr__(self, name, value)
            return
        if name in ("type", "name"):
            raise AttributeError(f"the {name} of a {self._where} is fixed: put another one in its place")
        self[self._tag(name)] = value

    def __delattr__(self, name: str) -> None:
        del self[self._tag(name)]

    def __getitem__(self, tag: str) -> Node:
        """The parameter or property ``tag`` as a node. KeyError where the model does not give it."""
        tag = self._tag(tag)
        if self._find().child(tag) is None:
            raise KeyError(tag)
        return self._child(tag)

    def __setitem__(self, tag: str, value: Any) -> None:
        tag = self._tag(tag)
        c = self._find()
        new = self._made(c, tag, value)
        self._put(_with_child(c, tag, new))

    def __delitem__(self, tag: str) -> None:
        c = self._find()
        self._put(replace(c, children=tuple(x for x in c.children if x.tag != self._tag(tag))))

    def __contains__(self, tag: str) -> bool:
        return self._find().child(tag) is not None

    def __iter__(self) -> Iterator[str]:
        """Names of the parameters that the model gives."""
        return iter(dict.fromkeys(c.tag for c in self._find()))

    def __dir__(self) -> list[str]:
        known = schema.parameters(self._find()) | set(self)
        own = [n for n in vars(type(self)) if not n.startswith("_")]
        return sorted({*own, *(schema.attribute(t) for t in known)})

    def all(self, tag: str) -> list[Node]:
        """Every property of this name, for those that may come several times (``solid`` of a mixture)."""
        places = [k for k, c in enumerate(self._find().children) if c.tag == tag]
        return [self._at(k, tag) for k in places]

    def add(self, tag: str, value: Any) -> Node:
        """One more property of this name."""
        tag, c = self._tag(tag), self._find()
        self._put(replace(c, children=(*c.children, self._made(c, tag, value))))
        return self._at(len(c.children), tag)

    # ---- inner ------------------------------------------------------------------------------------
    def _tag(self, name: str) -> str:
        """FEBio's tag of an attribute. AttributeError that says what there is."""
        c = self._find()
        known = schema.parameters(c) | {x.tag for x in c}
        tag = schema.tag(name, known)
        if tag is not None:
            return tag
        if not known:
            return name
        from difflib import get_close_matches

        close = get_close_matches(name, known, 1, 0.6)
        hint = f"; did you mean {close[0]}?" if close else f"; there are {listed(sorted(known))}"
        raise AttributeError(f"a {self._where} has no parameter {name!r}{hint}")

    def _child(self, tag: str) -> Node:
        def find() -> Component:
            c = self._find().child(tag)
            if c is None:
                raise AttributeError(f"{tag} of {self._where} is gone")
            return c

        return Node(find, lambda new: self._put(_with_child(self._find(), tag, new)), f"{self._where}.{tag}")

    def _at(self, place: int, tag: str) -> Node:
        def put(new: Component) -> None:
            c = self._find()
            self._put(replace(c, children=(*c.children[:place], new, *c.children[place + 1 :])))

        return Node(lambda: self._find().children[place], put, f"{self._where}.{tag}")

    def _made(self, c: Component, tag: str, value: Any) -> Component:
        if isinstance(value, Node):
            value = value.component
        if isinstance(value, Component):
            return replace(value, tag=tag, id=None, name=None)
        self._checked(c, tag, value)
        formula = isinstance(value, str) and schema.is_numeric(c, tag) and not is_text_number(value)
        if formula:
            node = Node.of(Component(tag), f"{self._where}.{tag}")
            node.formula = value
            return node.component
        return _leaf(tag, value, c.child(tag))

    def _checked(self, c: Component, tag: str, value: Any) -> None:
        given = parsed(value) if isinstance(value, str) else value
        if is_number(given) or is_numbers(given):
            for v in map(float, np.ravel(given)):
                must = schema.out_of_range(c, tag, v)
                if must:
                    raise InputError(f"{self._where}.{tag} must be {must}, not {v:g}")
        elif isinstance(value, str):
            choices = schema.choices(c, tag)
            if choices and value not in choices:
                raise InputError(f"{self._where}.{tag} = {value!r}: choose from {listed(choices)}")

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Node) and same(self.component, other.component)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return "\n".join(lines(self._find()))

    def _repr_html_(self) -> str:
        from html import escape

        return f"<pre>{escape(repr(self))}</pre>"


def is_text_number(text: str) -> bool:
    return is_number(parsed(text))


def _leaf(tag: str, value: Any, old: Component | None) -> Component:
    """A parameter with this value; it keeps the old one's load curve and attributes."""
    text = written(value)
    if old is None:
        return Component(tag, text=text)
    return replace(old, type=None if old.type in schema.VALUES else old.type, text=text, children=())


def _with_child(c: Component, tag: str, new: Component) -> Component:
    """The component with its last child of this tag exchanged, or one more."""
    places = [k for k, x in enumerate(c.children) if x.tag == tag]
    if not places:
        return replace(c, children=(*c.children, new))
    at = places[-1]
    return replace(c, children=(*c.children[:at], new, *c.children[at + 1 :]))


def same(a: Component, b: Component) -> bool:
    """Equal, wherever they were read."""
    mine = (a.tag, a.type, a.text.strip(), dict(a.attrs), len(a.children))
    return mine == (b.tag, b.type, b.text.strip(), dict(b.attrs), len(b.children)) and all(
        same(x, y) for x, y in zip(a.children, b.children)
    )


def lines(c: Component, indent: str = "") -> Iterator[str]:
    """A component in words, a line each parameter."""
    head = [c.name and f'"{c.name}"', c.type, *(f"{k} {v}" for k, v in c.attrs.items())]
    said = " ".join(str(h) for h in head if h)
    text = c.text if len(c.text) <= 60 else c.text[:57] + "..."
    yield f"{indent}{c.tag}{' ' + said if said else ''}{' = ' + text if text else ''}"
    for child in c.children[:40]:
        yield from lines(child, indent + "  ")
    if len(c.children) > 40:
        yield f"{indent}  and {len(c.children) - 40} more"
