"""How far a hand-off is off: against a finer tissue, by element size, order and recovery.

The error is that of the displacement (relative to the point) and of the pressure on a cube the size of the
cell model around the point, as the largest value over the cube and times, by the largest value there is.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .field import Field, from_dataset
from .histories import handoff, overlay
from .taylor import RECOVERIES, series

if TYPE_CHECKING:
    import xarray as xr

Floats = NDArray[np.float64]


def cube(edge: float, n: int = 5) -> Floats:
    """Places (m, 3) on the surface of a cube around the origin, n along an edge."""
    g = np.linspace(-0.5 * edge, 0.5 * edge, n)
    x = np.stack(np.meshgrid(g, g, g, indexing="ij"), axis=-1).reshape(-1, 3)
    return np.asarray(x[np.abs(x).max(axis=1) > 0.4999 * edge])


def relative(found: Floats | None, true: Floats | None, per_time: bool = False) -> Any:
    """max |found - true| / max |true| over places, and over times too unless ``per_time``."""
    if found is None or true is None:
        return np.nan
    axes = tuple(range(1, true.ndim))
    miss = np.abs(found - true).max(axis=axes)
    size = np.abs(true).max(axis=axes)
    return miss / np.maximum(size, 1e-300) if per_time else float(miss.max() / max(size.max(), 1e-300))


def handoff_errors(tissues: Mapping[Any, Field | xr.Dataset], reference: Field | xr.Dataset, at: Any,
                   edge: float, times: Any, orders: Iterable[int] = (1, 2, 3),
                   recoveries: Iterable[str] = tuple(RECOVERIES)) -> xr.Dataset:
    """Errors of hand-offs at a point from tissues (by element size or any other label) against a finer one.

    Returns ``u`` and ``p`` over ``tissue``, ``recovery``, ``order``, and ``u_overlay``, ``p_overlay`` over
    ``tissue``, as shares of the largest value on the cube of this ``edge``.
    """
    import xarray as xr

    X, t = cube(edge), np.asarray(times, dtype=float)
    labels, names, degrees = list(tissues), list(recoveries), list(orders)
    fine = overlay(reference, X, at, times=t)
    u = np.full((len(labels), len(names), len(degrees)), np.nan)
    p, u_over, p_over = u.copy(), np.full(len(labels), np.nan), np.full(len(labels), np.nan)
    for i, label in enumerate(labels):
        tissue = tissues[label]
        field = (tissue if isinstance(tissue, Field) else from_dataset(tissue)).at(t)
        laid = overlay(field, X, at)
        u_over[i], p_over[i] = relative(laid.u, fine.u), relative(laid.p, fine.p)
        for j, name in enumerate(names):
            for k, n in enumerate(degrees):  # each order with the polynomial it would be handed off with
                given = handoff(series(field, at, order=n, recovery=name), X, order=n, fluid_order=n)
                u[i, j, k], p[i, j, k] = relative(given.u, fine.u), relative(given.p, fine.p)
    dims = ("tissue", "recovery", "order")
    return xr.Dataset({"u": (dims, u), "p": (dims, p), "u_overlay": ("tissue", u_over),
                       "p_overlay": ("tissue", p_over)},
                      {"tissue": labels, "recovery": names, "order": degrees}, {"edge": edge})


def table(errors: xr.Dataset) -> str:
    """The errors in per cent, a row per tissue and recovery."""
    orders = errors["order"].values.tolist()
    head = "tissue      recovery    " + "".join(f"{v} {n:<6}" for v in "up" for n in orders)
    lines = [head]
    for t in errors["tissue"].values:
        for r in errors["recovery"].values:
            row = errors.sel(tissue=t, recovery=r)
            cells = [*row["u"].values, *row["p"].values]
            lines.append(f"{t!s:<12}{r:<12}" + "".join(f"{100 * c:<8.3g}" for c in cells))
        one = errors.sel(tissue=t)
        gap = " " * (8 * (len(orders) - 1))
        lines.append(f"{t!s:<12}{'overlay':<12}{100 * float(one['u_overlay']):<8.3g}{gap}"
                     f"{100 * float(one['p_overlay']):<8.3g}")
    return "\n".join(lines)
