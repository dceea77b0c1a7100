"""How far a hand-off is off, by the tissue alone: an estimate over the cell model's box, and the order with the least.

For each of u (relative to the point), strain (Green-Lagrange), p, grad p and the concentrations, with f the series that
is handed off, the largest over a lattice of places X in the box, at each time:

    error = max_X max(|f - f_tissue|, |f - f_3|) + max_X |m| + max_X |s| / 4

- departure, |f - f_tissue|: from the tissue's own field, values and gradients recovered from the patches around each
  place. It holds what the series leaves out, and what recoveries and patches disagree about;
- truncation, |f - f_3|: from the series of order 3, the next terms;
- mesh, m = sum_i h_i^2/12 d_i^2 f_3: the leading error of linear elements with edges h_i. p_t = H k p'' becomes
  p_t = H k (p'' - h^2/12 p''''), an error that has grown to h^2/12 p'' when the front has passed; over the drained
  layer sqrt(H k t) it is a share of about h^2 / (12 H k t). Elements of higher order have none, and are taken as exact;
- swing, s = D . X (of p besides sum_i |D_i| h_i/2): D by what the gradient in the middle of the point's element differs
  from the recovered one. Linear hexahedra get it right there where a field is smooth, so it shows what swings from node
  to node, as pressures do in elements longer than the drained layer. Other elements have none of it.

It is an estimate, not a bound. What comes from far off (time steps, a drained face that lets too little out) shows in
nothing around the point: docs/handoff.md has how often and by how much it misses. The quarter was chosen there.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from febkit import units
from febkit.model import InputError

from .derivatives import COUNT, MAX_ORDER, TERMS, apply, by_element, evaluate, gradient
from .field import Field
from .location import Location, locate
from .superconvergent import by_patches

if TYPE_CHECKING:
    import xarray as xr

Floats = NDArray[np.float64]
Read = Callable[[int], Floats]  # order: coefficients (point, time, term, column) of the field's series

PARTS = ("departure", "truncation", "mesh", "swing")
SWING = 0.25  # share of the swing that counts; chosen on cases A and C
ORDERS = tuple(range(1, MAX_ORDER + 1))
# of each quantity: the series that it is made of, its name in words, its unit
QUANTITIES = {
    "u": ("u", "displacement", "displacement relative to the point", "L"),
    "strain": ("u", "strain", "Green-Lagrange strain, Frobenius norm", ""),
    "p": ("p", "pressure", "fluid pressure", "P"),
    "grad_p": ("p", "its gradient", "gradient of the fluid pressure", "P/L"),
    "c": ("c", "concentrations", "effective concentrations, norm over solutes", "c"),
}  # fmt: skip
FORMULA = "max over the box of max(|f - f_tissue|, |f - f_3|), plus that of the mesh and a quarter of the swing"


def lattice(box: Any) -> Floats:
    """Places (27, 3): corners, middles and centre of a cube of edge ``box`` about a point, or of the box of nodes.

    Raises InputError where it is no size.
    """
    given = np.asarray(box, dtype=float)
    if given.ndim == 0:
        given = np.array([[-0.5], [0.5]]) * np.where(given > 0, given, np.nan) * np.ones(3)
    if given.ndim != 2 or given.shape[1] != 3 or not np.isfinite(given).all() or not np.ptp(given, axis=0).any():
        raise InputError(f"the cell model's box must be the edge of a cube or nodes (n, 3) from the point, not {box!r}")
    low, high = given.min(axis=0), given.max(axis=0)
    along = [np.array([a, 0.5 * (a + b), b]) for a, b in zip(low, high)]
    return np.stack(np.meshgrid(*along, indexing="ij"), axis=-1).reshape(-1, 3)


def of_series(field: Field, where: Location, points: Floats, box: Any, handed: Read, third: Floats) -> dict[str, Any]:
    """Variables (dims, values, attrs) of a series dataset: errors of each order at each point and time.

    ``handed`` gives the coefficients of each order, ``third`` those of the third order by the recovery to trust most.
    Of each quantity ``_error`` (order, point, time), ``_error_by_part``, and ``_scale`` (point, time), its largest
    value in the box by the tissue's own field; ``modulus`` and ``permeability`` (point,), see
    :func:`_properties`.
    """
    places = lattice(box)
    t = len(field.times)
    step = max(1, min(50, 3_000_000 // (len(places) * t * 9)))
    known = units.system(field.units)
    pieces: list[dict[str, tuple[Floats, Floats]]] = []
    coefficients = [handed(n) for n in ORDERS]
    h, swing = _edges(field, where), _swing(field, where)
    for i in range(0, len(points), step):
        s = slice(i, i + step)
        own = around(field, points[s], places)
        pieces.append(_measured(field, places, own, [c[s] for c in coefficients], third[s], h[s],
                                 swing[s]))
    out: dict[str, Any] = {}
    for name, (of, _, text, symbol) in QUANTITIES.items():
        if of not in field.columns:
            continue
        by_part, scale = (np.concatenate([p[name][k] for p in pieces], axis=-2) for k in (0, 1))
        about = {"units": known.of(symbol) if symbol else "1"} if known else {}
        error = np.maximum(by_part[0], by_part[1]) + by_part[2] + SWING * by_part[3]
        dims = ("handed_order", "point", "time")
        out[f"{name}_error"] = (dims, error, {"long_name": f"estimated error of {text}", "formula": FORMULA} | about)
        out[f"{name}_error_by_part"] = (("part", *dims), by_part, {"long_name": f"parts of {name}_error"} | about)
        out[f"{name}_scale"] = (dims[1:], scale, {"long_name": f"largest {text} in the box, by the tissue"} | about)
    if "p" in field.columns:
        H, k = _properties(third, field.times, field.columns, 0.5 * float(np.ptp(places, axis=0).max()))
        of_tissue = (("modulus", H, "aggregate modulus of the tissue, by its balance of momentum", "P"),
                     ("permeability", k, "permeability of the tissue, by its balance of mass", "L^2/P.t"))
        for name, values, text, symbol in of_tissue:
            out[name] = (("point",), values, {"long_name": text} | ({"units": known.of(symbol)} if known else {}))
    about = {"units": known.of("L")} if known else {}
    out["box"] = (("end", "i"), np.stack([places.min(axis=0), places.max(axis=0)]),
                  {"long_name": "box of the cell model, from the point"} | about)
    return out


def around(field: Field, points: Floats, places: Floats) -> Floats:
    """Value and recovered gradient (point, place, time, 4, column) of the tissue around points; nan outside of it.

    The values are less the point's own where they are displacements.
    """
    m, n = len(points), len(places)
    at = np.concatenate([points, (points[:, None] + places).reshape(-1, 3)])
    found = locate(field, at)
    inside = np.nonzero(found.inside)[0]
    near = Location(found.block[inside], found.element[inside], found.r[inside], found.sharing[inside])
    out = np.full((len(at), len(field.times), COUNT[1], field.values.shape[2]), np.nan)
    out[inside] = apply(by_patches(field, near, 2)[0], field, COUNT[2])[:, :, : COUNT[1]]
    centre, around = out[:m], out[m:].reshape(m, n, *out.shape[1:])
    u = field.columns["u"]
    around[:, :, :, 0, u] -= centre[:, None, :, 0, u]
    return around


def _swing(field: Field, where: Location) -> Floats:
    """Gradient (point, time, 3, column) in the middle of each point's element, less the recovered one there."""
    from febkit.solver import elements

    out = np.zeros((len(where.block), len(field.times), 3, field.values.shape[2]))
    for k, b in enumerate(field.blocks):
        mine = np.nonzero(where.block == k)[0]
        if len(mine) and b.type == "hex8":
            middle = np.tile(elements.get(b.type).center.astype(float), (len(mine), 1))
            at = Location(where.block[mine], where.element[mine], middle, where.sharing[mine])
            own, recovered = (apply(r, field, COUNT[1]) for r in (by_element(field, at, COUNT[1]),
                                                                  by_patches(field, at, 1)[0]))
            out[mine] = (own - recovered)[:, :, 1:]
    return out


