"""One node of a parameter tree: a material, a boundary condition, a load, or one parameter of these."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import field
from typing import TypeVar

from febkit.record import value_record

from . import values
from .source import InputError, Where

T = TypeVar("T")


@value_record
class Component:
    """A tagged, possibly typed node; a leaf holds the text of one parameter.

    ``<bc type="prescribed displacement" node_set="top"><dof>z</dof><value lc="1">-0.1</value></bc>``
    becomes ``tag='bc', type='prescribed displacement', attrs={'node_set': 'top'}`` with two leaves.
    """

    tag: str
    type: str | None = None
    name: str | None = None
    id: int | None = None
    text: str = ""
    attrs: Mapping[str, str] = field(default_factory=dict)
    children: tuple[Component, ...] = ()
    where: Where = field(default_factory=Where)

    def __iter__(self) -> Iterator[Component]:
        return iter(self.children)

    def child(self, tag: str) -> Component | None:
        """The last child of this tag (FEBio keeps the last value of a repeated parameter)."""
        for c in reversed(self.children):
            if c.tag == tag:
                return c
        return None

    def all(self, tag: str) -> tuple[Component, ...]:
        return tuple(c for c in self.children if c.tag == tag)

    def need(self, tag: str) -> Component:
        c = self.child(tag)
        if c is None:
            raise InputError(f"{self.what} lacks <{tag}>", self.where)
        return c

    def _label(self) -> str:
        return f' type="{self.type}"' if self.type else ""

    @property
    def what(self) -> str:
        """How messages name this node."""
        return f"<{self.tag}{self._label()}>"

    @property
    def lc(self) -> int | None:
        """Id of the load controller that multiplies this value, if any (1-based, as in the file)."""
        v = self.attrs.get("lc")
        return None if v is None or not v.strip() else values.label(v, f'lc="{v}" of <{self.tag}>', self.where)

    # typed values of this node's own text; how they are spelt stands in ``values``
    def as_float(self) -> float:
        return values.number(self.text, f"<{self.tag}>", self.where)

    def as_floats(self, n: int | None = None) -> tuple[float, ...]:
        return values.numbers(self.text, n, f"<{self.tag}>", self.where)

    def as_int(self, least: int = -values.LARGEST) -> int:
        return values.integer(self.text, f"<{self.tag}>", self.where, least)

    def as_bool(self) -> bool:
        return values.flag(self.text, f"<{self.tag}>", self.where)

    def as_choice(self, names: Mapping[str, T]) -> T:
        """What the text stands for in a table of lower-case names."""
        return values.choice(self.text, names, f"<{self.tag}>", self.where)

    def as_id(self) -> int:
        return values.label(self.text, f"<{self.tag}>", self.where)

    # typed values of a child, with defaults
    def float(self, tag: str, default: float | None = None) -> float:
        c = self.need(tag) if default is None else self.child(tag)
        return default if c is None else c.as_float()  # type: ignore[return-value]

    def int(  # type: ignore[valid-type]
        self, tag: str, default: int | None = None, least: int = -values.LARGEST
    ) -> int:
        c = self.need(tag) if default is None else self.child(tag)
        return default if c is None else c.as_int(least)  # type: ignore[return-value]

    def bool(self, tag: str, default: bool = False) -> bool:  # type: ignore[valid-type]
        c = self.child(tag)
        return default if c is None else c.as_bool()

    def choice(self, tag: str, names: Mapping[str, T], default: T) -> T:
        c = self.child(tag)
        return default if c is None or not c.text.strip() else c.as_choice(names)

    def str(self, tag: str, default: str = "") -> str:  # type: ignore[valid-type]
        c = self.child(tag)
        return default if c is None else c.text.strip()
