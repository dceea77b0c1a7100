"""What a cell model's surface nodes do: displacement and pressure histories from a series, or overlaid."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from febkit.model import InputError

from .derivatives import apply, by_element, monomials
from .field import Field, from_dataset
from .location import locate, require_inside
from .taylor import coefficients, orders, series

if TYPE_CHECKING:
    import xarray as xr

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

RIGID = ("drop", "keep", "drop-all")


@dataclass(frozen=True, slots=True, eq=False)
class Handoff:
    """Histories for nodes at ``X`` (n, 3), reference positions of the cell model, measured from ``origin``.

    ``motion`` (t, terms, 3) and ``fluid`` (t, terms) are the coefficients of the series in the offset from
    ``origin`` (None for an overlay); ``u`` (t, n, 3) and ``p`` (t, n) the values at the nodes.
    ``fluid`` and ``p`` are None where the driving data hold no pressure.
    """

    times: Floats
    X: Floats
    origin: Floats
    motion: Floats | None = None
    fluid: Floats | None = None
    _u: Floats | None = None
    _p: Floats | None = None
    text: str = ""

    @property
    def offset(self) -> Floats:
        return self.X - self.origin

    @property
    def u(self) -> Floats:
        if self.motion is None:
            assert self._u is not None
            return self._u
        return evaluate(self.motion, self.offset)

    @property
    def p(self) -> Floats | None:
        if self.motion is None:
            return self._p
        return None if self.fluid is None else evaluate(self.fluid[..., None], self.offset)[..., 0]

    @property
    def wet(self) -> bool:
        return (self.fluid if self.motion is not None else self._p) is not None

    def without_pressure(self) -> Handoff:
        return replace(self, fluid=None, _p=None)


def evaluate(coefficient: Floats, offset: Floats) -> Floats:
    """Series (t, terms, c) at offsets (n, 3): (t, n, c)."""
    terms = coefficient.shape[1]
    basis = monomials(offset)[:, :terms]
    return np.asarray(np.matmul(basis[None], coefficient))


def handoff(driving: xr.Dataset, X: Floats, *, point: int = 0, order: int = 2,
            fluid_order: int | None = None, rigid: str = "drop", origin: Any = (0.0, 0.0, 0.0)) -> Handoff:
    """Histories at nodes ``X`` (n, 3) of a cell model from one point of a driving dataset.

    u = x - X with x = F X + 1/2 G XX (+ 1/6 G3 XXX), p = p0 + grad p X (+ 1/2 H XX + 1/6 H3 XXX); X counts
    from ``origin``, the place in the cell model that stands for the point. ``rigid``: "drop" the point's own
    displacement (the study's way), "keep" it, or "drop-all", its rotation too (R of F = R U).
    ``fluid_order`` None: the solid's, but at most 2 and what the driving data hold (see docs/handoff.md).
    """
    if fluid_order is None:
        fluid_order = max(min(order, 2, orders(driving)[1]), 0)
    _check(order, fluid_order, rigid)
    u, p = coefficients(driving, point, order, fluid_order)
    times = np.asarray(driving["time"].values, dtype=float)
    if rigid != "keep":
        u[:, 0] = 0.0
    if rigid == "drop-all":
        u = _unrotated(u)
    times, u, p = _from_rest(times, u, p)
    where = f"order {order} for the solid" + ("" if p is None else f", {fluid_order} for the fluid")
    return Handoff(times, np.asarray(X, float), np.asarray(origin, float), u, p, text=where)


def overlay(tissue: Field | xr.Dataset, X: Floats, at: Any, *, rigid: str = "drop",
            origin: Any = (0.0, 0.0, 0.0), times: Any = None) -> Handoff:
    """The tissue's own field at every node: X (n, 3) of the cell model laid over the tissue at ``at``.

    Raises InputError where a node comes to lie outside the tissue, naming it by its coordinates.
    """
    _check(1, 1, rigid)
    field = tissue if isinstance(tissue, Field) else from_dataset(tissue)
    if times is not None:
        field = field.at(times)
    at, origin, X = np.asarray(at, float).reshape(3), np.asarray(origin, float), np.asarray(X, float)
    places = np.vstack([at, X - origin + at])
    where = locate(field, places)
    require_inside(field, places, where, "node")
    values = apply(by_element(field, where, 1), field, 1)[:, :, 0].swapaxes(0, 1)
    u = values[:, 1:, :3]
    if rigid != "keep":
        u = u - values[:, :1, :3]
    if rigid == "drop-all":
        F = series(field, at, order=1)["F"].values[0]
        d = X - origin
        u = np.einsum("tji,tnj->tni", _rotation(F), u + d) - d
    p = values[:, 1:, 3] if values.shape[2] == 4 else None
    t, u, p = _from_rest(field.times, np.ascontiguousarray(u), p)
    return Handoff(t, X, origin, None, None, u, p, text="overlay: the tissue's field at every node")


def _check(order: int, fluid_order: int, rigid: str) -> None:
    if order not in (1, 2, 3):
        raise InputError(f"order must be 1, 2 or 3, not {order}")
    if fluid_order not in (0, 1, 2, 3):
        raise InputError(f"fluid order must be 1, 2 or 3 (0 for a uniform pressure), not {fluid_order}")
    if rigid not in RIGID:
        raise InputError(f'rigid motion can be {", ".join(RIGID)}; not "{rigid}"')


def _rotation(F: Floats) -> Floats:
    """R of the polar decomposition F = R U, (t, 3, 3)."""
    a, _, b = np.linalg.svd(F)
    R = a @ b
    a[..., -1] *= np.where(np.linalg.det(R) < 0, -1.0, 1.0)[..., None]
    return np.asarray(a @ b, dtype=float)


def _unrotated(u: Floats) -> Floats:
    """Coefficients with the rotation of the first order taken out of all orders."""
    x = u.copy()
    x[:, 1:4] += np.eye(3)
    R = _rotation(x[:, 1:4].swapaxes(1, 2))  # rows of the coefficients are dx/dX_J
    x = np.einsum("tji,tkj->tki", R, x)
    x[:, 1:4] -= np.eye(3)
    return np.asarray(x)


def _from_rest(times: Floats, u: Floats, p: Floats | None) -> tuple[Floats, Floats, Floats | None]:
    """Starts histories at time 0 from rest where the driving data start later."""
    if len(times) == 0:
        raise InputError("the driving data hold no times")
    if (np.diff(times) <= 0).any():
        raise InputError("the times of the driving data must increase")
    if times[0] <= 0:
        return times, u, p
    rest = np.zeros((1, *u.shape[1:]))
    still = None if p is None else np.concatenate([np.zeros((1, *p.shape[1:])), p])
    return np.concatenate([[0.0], times]), np.concatenate([rest, u]), still


def _facet_keys(corners: Ints, nodes: int) -> Ints:
    """A number per facet, the same for the same corners (sorted): three corners tell facets apart."""
    if nodes > 2_000_000:
        return np.asarray(np.unique(corners, axis=0, return_inverse=True)[1]).ravel()
    return np.asarray((corners[:, 0] * nodes + corners[:, 1]) * nodes + corners[:, 2])


def surface_nodes(mesh: Any) -> Ints:
    """0-based nodes of a mesh's outer surface: of all facets that belong to one element only."""
    from febkit.solver import elements

    found: dict[str, list[Ints]] = {}
    for b in mesh.blocks:
        if b.type not in elements.VOLUMES:
            continue
        for kind, local in elements.get(b.type).facets:
            found.setdefault(kind, []).append(b.conn[:, local])
    if not found:
        raise InputError("the cell model holds no solid elements")
    out = []
    for kind, parts in found.items():
        facets = np.concatenate(parts)
        corners = np.sort(facets[:, :elements.get(kind).corners], axis=1)
        key = _facet_keys(corners, len(mesh.X))
        _, first, count = np.unique(key, return_index=True, return_counts=True)
        out.append(facets[first[count == 1]].ravel())
    return np.asarray(np.unique(np.concatenate(out)))
