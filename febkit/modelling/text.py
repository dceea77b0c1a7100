"""Python values as the text of a parameter, and back."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from febkit.feb.tree import number
from febkit.model.values import spells_number

Value = float | int | bool | str | tuple[float, ...]


def is_number(v: Any) -> bool:
    return isinstance(v, (int, float, np.integer, np.floating)) and not isinstance(v, (bool, np.bool_))


def is_numbers(v: Any) -> bool:
    """A list, tuple or array of numbers."""
    return isinstance(v, (list, tuple, np.ndarray)) and len(v) > 0 and all(is_number(x) for x in np.ravel(v))


def written(v: Any) -> str:
    """A number, truth, text or list of numbers as .feb files have it. Raises TypeError for anything else."""
    if isinstance(v, (bool, np.bool_)):
        return "1" if v else "0"
    if is_number(v):
        return number(v)
    if isinstance(v, str):
        return v
    if is_numbers(v):
        return ",".join(number(x) for x in np.ravel(v))
    raise TypeError(f"a parameter is a number, a list of numbers or text, not {type(v).__name__}")


def parsed(text: str) -> Value:
    """What a parameter's text says: a number, a tuple of numbers, or the text itself."""
    words = text.replace(",", " ").split()
    if not words or not all(map(spells_number, words)):
        return text.strip()
    values = tuple(map(float, words))
    return values[0] if len(values) == 1 else values


def listed(names: Iterable[Any]) -> str:
    """Names in a sentence."""
    return ", ".join(str(n) for n in names)
