"""Formulas, load curves and functions of time, as a file gives them."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from febkit.model import Component, InputError, Where

if TYPE_CHECKING:
    from febkit.model.math import Formula
    from febkit.solver.controllers import LoadCurve

Controller = Callable[[float], float]
EXTENSIONS = {"zero": "zero", "constant": "constant", "repeat": "repeat", "0": "zero", "1": "constant", "2": "repeat"}


def compiled(text: str, names: Iterable[str] | None, constants: Mapping[str, float], where: Where) -> Formula:
    """:func:`febkit.model.math.compile`, imported where a model has a formula."""
    from febkit.model import math as formulas

    return formulas.compile(text, names, constants, where)


def load_curve(points: Sequence[Sequence[float]], spec: Component, what: str) -> LoadCurve:
    """The curve through ``points``, between and outside of which it goes as ``spec`` says."""
    from febkit.solver.controllers import LoadCurve

    interpolate, extend = spec.str("interpolate") or "LINEAR", spec.str("extend") or "CONSTANT"
    if not points:
        raise InputError(f"{what} has no points", spec.where)
    try:
        return LoadCurve(np.array(points, dtype=float), interpolate, extend)
    except ValueError as e:
        raise InputError(f"{what}: {e}", spec.where) from None


def interval(spec: Component, f: Controller) -> Controller:
    """A function of time within an interval, that is zero, constant or repeats before and after it."""
    leaf = spec.child("interval")
    start, end = (0.0, 1.0) if leaf is None else leaf.as_floats(2)
    if not end > start:
        raise InputError(f"<interval> must grow, not {start:g},{end:g}", spec.where if leaf is None else leaf.where)
    left, right = (spec.choice(f"{side}_extend", EXTENSIONS, "constant") for side in ("left", "right"))

    def value(t: float) -> float:
        before, after = t <= start, t >= end
        how = left if before else right if after else ""
        if how == "zero":
            return 0.0
        if how == "constant":
            t = start if before else end
        elif how == "repeat":
            t = end - math.fmod(start - t, end - start) if before else start + math.fmod(t - start, end - start)
        return f(t)

    return value
