"""Functions of one variable."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from febkit.model import Component, InputError

from .functions import compiled, load_curve

if TYPE_CHECKING:
    from .context import Context


class Curve:
    """A load curve as a function of arrays; its points stay at hand."""

    def __init__(self, curve: Any) -> None:
        self.curve, self.points = curve, curve.points

    def __call__(self, x: Any) -> Any:
        return np.vectorize(self.curve, otypes=[float])(x)  # also of no numbers


def curve(ctx: Context, c: Component) -> Any:
    """A function of one variable: constant, linear ramp, step, points or formula."""
    kind = c.type or "const"
    if kind == "point":
        return Curve(load_curve([p.as_floats(2) for p in c.need("points")], c, c.what))
    if kind == "math":
        return of_one(ctx, c)
    if kind == "const":
        v = (c.child("value") or c).as_float()
        return lambda x: np.full(np.shape(x), v)
    if kind in ("linear ramp", "linear"):
        slope, start = c.float("slope", 0.0), c.float("intercept", 0.0)
        return lambda x: slope * np.asarray(x) + start
    if kind == "scale":
        factor = c.float("scale", 1.0)
        return lambda x: factor * np.asarray(x)
    if kind == "step":
        x0, left, right = c.float("x0", 0.0), c.float("left_val", 0.0), c.float("right_val", 1.0)
        return lambda x: np.where(np.asarray(x) < x0, left, right)
    ctx.refuse(f'<{c.tag} type="{kind}">', c.where)
    return None


def of_one(ctx: Context, c: Component) -> Any:
    """A formula of one variable, whatever its name."""
    f = compiled((c.child("math") or c).text, None, ctx.variables, c.where)
    if len(f.names) > 1:
        raise InputError(f"<{c.tag}> must be a formula of one variable, not of {', '.join(sorted(f.names))}", c.where)
    name = next(iter(f.names), "x")
    return lambda x: f.at({name: x})


class Function:
    """A function of one variable with its slope, by central differences (exact where it is piecewise linear)."""

    def __init__(self, f: Any) -> None:
        self.f = f

    def value(self, x: Any) -> Any:
        return np.broadcast_to(np.asarray(self.f(x), dtype=float), np.shape(x))

    def slope(self, x: Any) -> Any:
        h = 1e-6 * (1.0 + np.abs(x))
        return (self.value(x + h) - self.value(x - h)) / (2.0 * h)