def _swung(swing: Floats, h: Floats, columns: dict[str, slice]) -> Floats:
    """Coefficients (point, time, 4, column) of what swings: the gradient, and the value that goes with it."""
    out = np.zeros((*swing.shape[:2], COUNT[1], swing.shape[3]))
    out[:, :, 1:] = swing
    out[:, :, 0] = np.einsum("ptic,pi->ptc", np.abs(swing), 0.5 * h)
    out[:, :, 0, columns["u"]] = 0.0
    return out


def _measured(field: Field, places: Floats, own: Floats, handed: list[Floats], third: Floats, h: Floats,
              swing: Floats) -> dict[str, tuple[Floats, Floats]]:
    """Of each quantity its parts (part, order, point, time) and scale (point, time)."""
    beside = _bent(third, h), _swung(swing, h, field.columns)
    out = {}
    for name, (of, *_) in QUANTITIES.items():
        if of not in field.columns:
            continue
        c = field.columns[of]
        tissue = tissue_values(name, own[..., c])
        best = series_values(name, third[..., c], places)
        parts = np.empty((len(PARTS), len(handed), *best.shape[1:3]))
        for k, coefficient in enumerate(handed):
            f = series_values(name, coefficient[..., c], places)
            others = (series_values(name, _sum(coefficient[..., c], v[..., c]), places) for v in beside)
            for j, other in enumerate((tissue, best, *others)):
                parts[j, k] = largest(f - other)
        out[name] = parts, largest(tissue)
    return out


