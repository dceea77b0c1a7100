"""Records whose classes cost nothing to make.

:func:`dataclasses.dataclass` writes and compiles the source of up to seven methods for each class: 0.3 ms at every
start of Python, 0.6 where it is frozen. The eighty records of any run were a tenth of a small one. Here all share their
methods. ``fields`` and ``replace`` of :mod:`dataclasses` take them. An instance takes some 3 us to make: what is made
in every iteration is a dataclass.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import MISSING, FrozenInstanceError, dataclass, field, fields
from typing import Any, TypeVar, dataclass_transform

T = TypeVar("T")
_put = object.__setattr__


@dataclass_transform(frozen_default=True, eq_default=False, field_specifiers=(field,))
def record(cls: type[T]) -> type[T]:
    """A frozen class of the fields that ``cls`` lists, in slots; equal to itself alone, as records of arrays are."""
    return _made(cls, True, _FROZEN)


@dataclass_transform(frozen_default=True, eq_default=True, field_specifiers=(field,))
def value_record(cls: type[T]) -> type[T]:
    """A record that is equal to any of its class with equal fields, and has their hash."""
    return _made(cls, True, (*_FROZEN, __eq__, __hash__))


@dataclass_transform(eq_default=False, field_specifiers=(field,))
def variable_record(cls: type[T]) -> type[T]:
    """A class of the fields that ``cls`` lists, which may change; equal to itself alone."""
    return _made(cls, False, (__init__, __repr__))


def _made(cls: type[T], slots: bool, methods: tuple[Callable[..., Any], ...]) -> type[T]:
    cls.__doc__ = cls.__doc__ or cls.__name__  # else dataclass reads and parses the signature for one
    made: Any = dataclass(init=False, repr=False, eq=False, slots=slots)(cls)
    for method in methods:
        setattr(made, method.__name__, method)
    made._slotted = slots
    made._fields = {f.name: f for f in fields(made)}
    return made  # type: ignore[no-any-return]


def __init__(self: Any, *args: Any, **given: Any) -> None:
    listed = self._fields
    if args:
        names = [n for n, f in listed.items() if f.init and not f.kw_only]
        if len(args) > len(names):
            raise TypeError(f"{type(self).__name__} has {len(names)} fields, not {len(args)}")
        first = dict(zip(names, args))
        if not given.keys().isdisjoint(first):
            raise TypeError(f"{type(self).__name__} got {', '.join(given.keys() & first)} twice")
        given = first | given
    for name, f in listed.items():
        if name in given and f.init:
            _put(self, name, given.pop(name))
        elif f.default is not MISSING:
            if f.init or self._slotted:  # else it is the class's, or what a later one has in its place
                _put(self, name, f.default)
        elif f.default_factory is not MISSING:
            _put(self, name, f.default_factory())
        elif f.init:
            raise TypeError(f"{type(self).__name__} lacks {name}")
    if given:
        raise TypeError(f"{type(self).__name__} has no {', '.join(given)}")
    more = getattr(self, "__post_init__", None)  # as dataclasses have it
    if more is not None:
        more()


def __setattr__(self: Any, name: str, value: Any) -> None:
    raise FrozenInstanceError(f"{name} of a {type(self).__name__} does not change; replace() makes another")


def __delattr__(self: Any, name: str) -> None:
    __setattr__(self, name, None)


def __repr__(self: Any) -> str:
    shown = (f"{n}={getattr(self, n)!r}" for n, f in self._fields.items() if f.repr)
    return f"{type(self).__qualname__}({', '.join(shown)})"


def __getstate__(self: Any) -> tuple[Any, ...]:
    return tuple(getattr(self, n) for n in self._fields)


def __setstate__(self: Any, state: tuple[Any, ...]) -> None:
    for name, held in zip(self._fields, state, strict=True):
        _put(self, name, held)


def __eq__(self: Any, other: object) -> bool:
    if type(other) is not type(self):
        return NotImplemented
    return bool(__getstate__(self) == __getstate__(other))


def __hash__(self: Any) -> int:
    return hash(__getstate__(self))


_FROZEN: tuple[Callable[..., Any], ...] = (__init__, __setattr__, __delattr__, __repr__, __getstate__, __setstate__)
