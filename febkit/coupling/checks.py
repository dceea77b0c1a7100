"""Is a hand-off sound? detF, the sign of the mapped volume, sizes, and what the series leaves out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from febkit import units

from . import errors
from .derivatives import COUNT, TERMS, evaluate, gradient, monomials
from .histories import Handoff
from .taylor import ELEMENT_NOTE, coefficients, orders

if TYPE_CHECKING:
    import xarray as xr

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Checks:
    """Findings about one hand-off; ``problems`` are those that make a cell model fail or mean little."""

    det_F: tuple[float, float] | None  # smallest, largest over time at the point
    det_map: tuple[float, float] | None  # the same of dx/dX over all surface nodes and times
    inverted_at: float | None  # first time at which the map turns inside out
    size_ratio: float | None  # longest edge of the cell model's box / edge of the tissue's element
    remainder_u: float | None  # estimated largest error of u on the surface / largest |u| there
    remainder_p: float | None  # the same of p, by the largest |p|
    remainder_c: float | None  # the same of the concentrations: the worst solute
    lines: tuple[str, ...]
    problems: tuple[str, ...]


def check(given: Handoff, driving: xr.Dataset | None = None, point: int = 0) -> Checks:
    """Checks of a hand-off; ``driving`` (as given to handoff()) allows the remainder estimate.

    The remainder is the largest value on the surface of the first order left out, where the driving data
    hold it; for order 3 the last term times the ratio of the last two. It is an estimate, not a bound.
    """
    det_F = det_map = at = None
    problems: list[str] = []
    lines: list[str] = [f"hand-off: {given.text}; {len(given.times)} times {given.times[0]:g} to "
                        f"{given.times[-1]:g}; {len(given.X)} surface nodes"]
    if given.motion is not None:
        det_F, det_map, at = _volumes(given)
        lines.append(f"detF at the point: {det_F[0]:.4g} to {det_F[1]:.4g}")
        lines.append(f"det dx/dX over the surface: {det_map[0]:.4g} to {det_map[1]:.4g}")
        if at is not None:
            problems.append(f"the mapped volume turns inside out at t = {at:g}: take a lower order, a "
                            "smaller cell model, a finer tissue, or (at a surface whose layer the tissue "
                            "does not resolve) the element's own derivatives")
    ratio = _size_ratio(given, driving, point)
    if ratio is not None:
        lines.append(f"cell model / tissue element: {ratio:.3g}")
        if ratio > 2:
            problems.append(f"the cell model is {ratio:.2g} times as large as the tissue's element: "
                            "overlay may suit better")
    rest_u, rest_p, rest_c = remainder(given, driving, point)
    if rest_u is not None:
        lines.append(f"order left out, displacement: {100 * rest_u:.3g} % of the largest on the surface")
    if rest_p is not None:
        lines.append(f"order left out, pressure: {100 * rest_p:.3g} % of the largest on the surface")
    if rest_c is not None:
        lines.append(f"order left out, concentrations: {100 * rest_c:.3g} % of the largest on the surface")
    if given.c is not None and float(np.min(given.c)) < 0.0:
        problems.append("a concentration turns negative on the surface: take a lower solute order, or a smaller cell "
                        "model")
    lines += _about_error(given, driving, point)
    lines += _about_recovery(given, driving, point)
    return Checks(det_F, det_map, at, ratio, rest_u, rest_p, rest_c, tuple(lines), tuple(problems))


def error_of(given: Handoff, driving: xr.Dataset, point: int = 0) -> xr.Dataset:
    """The estimate (:func:`.errors.estimate`) over time for what is handed off."""
    solid, fluid, solute = (0 if q is None else COUNT.index(q.shape[1])
                            for q in (given.motion, given.fluid, given.concentration))
    return errors.estimate(driving, point, solid, fluid, solute)


def _about_error(given: Handoff, driving: xr.Dataset | None, point: int) -> list[str]:
    """What the tissue alone lets guess of the error, where the series was made for a box."""
    if driving is None or given.motion is None or not errors.known(driving):
        return []
    return errors.told(error_of(given, driving, point))


def _about_recovery(given: Handoff, driving: xr.Dataset | None, point: int) -> list[str]:
    lines: list[str] = []
    if driving is None or given.motion is None:
        return lines
    method = driving.attrs.get("recovery")
    terms = max(q.shape[1] for q in (given.motion, given.fluid, given.concentration) if q is not None)
    if method == "element" and terms > COUNT[1]:
        lines.append(ELEMENT_NOTE)
    elif method:
        lines.append(f"recovery: {method}")
    lost = int(driving["terms_lost"].values[point]) if "terms_lost" in driving else 0
    if lost:
        lines.append(f"{lost} derivatives cannot be found from the elements around the point: taken as 0")
    return lines


def same_units(tissue: str | None, cell: str | None) -> None:
    """Raise InputError where tissue and cell model name different unit systems: nothing is converted between them."""
    units.one(tissue, cell, what="the tissue and the cell model")


def _volumes(given: Handoff) -> tuple[tuple[float, float], tuple[float, float], float | None]:
    assert given.motion is not None
    F = given.motion[:, 1:4].swapaxes(1, 2) + np.eye(3)
    det = np.linalg.det(F)
    low, high, first = np.inf, -np.inf, None
    step = max(1, 200_000 // max(len(given.X), 1))
    for i in range(0, len(given.times), step):
        d = np.linalg.det(gradient(given.motion[i:i + step], given.offset) + np.eye(3))
        low, high = min(low, float(d.min())), max(high, float(d.max()))
        turned = (d <= 0).any(axis=1)
        if first is None and turned.any():
            first = float(given.times[i + int(np.argmax(turned))])
    return (float(det.min()), float(det.max())), (low, high), first


def _size_ratio(given: Handoff, driving: xr.Dataset | None, point: int) -> float | None:
    if driving is None or "element_size" not in driving:
        return None
    return float(np.ptp(given.X, axis=0).max() / driving["element_size"].values[point])


def remainder(
    given: Handoff, driving: xr.Dataset | None, point: int
) -> tuple[float | None, float | None, float | None]:
    """Estimated share of displacement, pressure and concentrations (the worst one) that the series leaves out."""
    if driving is None or given.motion is None:
        return None, None, None
    known = orders(driving)
    every = coefficients(driving, point, max(known[0], 1), max(known[1], 0), max(known[2], 0))
    u = _left_out(every.u, given.offset, given.motion.shape[1], counts_first=False)
    p = c = None
    if given.fluid is not None and every.p is not None:
        p = _left_out(every.p[..., None], given.offset, given.fluid.shape[1])
    if given.concentration is not None and every.c is not None:
        names = [str(s) for s in driving["solute"].values]
        columns = [every.c[..., [names.index(s)]] for s in given.solutes]
        left = [_left_out(q, given.offset, given.concentration.shape[1]) for q in columns]
        c = max((x for x in left if x is not None), default=None)
    return u, p, c


def _left_out(every: Floats, offset: Floats, terms: int, counts_first: bool = True) -> float | None:
    """The first order left out behind ``terms`` of the coefficients (t, terms, c), over the largest value handed off.

    A displacement counts without the point's own.
    """
    order, top = COUNT.index(terms), COUNT.index(every.shape[1])
    used = every[:, :terms].copy()
    used[:, 0] *= counts_first
    scale = float(np.abs(evaluate(used, offset)).max())
    if scale == 0.0:
        return None
    parts = [float(np.abs(_part(every, offset, m)).max()) for m in range(1, top + 1)]
    if order < top:
        return parts[order] / scale
    if top >= 2 and parts[-2] > 0:
        return parts[-1] * min(parts[-1] / parts[-2], 1.0) / scale
    return None


def _part(coefficient: Floats, offset: Floats, order: int) -> Floats:
    """The terms of one order alone (t, n, c)."""
    s = slice(COUNT[order - 1], COUNT[order])
    return np.asarray(np.matmul(monomials(offset, TERMS[s])[None], coefficient[:, s]))