def tissue_values(name: str, values: Floats) -> Floats:
    """A quantity (place, point, time, component) from values and gradients (point, place, time, 4, column)."""
    v = values.swapaxes(0, 1)
    if name in ("u", "p", "c"):
        return v[..., 0, :]
    slope = v[..., 1:, :].swapaxes(-1, -2)
    return slope[..., 0, :] if name == "grad_p" else _strain(slope)


def series_values(name: str, coefficient: Floats, places: Floats) -> Floats:
    """A quantity (place, point, time, component) from coefficients (point, time, term, column)."""
    m, t, terms, columns = coefficient.shape
    flat = coefficient.reshape(m * t, terms, columns)
    if name in ("u", "p", "c"):
        values = evaluate(flat, places) - (flat[:, None, 0] if name == "u" else 0.0)
    else:
        slope = gradient(flat, places)
        values = slope[:, :, 0] if name == "grad_p" else _strain(slope)
    return values.swapaxes(0, 1).reshape(len(places), m, t, -1)


def _strain(slope: Floats) -> Floats:
    """Green-Lagrange strain (..., 9) of displacement gradients (..., i, J)."""
    F = slope + np.eye(3)
    E = 0.5 * (F.swapaxes(-1, -2) @ F - np.eye(3))
    return E.reshape(*E.shape[:-2], 9)


def largest(values: Floats) -> Floats:
    """Largest norm over the places (point, time) of values (place, point, time, component), where there are any."""
    return np.asarray(np.nanmax(np.linalg.norm(values, axis=-1), axis=0))


def _sum(a: Floats, b: Floats) -> Floats:
    """Coefficients (..., term, column) added, whichever has more terms."""
    long, short = (a, b) if a.shape[-2] >= b.shape[-2] else (b, a)
    out = long.copy()
    out[..., : short.shape[-2], :] += short
    return out


def _bent(coefficient: Floats, h: Floats) -> Floats:
    """Coefficients (point, time, 4, column) of sum_i h_i^2/12 d_i^2 f, up to the first order; h (point, 3)."""
    index = {t: k for k, t in enumerate(TERMS)}
    out = np.zeros((*coefficient.shape[:2], COUNT[1], coefficient.shape[3]))
    for k, t in enumerate(TERMS[: COUNT[1]]):
        for i in range(3):
            out[:, :, k] += h[:, i, None, None] ** 2 / 12.0 * coefficient[:, :, index[tuple(sorted((*t, i, i)))]]
    return out


