"""Taylor series of a tissue's motion, pressure and concentrations at points: F, G, p, grad p, H at all times.

x(X) = x0 + F X + 1/2 X G X + 1/6 G3 X X X, p(X) = p0 + grad p . X + 1/2 X H X + 1/6 H3 X X X, and like p each effective
concentration, with X measured from the point; Sibole et al., Comput Methods Biomech Biomed Engin 16 (2013), eqs 1-9,
and the third order.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from febkit import units
from febkit.model import InputError

from . import errors
from .derivatives import COUNT, MAX_ORDER, apply, by_element, full, packed
from .field import Field, from_dataset
from .location import Location, locate, require_inside
from .polynomial import by_polynomial
from .superconvergent import by_patches

if TYPE_CHECKING:
    import xarray as xr

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# chosen from the tables of docs/handoff.md (made by febkit.coupling.accuracy): it errs least of the three
# while the tissue's pressures still swing from node to node, and is as good as the polynomial later
DEFAULT_RECOVERY = "patches"

# names of the value and the first, second and third derivatives of what a tissue has
SERIES = {
    "u": ("u", "F", "G", "G3"), "p": ("p", "grad_p", "H", "H3"), "c": ("c", "grad_c", "H_c", "H3_c"),
    "psi": ("psi", "grad_psi", "H_psi", "H3_psi"),
}  # fmt: skip

ELEMENT_NOTE = (
    "element: the element's own derivatives. In a trilinear brick that is a parallelepiped the pure second "
    "derivatives along its edges are zero whatever the field, and in a linear tetrahedron all second "
    "derivatives are: choose a recovery for order 2 with linear elements."
)


@dataclass(frozen=True, slots=True)
class Recovery:
    """A way to get derivatives: ``rows(field, location, points, order)`` gives sparse rows and terms lost."""

    name: str
    text: str
    rows: Callable[[Field, Location, Floats, int, bool], tuple[Any, Ints]]


Rows = tuple[Any, Ints]


def _element(field: Field, where: Location, points: Floats, order: int, own_part: bool) -> Rows:
    return by_element(field, where, COUNT[order]), np.zeros(len(points), dtype=np.int64)


def _polynomial(field: Field, where: Location, points: Floats, order: int, own_part: bool) -> Rows:
    return by_polynomial(field, where, points, order, own_part=own_part)


def _patches(field: Field, where: Location, points: Floats, order: int, own_part: bool) -> Rows:
    return by_patches(field, where, order, own_part=own_part)


RECOVERIES = {
    r.name: r for r in (
        Recovery("element", ELEMENT_NOTE, _element),
        Recovery("polynomial", "polynomial: least squares through the nodal values of the patch of elements "
                 "around the point, differentiated at the point.", _polynomial),
        Recovery("patches", "patches: superconvergent patch recovery (Zienkiewicz & Zhu 1992), applied again "
                 "for each higher derivative.", _patches),
    )
}


def series(tissue: Field | xr.Dataset, points: Any, *, order: int | str = 2,
           recovery: str | None = None, times: Any = None, names: Any = None,
           own_part: bool = True, beyond: bool = False, box: Any = None) -> xr.Dataset:
    """Series up to ``order`` of a solved tissue at points (m, 3) of its reference configuration.

    Returns a Dataset over ``point`` and ``time``: displacement ``u`` of the point, ``F`` (3, 3), ``G`` (3, 3, 3),
    ``G3``; where the tissue has pressure ``p``, ``grad_p``, ``H``, ``H3``; where it has solutes their effective
    concentrations ``c`` over ``solute`` as well, ``grad_c``, ``H_c``, ``H3_c``, and the electric potential ``psi``
    derived from the result's (a cell model finds its own); and where each point lies. ``recovery`` is a name of
    :data:`RECOVERIES`, by default that of :func:`default_recovery`; ``times`` picks or interpolates times;
    ``own_part`` keeps the patch to the part (material) of the point.

    Ask for the order that is handed off: recovery depends on it. ``beyond`` adds the derivatives one order up,
    from a recovery of their own, for the estimate of what is left out.

    ``box``, the edge of the cell model's cube or its nodes (n, 3) from the point, adds an estimate of the error of
    every order over that box (``u_error``, ``strain_error``, ``p_error``, ...): see :mod:`.errors`. With it ``order``
    may be "auto": at each point the orders of motion, pressure and concentrations with the least error, named in
    ``solid_order``, ``fluid_order``, ``solute_order``.

    Raises InputError where a point lies outside the tissue, naming it by its coordinates.
    """
    if order == "auto":
        if box is None:
            raise InputError('order "auto" asks for the size of the cell model (box), over which errors are estimated')
    elif isinstance(order, str):
        raise InputError(f'order must be 1, 2, 3 or "auto", not "{order}"')
    field = tissue if isinstance(tissue, Field) else from_dataset(tissue)
    if times is not None:
        field = field.at(np.asarray(times, dtype=float))
    points = np.atleast_2d(np.asarray(points, dtype=float))
    top = MAX_ORDER if order == "auto" else int(order)
    method = _method(recovery or default_recovery(field, top), top)
    where = locate(field, points)
    require_inside(field, points, where)
    read = _Recovered(field, where, points, own_part)
    found = {} if box is None else errors.of_series(
        field, where, points, box, lambda n: read(method.name, n), read(default_recovery(field, MAX_ORDER), MAX_ORDER))
    chosen = errors.choose(found) if order == "auto" else {}
    values = _of_orders(field, chosen, lambda n: read(method.name, n)) if chosen else read(method.name, top)
    lost = read.lost[method.name, top]
    if beyond and top < MAX_ORDER:
        values = np.concatenate([values, read(method.name, top + 1)[:, :, COUNT[top]:]], axis=2)
    for name, said in (("u", "displacement"), ("c", "concentrations")):
        columns = field.columns.get(name)
        if columns is not None and not np.isfinite(values[..., columns]).all():
            raise InputError(f"the tissue's {said}: not a number around some of the points")
    ds = _dataset(field, points, where, values, lost, COUNT.index(values.shape[2]), method, names)
    ds.attrs["order"] = order
    return ds if box is None else _with_errors(ds, found | chosen)


class _Recovered:
    """Coefficients (point, time, term, column) by recovery and order, each found once; ``lost`` counts terms lost."""

    def __init__(self, field: Field, where: Location, points: Floats, own_part: bool) -> None:
        self.told = field, where, points
        self.own_part = own_part
        self.kept: dict[tuple[str, int], Floats] = {}
        self.lost: dict[tuple[str, int], Ints] = {}

    def __call__(self, name: str, order: int) -> Floats:
        if (name, order) not in self.kept:
            operator, self.lost[name, order] = RECOVERIES[name].rows(*self.told, order, self.own_part)
            self.kept[name, order] = apply(operator, self.told[0], COUNT[order])
        return self.kept[name, order]


def _of_orders(field: Field, chosen: dict[str, Any], read: Callable[[int], Floats]) -> Floats:
    """Coefficients up to the third order, at each point those of its own order and, beyond, of the orders there."""
    out = read(MAX_ORDER).copy()
    for of, name in (("u", "solid"), ("p", "fluid"), ("c", "solute")):
        for n in range(MAX_ORDER - 1, 0, -1):
            if of in field.columns and f"{name}_order" in chosen:
                mine = chosen[f"{name}_order"][1] <= n
                out[mine, :, : COUNT[n], field.columns[of]] = read(n)[mine][..., field.columns[of]]
    return out


def _with_errors(ds: xr.Dataset, found: dict[str, Any]) -> xr.Dataset:
    """A series with the variables of :mod:`.errors`."""
    return ds.assign(found).assign_coords(part=list(errors.PARTS), handed_order=list(errors.ORDERS))


def default_recovery(field: Field, order: int) -> str:
    """Superconvergent patches; at order 3 a polynomial where there are quadratic tetrahedra, which have no
    points of superconvergence that get a cubic field right."""
    quadratic = any(b.type in ("tet10", "tet15") for b in field.blocks)
    return "polynomial" if quadratic and order == 3 else DEFAULT_RECOVERY


def _method(recovery: str, order: int) -> Recovery:
    if recovery not in RECOVERIES:
        raise InputError(f'there is no recovery "{recovery}"; choose from {", ".join(RECOVERIES)}')
    if not 1 <= order <= MAX_ORDER:
        raise InputError(f"order must be 1, 2 or 3, not {order}")
    return RECOVERIES[recovery]


def element_size(field: Field, where: Location) -> Floats:
    """Edge of the cube as large as the element that holds each point (m,)."""
    from febkit.solver import elements

    from .shapes import shape

    out = np.zeros(len(where.block))
    for k, b in enumerate(field.blocks):
        mine = np.nonzero(where.block == k)[0]
        if len(mine):
            e = elements.get(b.type)
            jac = np.einsum("pni,gnj->pgij", field.X[b.conn[where.element[mine]]], shape(b.type, e.points, 1))
            out[mine] = np.cbrt(np.abs(np.linalg.det(jac)) @ e.weights)
    return out


def _dataset(field: Field, points: Floats, where: Location, values: Floats, lost: Ints, order: int,
             method: Recovery, names: Any) -> xr.Dataset:
    import xarray as xr

    from febkit import __version__

    fields: dict[str, Any] = {}
    for name, columns in field.columns.items():
        own = ("i",) if name == "u" else ("solute",) if name == "c" else ()
        axes: tuple[str, ...] = ()
        for n in range(order + 1):
            axes = (*axes, "JKL"[n - 1]) if n else ()
            tensor = np.stack([full(values[..., c], n) for c in range(columns.start, columns.stop)], axis=2)
            if name == "u" and n == 1:
                tensor = tensor + np.eye(3)
            dims = ("point", "time", *own, *axes)
            fields[SERIES[name][n]] = (dims, tensor if own else tensor[:, :, 0])
    fields |= {
        "X": (("point", "i"), points),
        "element_id": (("point",), np.array([field.blocks[b].ids[e]
                                             for b, e in zip(where.block, where.element)])),
        "natural": (("point", "axis"), where.r),
        "sharing": (("point",), where.sharing, {"long_name": "elements that hold the point"}),
        "element_size": (("point",), element_size(field, where)),
        "terms_lost": (("point",), lost, {"long_name": "terms the patch could not resolve, taken as 0"}),
    }
    coords: dict[str, Any] = {"time": field.times,
                              "point": np.arange(len(points)) if names is None else list(names)}
    coords |= {k: list("xyz") for k in "iJKL" if any(k in f[0] for f in fields.values())}
    coords |= {"solute": list(field.solutes)} if field.solutes else {}
    attrs = {
        "title": "Taylor series of a tissue's motion, pressure and concentrations", "order": order,
        "recovery": method.name,
        "recovery_text": method.text, "source": field.source, "febkit_version": __version__,
        "elements": ", ".join(f"{len(b.conn)} {b.type}" for b in field.blocks),
        "formula": "x = x0 + F X + G XX/2 + G3 XXX/6; p = p0 + grad_p X + H XX/2 + H3 XXX/6 (likewise c: grad_c, "
                   "H_c, H3_c; psi); X from the point",
    }
    if field.units:
        attrs["unit_system"] = field.units
    ds = xr.Dataset(fields, coords, attrs)
    _name_units(ds)
    return ds


def _name_units(ds: xr.Dataset) -> None:
    """Units of everything, where the tissue's system is known; those of derivatives are by the reference length."""
    known = units.system(ds.attrs.get("unit_system"))
    symbols = {"time": "t", "X": "L", "element_size": "L"}
    for name, symbol in (("u", "L"), ("p", "P"), ("c", "c"), ("psi", "V")):
        symbols |= {d: f"{symbol}/L^{n}" if n else symbol for n, d in enumerate(SERIES[name])}
    for name in symbols.keys() & set(map(str, ds.variables)):
        if known:
            ds[name].attrs["units"] = known.of(symbols[name])


