"""Frozen records whose classes cost nothing to make.

:func:`dataclasses.dataclass` writes and compiles the source of up to seven methods for each frozen class, half a
millisecond at every start of Python, where numpy takes 40: the model's and the plotfile's thirty records were a tenth
of a small run. Here all records share their methods. ``fields`` and ``replace`` of :mod:`dataclasses` take them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import MISSING, FrozenInstanceError, dataclass, field
from typing import Any, TypeVar, dataclass_transform

T = TypeVar("T")
_put = object.__setattr__


@dataclass_transform(frozen_default=True, eq_default=False, field_specifiers=(field,))
def record(cls: type[T]) -> type[T]:
    """A frozen class of the fields that ``cls`` lists, in slots; equal to itself alone, as records of arrays are."""
    made: Any = dataclass(init=False, repr=False, eq=False, slots=True)(cls)
    for method in _SHARED:
        setattr(made, method.__name__, method)
    return made  # type: ignore[no-any-return]


@dataclass_transform(frozen_default=True, eq_default=True, field_specifiers=(field,))
def value_record(cls: type[T]) -> type[T]:
    """A record that is equal to any of its class with equal fields, and has their hash."""
    made: Any = record(cls)
    made.__eq__, made.__hash__ = __eq__, __hash__
    return made  # type: ignore[no-any-return]


def __init__(self: Any, *args: Any, **given: Any) -> None:
    listed = self.__dataclass_fields__
    if args:
        if len(args) > len(listed):
            raise TypeError(f"{type(self).__name__} has {len(listed)} fields, not {len(args)}")
        first = dict(zip(listed, args))
        if not given.keys().isdisjoint(first):
            raise TypeError(f"{type(self).__name__} got {', '.join(given.keys() & first)} twice")
        given = first | given
    for name, f in listed.items():
        if name in given:
            _put(self, name, given.pop(name))
        elif f.default is not MISSING:
            _put(self, name, f.default)
        elif f.default_factory is not MISSING:
            _put(self, name, f.default_factory())
        else:
            raise TypeError(f"{type(self).__name__} lacks {name}")
    if given:
        raise TypeError(f"{type(self).__name__} has no {', '.join(given)}")


def __setattr__(self: Any, name: str, value: Any) -> None:
    raise FrozenInstanceError(f"{name} of a {type(self).__name__} does not change; replace() makes another")


def __delattr__(self: Any, name: str) -> None:
    __setattr__(self, name, None)


def __repr__(self: Any) -> str:
    shown = (f"{n}={getattr(self, n)!r}" for n, f in self.__dataclass_fields__.items() if f.repr)
    return f"{type(self).__qualname__}({', '.join(shown)})"


def __getstate__(self: Any) -> tuple[Any, ...]:
    return tuple(getattr(self, n) for n in self.__dataclass_fields__)


def __setstate__(self: Any, state: tuple[Any, ...]) -> None:
    for name, held in zip(self.__dataclass_fields__, state, strict=True):
        _put(self, name, held)


def __eq__(self: Any, other: object) -> bool:
    if type(other) is not type(self):
        return NotImplemented
    return bool(__getstate__(self) == __getstate__(other))


def __hash__(self: Any) -> int:
    return hash(__getstate__(self))


_SHARED: tuple[Callable[..., Any], ...] = (__init__, __setattr__, __delattr__, __repr__, __getstate__, __setstate__)
