"""Numbers of a model that may vary in time and space.

A value is evaluated at time ``t`` for ``n`` places: reference positions ``X`` (n, 3) and, for element
maps, element indices ``e`` (n,) into the block at hand. It returns an array of shape (1,) where it does
not vary in space, else (n,). Values know nothing of files: the caller hands in controllers as callables.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import field
from typing import TYPE_CHECKING, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from .record import variable_record

if TYPE_CHECKING:
    from .elements.base import Element

Floats = NDArray[np.float64]


@runtime_checkable
class Value(Protocol):
    @property
    def constant(self) -> bool:
        """True where neither time nor place matters."""
        ...

    @property
    def steady(self) -> bool:
        """True where time does not matter."""
        ...

    def __call__(self, t: float, X: Floats, e: NDArray[np.int64] | None = None) -> Floats: ...


@variable_record
class Constant:
    """One number."""

    number: float
    constant: bool = True
    steady: bool = True

    def __call__(self, t: float, X: Floats, e: NDArray[np.int64] | None = None) -> Floats:
        return np.array([self.number])


@variable_record
class Scaled:
    """``base * controller(t)``: a parameter with a load curve."""

    base: Value
    controller: Callable[[float], float]
    constant: bool = False
    steady: bool = False

    def __call__(self, t: float, X: Floats, e: NDArray[np.int64] | None = None) -> Floats:
        return self.base(t, X, e) * self.controller(t)


@variable_record
class Expression:
    """``f(X, Y, Z, t)`` of numpy arrays, compiled by the caller from a checked formula."""

    function: Callable[[Floats, Floats, Floats, float], Floats | float]
    steady: bool = False
    constant: bool = False

    def __call__(self, t: float, X: Floats, e: NDArray[np.int64] | None = None) -> Floats:
        v = self.function(X[:, 0], X[:, 1], X[:, 2], t)
        return np.atleast_1d(np.asarray(v, dtype=float))


@variable_record
class Composed:
    """``f(X, Y, Z, t, **parts)``: a formula of other values, such as maps and parameters, by name."""

    function: Callable[..., Floats | float]
    parts: Mapping[str, Value]
    steady: bool = False
    constant: bool = False

    def __call__(self, t: float, X: Floats, e: NDArray[np.int64] | None = None) -> Floats:
        parts = {name: v(t, X, e) for name, v in self.parts.items()}
        return np.atleast_1d(np.asarray(self.function(X[:, 0], X[:, 1], X[:, 2], t, **parts), dtype=float))


@variable_record
class Map:
    """One number for each element of a block (or each item of the set the value lives on)."""

    data: Floats
    constant: bool = False
    steady: bool = True

    def __call__(self, t: float, X: Floats, e: NDArray[np.int64] | None = None) -> Floats:
        return self.data if e is None else self.data[e]


@variable_record
class Within:
    """A field by values at the nodes of a block's elements, ``data`` (m, n); the nodes are at ``nodes`` (m, n, 3)."""

    element: Element
    nodes: Floats
    data: Floats
    constant: bool = False
    steady: bool = True
    known: dict[tuple[int, bytes, bytes], Floats] = field(default_factory=dict, init=False, repr=False)

    def __call__(self, t: float, X: Floats, e: NDArray[np.int64] | None = None) -> Floats:
        if e is None:
            raise ValueError("a field within elements has values at points of elements alone")
        places = len(X), X[:1].tobytes(), X[-1:].tobytes()  # of a chunk, which asks at each iteration
        if places not in self.known:
            self.known[places] = (self.element.shape(self.natural(X, e)) * self.data[e]).sum(axis=1)
        return self.known[places]

    def natural(self, X: Floats, e: NDArray[np.int64]) -> Floats:
        """Natural coordinates (p, dim) of places X in elements e, by Newton's method."""
        corners, r = self.nodes[e], np.tile(self.element.center.astype(float), (len(X), 1))
        for _ in range(20):
            off = X - np.einsum("pn,pni->pi", self.element.shape(r), corners)
            slope = np.einsum("pna,pni->pia", self.element.gradient(r), corners)
            step = np.linalg.solve(slope, off[..., None])[..., 0]
            r += step
            if not len(r) or np.abs(step).max() < 1e-12:
                break
        return r


def as_value(v: float | int | Value) -> Value:
    return Constant(float(v)) if isinstance(v, (int, float, np.floating, np.integer)) else v