@dataclass(frozen=True, slots=True, eq=False)
class Coefficients:
    """Packed coefficients at one point: u (t, terms, 3), p (t, terms), c (t, terms, s); None where there is none.

    The terms go with :func:`febkit.coupling.derivatives.monomials`; F counts as F - 1.
    """

    u: Floats
    p: Floats | None = None
    c: Floats | None = None


def coefficients(ds: xr.Dataset, point: int, order: int, fluid_order: int, solute_order: int = 0) -> Coefficients:
    """Coefficients at one point up to the orders of motion, pressure and concentrations.

    Raises InputError where the driving data do not hold an order.
    """
    one = ds.isel(point=point)
    u = _packed(one, "u", order, "order")
    p = _packed(one, "p", fluid_order, "fluid order")[..., 0] if "p" in one else None
    c = _packed(one, "c", solute_order, "solute order") if "c" in one else None
    return Coefficients(u, p, c)


def _packed(one: xr.Dataset, of: str, order: int, said: str) -> Floats:
    """Coefficients (t, terms, component) of "u", "p" or "c" up to ``order``."""
    width = {"u": 3, "p": 1, "c": one.sizes.get("solute", 1)}[of]
    t = one.sizes["time"]
    out = np.zeros((t, COUNT[order], width))
    for n, name in enumerate(SERIES[of][: order + 1]):
        if name not in one:
            if of == "u" and n == 0:
                continue
            raise InputError(f'{said} {order} asked for, but the driving data hold no "{name}"')
        tensor = one[name].values - (np.eye(3) if name == "F" else 0.0)
        terms = packed(tensor.reshape(t, width, *(3,) * n), n)  # (t, component, terms)
        out[:, COUNT[n - 1] if n else 0 : COUNT[n]] = terms.swapaxes(1, 2)
    return out


def orders(ds: xr.Dataset) -> tuple[int, int, int]:
    """Highest orders that driving data hold: of the motion, the pressure and the concentrations (-1: none)."""
    motion = next((n for n, name in enumerate(SERIES["u"][1:]) if name not in ds), 3)
    return motion, _order(ds, "p"), _order(ds, "c")


def _order(ds: xr.Dataset, of: str) -> int:
    return next((n - 1 for n, name in enumerate(SERIES[of]) if name not in ds), 3)
