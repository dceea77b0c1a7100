"""One node of a parameter tree: a material, a boundary condition, a load, or one parameter of these."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from .source import InputError, Where


@dataclass(frozen=True, slots=True)
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
            raise InputError(f'<{self.tag}{self._label()}> lacks <{tag}>', self.where)
        return c

    def _label(self) -> str:
        return f' type="{self.type}"' if self.type else ""

    @property
    def lc(self) -> int | None:
        """Id of the load controller that multiplies this value, if any (1-based, as in the file)."""
        v = self.attrs.get("lc")
        return int(v) if v not in (None, "") else None

    # typed values of this node's own text
    def as_float(self) -> float:
        try:
            return float(self.text)
        except ValueError:
            raise InputError(f"<{self.tag}> must be a number, not {self.text!r}", self.where) from None

    def as_floats(self, n: int | None = None) -> tuple[float, ...]:
        try:
            v = tuple(float(x) for x in self.text.replace(",", " ").split())
        except ValueError:
            raise InputError(f"<{self.tag}> must be numbers, not {self.text!r}", self.where) from None
        if n is not None and len(v) != n:
            raise InputError(f"<{self.tag}> must be {n} numbers, not {len(v)}", self.where)
        return v

    def as_int(self) -> int:
        v = self.as_float()
        if v != int(v):
            raise InputError(f"<{self.tag}> must be an integer, not {self.text!r}", self.where)
        return int(v)

    def as_bool(self) -> bool:
        t = self.text.strip().lower()
        if t in ("1", "true", "yes", "on"):
            return True
        if t in ("0", "false", "no", "off", ""):
            return False
        return self.as_float() != 0.0

    # typed values of a child, with defaults
    def float(self, tag: str, default: float | None = None) -> float:
        c = self.child(tag)
        if c is None:
            if default is None:
                self.need(tag)
            return default  # type: ignore[return-value]
        return c.as_float()

    def int(self, tag: str, default: int | None = None) -> int:  # type: ignore[valid-type]
        c = self.child(tag)
        if c is None:
            if default is None:
                self.need(tag)
            return default  # type: ignore[return-value]
        return c.as_int()

    def bool(self, tag: str, default: bool = False) -> bool:  # type: ignore[valid-type]
        c = self.child(tag)
        return default if c is None else c.as_bool()

    def str(self, tag: str, default: str = "") -> str:  # type: ignore[valid-type]
        c = self.child(tag)
        return default if c is None else c.text.strip()
