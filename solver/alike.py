"""Are two records the same in all that they were made of? Where that cannot be told they are not."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from types import FunctionType
from typing import Any

import numpy as np


def alike(a: Any, b: Any) -> bool:
    """Laws, values, curves, arrays and functions by their content, numbers to the last bit."""
    return _alike(a, b, set())


def _alike(a: Any, b: Any, met: set[tuple[int, int]]) -> bool:
    if a is b or (id(a), id(b)) in met:
        return True
    if type(a) is not type(b):
        return False
    met.add((id(a), id(b)))
    if isinstance(a, np.ndarray):
        return a.dtype == b.dtype and np.array_equal(a, b)
    if isinstance(a, (int, float, str, bytes, np.generic)):
        return bool(a == b)
    if isinstance(a, (tuple, list)):
        return len(a) == len(b) and all(_alike(x, y, met) for x, y in zip(a, b))
    if isinstance(a, dict):
        return a.keys() == b.keys() and all(_alike(v, b[k], met) for k, v in a.items())
    if isinstance(a, FunctionType):
        return a.__code__ == b.__code__ and _alike(_held(a), _held(b), met)
    if is_dataclass(a):
        return all(_alike(getattr(a, f.name), getattr(b, f.name), met) for f in fields(a) if f.init)
    return False


def _held(f: FunctionType) -> tuple[Any, ...]:
    """What a function holds beside its code; names of modules mean the same to both."""
    return f.__defaults__, f.__kwdefaults__, tuple(c.cell_contents for c in f.__closure__ or ()), f.__module__
