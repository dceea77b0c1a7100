"""What is fitted: parameters with bounds, on a linear or a logarithmic scale, and values tied to them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from febkit.model import InputError

if TYPE_CHECKING:
    from febkit.model.math import Formula

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Parameter:
    """A number between ``low`` and ``high``, at first ``start``.

    log: fitted by its logarithm; paths: where it goes in the models, its name where none are given; scale: its typical
    size, for steps of differences (its start, or the width of its bounds where that is 0).
    """

    low: float
    start: float
    high: float
    log: bool = False
    paths: tuple[str, ...] = ()
    scale: float = 0.0
    name: str = ""
    owner: str = ""  # the experiment that alone has it

    @property
    def size(self) -> float:
        """Of the unit in which it is counted."""
        return abs(self.scale) or abs(self.start) or self.high - self.low

    def inner(self, value: float) -> float:
        """The value as the optimiser counts it: in typical sizes, or its logarithm."""
        return math.log(value) if self.log else value / self.size

    def outer(self, z: float) -> float:
        """The value that the optimiser's number means, within the bounds."""
        v = math.exp(z) if self.log else z * self.size
        return min(max(v, self.low), self.high)

    def slope(self, value: float) -> float:
        """d(value)/d(inner)."""
        return value if self.log else self.size


Spec = Parameter | Sequence[float] | str


@dataclass(frozen=True, slots=True)
class Tie:
    """Paths that a formula of parameters gives."""

    formula: Formula
    paths: tuple[str, ...]
    owner: str = ""


class Parameters:
    """The parameters of a fit in their order, and what is tied to them."""

    def __init__(self, every: Sequence[Parameter], ties: Sequence[Tie] = ()) -> None:
        self.every, self.ties = tuple(every), tuple(ties)
        self.names = [p.name for p in self.every]
        if not self.every:
            raise InputError("a fit needs parameters: {path: (low, start, high)}")
        for p in self.every:
            _check(p)
        for t in self.ties:
            for name in t.formula.names - set(self.names):
                raise InputError(f"{t.paths[0]} = {t.formula.text}: {name} is no parameter; there are "
                                 f"{', '.join(self.names)}")  # fmt: skip
        self.low = np.array([p.inner(p.low) for p in self.every])
        self.high = np.array([p.inner(p.high) for p in self.every])
        self.start = np.array([p.inner(p.start) for p in self.every])

    def __len__(self) -> int:
        return len(self.every)

    def values(self, z: Floats) -> Floats:
        """The parameters' values where the optimiser is at z."""
        return np.array([p.outer(float(v)) for p, v in zip(self.every, z)])

    def slopes(self, values: Floats) -> Floats:
        """d(value)/d(z)."""
        return np.array([p.slope(float(v)) for p, v in zip(self.every, values)])

    def settings(self, values: Floats, owner: str) -> dict[str, float]:
        """Value of each path of an experiment's model."""
        named = dict(zip(self.names, map(float, values)))
        out = {path: named[p.name] for p in self.every if p.owner in ("", owner) for path in p.paths}
        for t in self.ties:
            if t.owner in ("", owner):
                out |= dict.fromkeys(t.paths, float(t.formula.at(named)))
        return out

    def slopes_of(self, values: Floats, owner: str) -> dict[str, Floats]:
        """(n,) d(path)/d(z) of each path of an experiment's model; of formulas by central differences."""
        slopes, at = self.slopes(values), np.eye(len(values))
        out = {path: slopes * at[k] for k, p in enumerate(self.every) if p.owner in ("", owner) for path in p.paths}
        for t in self.ties:
            if t.owner in ("", owner):
                h = 1e-6 * np.array([p.size for p in self.every])
                both = [[float(t.formula.at(dict(zip(self.names, values + s * h[k] * at[k])))) for s in (1, -1)]
                        for k in range(len(values))]  # fmt: skip
                out |= dict.fromkeys(t.paths, slopes * (np.array(both) @ [1.0, -1.0]) / (2.0 * h))
        return out

    def concern(self, owner: str) -> list[bool]:
        """Which parameters an experiment has."""
        return [p.owner in ("", owner) for p in self.every]


def read(given: Mapping[Any, Spec], own: Mapping[str, Mapping[Any, Spec]] | None = None) -> Parameters:
    """Parameters of a mapping from paths (one, or several that share a value) to (low, start, high), to a
    :class:`Parameter`, or to a formula of other parameters; ``own``: those of single experiments, by their names."""
    every: list[Parameter] = []
    ties: list[Tie] = []
    for owner, specs in {"": given, **(own or {})}.items():
        for key, spec in specs.items():
            paths = (key,) if isinstance(key, str) else tuple(map(str, key))
            if isinstance(spec, str):
                ties.append(_tie(spec, paths, owner, specs))
            else:
                every.append(_parameter(spec, paths, owner))
    return Parameters(every, ties)


def _parameter(spec: Any, paths: tuple[str, ...], owner: str) -> Parameter:
    if not isinstance(spec, Parameter):
        try:
            low, start, high = map(float, spec)
        except (TypeError, ValueError):
            raise InputError(f"{paths[0]}: (low, start, high) is wanted, not {spec!r}") from None
        spec = Parameter(low, start, high)
    name = f"{owner}: {paths[0]}" if owner else paths[0]
    out: Parameter = replace(spec, name=spec.name or name, paths=tuple(spec.paths) or paths, owner=owner)
    return out


def _tie(text: str, paths: tuple[str, ...], owner: str, beside: Mapping[Any, Spec]) -> Tie:
    """A formula; what it calls by a name of its own experiment is that experiment's parameter."""
    from febkit.model import math as formulas

    f = formulas.compile(text, None, {})
    if owner and f.names & beside.keys():
        raise InputError(f"{paths[0]} = {text}: tie parameters of one experiment by giving both paths to one of them")
    return Tie(f, paths, owner)


def _check(p: Parameter) -> None:
    numbers = (p.low, p.start, p.high)
    if not all(map(math.isfinite, numbers)) or not p.low <= p.start <= p.high or p.low == p.high:
        raise InputError(f"{p.name}: low <= start <= high is wanted, not {', '.join(f'{v:g}' for v in numbers)}")
    if p.log and p.low <= 0:
        raise InputError(f"{p.name}: a logarithmic scale needs bounds above 0, not {p.low:g}")
