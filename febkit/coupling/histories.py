"""What a cell model's surface nodes do: histories of all that a tissue hands over, from a series or overlaid."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from febkit.model import InputError

from .derivatives import apply, by_element, evaluate
from .errors import chosen
from .field import Field, from_dataset
from .location import locate, require_inside
from .taylor import Coefficients, coefficients, orders, series

if TYPE_CHECKING:
    import xarray as xr

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

RIGID = ("drop", "keep", "drop-all")


@dataclass(frozen=True, slots=True, eq=False)
class Handoff:
    """Histories for nodes at ``X`` (n, 3), reference positions of the cell model, measured from ``origin``.

    Of a series: ``motion`` (t, terms, 3), ``fluid`` (t, terms) and ``concentration`` (t, terms, s), coefficients in
    the offset from ``origin``; of an overlay (where ``motion`` is None) ``at_nodes``, the values themselves. :attr:`u`
    (t, n, 3), :attr:`p` (t, n) and :attr:`c` (t, n, s) are the values at the nodes; p and c are None where the driving
    data hold no pressure, no solutes.
    """

    times: Floats
    X: Floats
    origin: Floats
    motion: Floats | None = None
    fluid: Floats | None = None
    concentration: Floats | None = None
    solutes: tuple[str, ...] = ()
    solute_ids: tuple[int, ...] = ()  # those of the cell model, once it is known
    at_nodes: Coefficients | None = None
    text: str = ""

    @property
    def offset(self) -> Floats:
        return self.X - self.origin

    @property
    def u(self) -> Floats:
        if self.motion is None:
            assert self.at_nodes is not None
            return self.at_nodes.u
        return evaluate(self.motion, self.offset)

    @property
    def p(self) -> Floats | None:
        if self.at_nodes is not None:
            return self.at_nodes.p
        return None if self.fluid is None else evaluate(self.fluid[..., None], self.offset)[..., 0]

    @property
    def c(self) -> Floats | None:
        if self.at_nodes is not None:
            return self.at_nodes.c
        return None if self.concentration is None else evaluate(self.concentration, self.offset)

    @property
    def wet(self) -> bool:
        return (self.fluid if self.at_nodes is None else self.at_nodes.p) is not None

    def without_pressure(self) -> Handoff:
        held = self.at_nodes if self.at_nodes is None else replace(self.at_nodes, p=None)
        return replace(self, fluid=None, at_nodes=held)

    def of_solutes(self, names: Sequence[str]) -> Handoff:
        """The hand-off with these of its solutes, in this order; none where ``names`` is empty.

        Raises InputError where it lacks one.
        """
        missing = [n for n in names if n not in self.solutes]
        if missing:
            there = f"there {'is' if len(self.solutes) == 1 else 'are'} {', '.join(self.solutes) or 'none'}"
            raise InputError(f'the driving data hold no solute "{missing[0]}": {there}')
        at = [self.solutes.index(n) for n in names]
        held = self.at_nodes
        if held is not None:
            held = replace(held, c=held.c[..., at] if held.c is not None and at else None)
        c = self.concentration[..., at] if self.concentration is not None and at else None
        return replace(self, concentration=c, solutes=tuple(names), at_nodes=held)


def handoff(driving: xr.Dataset, X: Floats, *, point: int = 0, order: int | str = 2,
            fluid_order: int | None = None, solute_order: int | None = None, rigid: str = "drop",
            origin: Any = (0.0, 0.0, 0.0)) -> Handoff:
    """Histories at nodes ``X`` (n, 3) of a cell model from one point of a driving dataset.

    u = x - X with x = F X + 1/2 G XX (+ 1/6 G3 XXX), p = p0 + grad p X (+ 1/2 H XX + 1/6 H3 XXX), and so each
    effective concentration; X counts from ``origin``, the place in the cell model that stands for the point.
    ``rigid``: "drop" the point's own displacement (the study's way), "keep" it, or "drop-all", its rotation too (R of
    F = R U). ``fluid_order`` None: the solid's, but at most 2 and what the driving data hold (see docs/handoff.md);
    ``solute_order`` None: the fluid's, but at most what the driving data hold. "auto" takes the orders with the least
    estimated error, of data made with ``series(..., order="auto")``, where they are not said.
    """
    held = orders(driving)
    if order == "auto":
        order, *rest = chosen(driving, point)
        fluid_order, solute_order = (given if given is not None else own
                                     for given, own in zip((fluid_order, solute_order), rest))
    elif isinstance(order, str):
        raise InputError(f'order must be 1, 2, 3 or "auto", not "{order}"')
    if fluid_order is None:
        fluid_order = max(min(order, 2, held[1]), 0)
    if solute_order is None:
        solute_order = max(min(fluid_order, held[2]), 0)
    _check(order, fluid_order, solute_order, rigid)
    found = coefficients(driving, point, order, fluid_order, solute_order)
    u = found.u
    if rigid != "keep":
        u[:, 0] = 0.0
    if rigid == "drop-all":
        u = _unrotated(u)
    times, at = _from_rest(np.asarray(driving["time"].values, dtype=float), replace(found, u=u))
    text = f"order {order} for the solid" + ("" if at.p is None else f", {fluid_order} for the fluid")
    text += "" if at.c is None else f", {solute_order} for the solutes"
    names = tuple(str(n) for n in driving["solute"].values) if at.c is not None else ()
    return Handoff(times, np.asarray(X, float), np.asarray(origin, float), at.u, at.p, at.c, names, text=text)


def overlay(tissue: Field | xr.Dataset, X: Floats, at: Any, *, rigid: str = "drop",
            origin: Any = (0.0, 0.0, 0.0), times: Any = None) -> Handoff:
    """The tissue's own field at every node: X (n, 3) of the cell model laid over the tissue at ``at``.

    Raises InputError where a node comes to lie outside the tissue, naming it by its coordinates.
    """
    _check(1, 1, 1, rigid)
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
    own = {name: np.ascontiguousarray(values[:, 1:, c]) for name, c in field.columns.items()}
    p, c = own.get("p"), own.get("c")
    t, held = _from_rest(field.times, Coefficients(np.ascontiguousarray(u), None if p is None else p[..., 0], c))
    return Handoff(t, X, origin, solutes=field.solutes if c is not None else (), at_nodes=held,
                   text="overlay: the tissue's field at every node")


def _check(order: int, fluid_order: int, solute_order: int, rigid: str) -> None:
    if order not in (1, 2, 3):
        raise InputError(f"order must be 1, 2 or 3, not {order}")
    for name, n, of in (("fluid", fluid_order, "pressure"), ("solute", solute_order, "concentration")):
        if n not in (0, 1, 2, 3):
            raise InputError(f"{name} order must be 1, 2 or 3 (0 for a uniform {of}), not {n}")
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


def _from_rest(times: Floats, at: Coefficients) -> tuple[Floats, Coefficients]:
    """Starts histories at time 0 from rest where the driving data start later.

    At rest nothing moves and no pressure acts; with solutes, concentrations and the effective pressure that goes with
    them are those of the first time, as in a bath.
    """
    if len(times) == 0:
        raise InputError("the driving data hold no times")
    if (np.diff(times) <= 0).any():
        raise InputError("the times of the driving data must increase")
    if times[0] <= 0:
        return times, at

    def later(y: Floats | None, start: float) -> Floats | None:
        return None if y is None else np.concatenate([start * y[:1], y])

    u = later(at.u, 0.0)
    assert u is not None
    return np.concatenate([[0.0], times]), Coefficients(u, later(at.p, 0.0 if at.c is None else 1.0), later(at.c, 1.0))


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