def _edges(field: Field, where: Location) -> Floats:
    """Extent of the element that holds each point along each axis (m, 3); 0 where it is of higher order than linear."""
    from febkit.solver import elements

    out = np.zeros((len(where.block), 3))
    for k, b in enumerate(field.blocks):
        mine = np.nonzero(where.block == k)[0]
        if len(mine) and elements.get(b.type).order == 1:
            out[mine] = np.ptp(field.X[b.conn[where.element[mine]]], axis=1)
    return out


def _properties(third: Floats, times: Floats, columns: dict[str, slice], a: float) -> tuple[Floats, Floats]:
    """Aggregate modulus H and permeability k (m,) of the tissue, by its balances alone; nan where nothing happens.

    Least squares over times (by the length of their steps) and derivatives d^n, n = 0, 1, by a^2n, with ``a`` half the
    box's edge: grad p = (lambda + mu) grad div u + mu lap u, of an isotropic solid in small strains, H = lambda + 2 mu,
    and d(div u)/dt = k lap p. Where a tissue moves along one axis the two terms are one, and H is found all the same.
    """
    u, p = third[..., columns["u"]], third[..., columns["p"].start]
    index = {t: k for k, t in enumerate(TERMS)}
    dt = np.diff(times)
    normal, right, flow = np.zeros((len(third), 2, 2)), np.zeros((len(third), 2)), np.zeros((2, len(third)))
    for tail in ((), (0,), (1,), (2,)):
        weight = a ** (2 * len(tail)) * dt
        at = np.array([[index[tuple(sorted((i, j, *tail)))] for j in range(3)] for i in range(3)])
        one = [index[tuple(sorted((i, *tail)))] for i in range(3)]
        swell = u[:, :, one, [0, 1, 2]].sum(axis=-1)  # div u
        bend = np.stack([u[:, :, at, [[0, 1, 2]] * 3].sum(axis=-1), u[:, :, np.diag(at)].sum(axis=2)], axis=2)[:, 1:]
        normal += np.einsum("ptai,ptbi,t->pab", bend, bend, weight)
        right += np.einsum("ptai,pti,t->pa", bend, p[:, 1:, one], weight)
        spread = p[:, :, np.diag(at)].sum(axis=-1)
        mean = 0.5 * (spread[:, 1:] + spread[:, :-1])
        flow += np.stack([(np.diff(swell, axis=1) / dt * mean * weight).sum(axis=1), (mean**2 * weight).sum(axis=1)])
    H = np.einsum("pab,pb->p", np.linalg.pinv(normal, rcond=1e-3, hermitian=True), right)
    k = flow[0] / np.where(flow[1] > 0, flow[1], np.nan)
    return np.where(H > 0, H, np.nan), np.where(k > 0, k, np.nan)


def choose(found: dict[str, Any]) -> dict[str, Any]:
    """Variables (dims, orders) of the order with the least error at each point: of motion, pressure, concentrations.

    The error is that of what strains cells, the strain and the pressure's gradient, root mean square over times.
    """
    out = {}
    for of, name in (("solid", "strain"), ("fluid", "grad_p"), ("solute", "c")):
        if f"{name}_error" in found:
            error = np.sqrt((found[f"{name}_error"][1] ** 2).mean(axis=-1))
            best = np.array(ORDERS)[error.argmin(axis=0)]
            out[f"{of}_order"] = (("point",), best, {"long_name": f"order of the {of} with the least estimated error"})
    return out


def asked(driving: xr.Dataset, order: int | str | None, fluid_order: int | None = None,
          solute_order: int | None = None) -> xr.Dataset:
    """Driving data that name the orders to hand off at each point; "auto", where they were chosen, keeps those."""
    out = {}
    for name, given in (("fluid", fluid_order), ("solute", solute_order)):
        if given is not None:
            out[name] = given
    if order != "auto":
        solid = 2 if order is None else int(order)
        fluid = min(solid, 2) if fluid_order is None else fluid_order
        out = {"solid": solid, "fluid": fluid, "solute": fluid if solute_order is None else solute_order}
    have = {"solid": "F", "fluid": "p", "solute": "c"}
    points = driving.sizes["point"]
    return driving.assign({f"{n}_order": ("point", np.full(points, v), {"long_name": f"order of the {n} handed off"})
                           for n, v in out.items() if have[n] in driving})


def chosen(driving: xr.Dataset, point: int = 0) -> tuple[int, int | None, int | None]:
    """Orders of motion, pressure and concentrations (None: there are none) that the driving data name for a point.

    Raises InputError where they name none.
    """
    if "solid_order" not in driving:
        raise InputError('order "auto": no orders were chosen in the driving data; only a series of a tissue made with '
                         'order="auto" (febkit boundary TISSUE CELL --order auto) has them')
    solid, *others = (int(driving[n].values[point]) if n in driving else None
                      for n in ("solid_order", "fluid_order", "solute_order"))
    assert solid is not None
    return solid, others[0], others[1]


def known(driving: xr.Dataset | None) -> bool:
    """Whether driving data hold estimates: those of a tissue do that were made for a box."""
    return driving is not None and "strain_error" in driving


def estimate(driving: xr.Dataset, point: int = 0, order: int | None = None, fluid_order: int | None = None,
             solute_order: int | None = None) -> xr.Dataset:
    """Errors over ``time`` of a hand-off of these orders from one point; None: those that the data name, or that
    handoff() takes.

    The error of a uniform pressure or concentration (order 0) is not known and left out.

    Raises InputError where the driving data hold none: series of a tissue made with ``box`` do.
    """
    import xarray as xr

    if not known(driving):
        raise InputError("the driving data hold no estimate of their error: only a series of a tissue that was made "
                         "for a cell model's box has one (febkit boundary --dataset with a CELL; series(..., box=...))")
    if order is None and "solid_order" in driving:
        order, *rest = chosen(driving, point)
        fluid_order, solute_order = (own if given is None else given
                                     for given, own in zip((fluid_order, solute_order), rest))
    order = 2 if order is None else order
    of_each = {"u": order, "p": min(order, 2) if fluid_order is None else fluid_order}
    of_each["c"] = of_each["p"] if solute_order is None else solute_order
    one = driving.isel(point=point)
    fields = {n: one[n] for n in ("modulus", "permeability", "box") if n in one}
    for name, (of, *_) in QUANTITIES.items():
        if f"{name}_error" in one and of_each[of] > 0:
            for v in (f"{name}_error", f"{name}_error_by_part"):
                fields[v] = one[v].sel(handed_order=of_each[of], drop=True)
            fields[f"{name}_scale"] = one[f"{name}_scale"]
    kept = {k: v for k, v in driving.attrs.items() if k in ("unit_system", "recovery", "source")}
    return xr.Dataset(fields, attrs=kept).assign_attrs(solid_order=order, fluid_order=of_each["p"], formula=FORMULA)


def relative(found: xr.Dataset, name: str, part: str | None = None) -> float:
    """Largest error of a quantity over times (or of one of its parts), by its largest value."""
    error = found[f"{name}_error"] if part is None else found[f"{name}_error_by_part"].sel(part=part)
    top = float(found[f"{name}_scale"].max())
    return float(error.max()) / top if top > 0 else float("nan")


def told(found: xr.Dataset) -> list[str]:
    """The estimate in two lines: largest error over box and times by the largest value there; what the mesh adds."""
    have = {n: q[1] for n, q in QUANTITIES.items() if f"{n}_error" in found}
    whole = ", ".join(f"{text} {_percent(relative(found, n))}" for n, text in have.items())
    mesh = ", ".join(f"{text} {_percent(relative(found, n, 'mesh'))}" for n, text in have.items())
    lines = [f"estimated error (largest over box and times by the largest there): {whole}",
             f"of that by the tissue's mesh: {mesh}"]
    if "p" in have and relative(found, "p", "swing") > 0.05:
        lines[-1] += f"; its pressure swings from node to node by {_percent(relative(found, 'p', 'swing'))}"
    return lines


def _percent(share: float) -> str:
    return f"{100 * share:.2g} %" if share < 1 else f"{100 * share:.0f} %"
