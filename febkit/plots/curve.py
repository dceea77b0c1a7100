"""Any variable of a result over time, or over another variable: a line for each part, set, node, element and result."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from febkit import units
from febkit.model import InputError

from . import canvas
from .quantity import Quantity, quantity

if TYPE_CHECKING:
    import xarray as xr

    from febkit.model import Model

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
TAKE = ("mean", "sum", "least", "greatest")
_MARKED = 25  # states up to which their points are marked


@dataclass(frozen=True, slots=True, eq=False)
class Place:
    """What a line is of: ``rows`` by dimension ("element", "node", "facet", "domain"); {} for the whole model."""

    name: str
    rows: Mapping[str, Ints]


def xy(
    results: xr.Dataset | Mapping[str, xr.Dataset],
    y: str | Sequence[str],
    x: str = "time",
    *,
    parts: Sequence[str] = (),
    sets: Sequence[str] = (),
    nodes: Sequence[int] = (),
    elements: Sequence[int] = (),
    take: str | None = None,
    log: bool = False,
    model: Model | None = None,
    title: str = "",
) -> Any:
    """A figure of quantities ``y`` over ``x``, axes below each other for each of them.

    results    a dataset, or label -> dataset
    y, x       plot variables, components ("stress:zz"), principal values ("stress:first"), element fields; ``x`` is the
               time by default
    parts, sets, nodes, elements   a line for each: parts or element sets, node sets or surfaces, ids of the file; the
               whole model where none is named
    take       how many values become one: "mean" (over elements by their deformed volume), "sum", "least", "greatest";
               by default sums of forces and means of all else

    log        a scale of ``x`` that shows both a ramp and the relaxation behind it

    Raises InputError where a quantity does not live where it is asked for.
    """
    if take is not None and take not in TAKE:
        raise InputError(f"take {take!r} is none of {', '.join(TAKE)}")
    many: dict[str, Any] = {"": results} if hasattr(results, "data_vars") else dict(results)
    names = [y] if isinstance(y, str) else list(y)
    figure, axes = canvas.grid(len(names), 1, 5.2, 3.4 if len(names) == 1 else 2.6, sharex=True)
    first = next(iter(many.values()))
    base = [quantity(first, n, model) for n in names]
    for ax, name, like in zip(axes[:, 0], names, base):
        k = 0
        for label, ds in many.items():
            for place in places(ds, parts, sets, nodes, elements):
                v = quantity(ds, name, model)
                a, b = _abscissa(ds, x, place, take, model), _in(curve(v, place, take), v, like)
                text = ", ".join(w for w in (label, place.name) if w)
                mark = "o" if len(b) <= _MARKED else ""
                ax.plot(a, b, marker=mark, ms=3, label=text, **canvas.line_style(k))
                k += 1
        ax.set_ylabel(canvas.labelled(_how(like, take, parts, sets, nodes, elements), like.units))
        ax.margins(x=0.02)
        if log:
            shown = np.abs(np.concatenate([np.asarray(line.get_xdata()) for line in ax.lines]))
            ax.set_xscale("symlog", linthresh=shown[shown > 0].min(initial=1e300) % 1e300 or 1.0, linscale=0.3)
        if k > 1:
            ax.legend(frameon=False, **(dict(loc="upper left", bbox_to_anchor=(1, 1)) if k > 4 else {}))
    axes[-1, 0].set_xlabel(_x_label(first, x, model))
    figure.suptitle(title)
    return figure


def places(
    ds: xr.Dataset, parts: Sequence[str], sets: Sequence[str], nodes: Sequence[int], elements: Sequence[int]
) -> list[Place]:
    """Where lines are of. Raises InputError that names what there is."""
    from febkit.metrics.selection import part_names, part_rows
    from febkit.results import mesh, subsets

    out = []
    for p in parts:
        domain = [k for k, n in enumerate(part_names(ds)) if n == p]
        out.append(Place(p, {"element": part_rows(ds, p), "domain": np.array(domain, dtype=np.int64)}))
    surfaces = mesh.surfaces(ds)
    for s in sets:
        rows = {"node": subsets.node_set(ds, s)}
        if s in surfaces:
            at = list(surfaces).index(s)
            start = sum(len(f) for f in list(surfaces.values())[:at])
            rows |= {"facet": np.arange(start, start + len(surfaces[s])), "surface": np.array([at])}
        out.append(Place(s, rows))
    for kind, ids in (("node", nodes), ("element", elements)):
        for number in ids:
            out.append(Place(f"{kind} {number}", {kind: ds.febkit._row(kind, number)}))
    return out or [Place("", {})]


def curve(q: Quantity, place: Place, take: str | None = None) -> Floats:
    """(time,) of a quantity at a place."""
    rows = _rows(q, place)
    take = take or _usual(q)
    v = q.history(rows)
    if not v.shape[1]:
        raise InputError(f"{place.name or 'the model'} holds nothing that {q.name} lives on")
    if take == "mean":
        return _mean(v, _weights(q, rows, v))
    reduce: Any = {"sum": np.nansum, "least": np.nanmin, "greatest": np.nanmax}[take]
    empty = np.asarray(~np.isfinite(v).any(axis=1))
    return np.asarray(np.where(empty, np.nan, reduce(np.where(empty[:, None], 0.0, v), axis=1)))


def _rows(q: Quantity, place: Place) -> Ints | None:
    if not place.rows or not q.place:
        return None
    if q.place in place.rows:
        return place.rows[q.place]
    if q.place == "node" and "element" in place.rows:
        conn = np.asarray(q.ds["connectivity"].values)[place.rows["element"]]
        return np.unique(conn[conn >= 0])
    asked = {"node": "node set", "element": "part", "domain": "part"}.get(q.place, "surface")
    raise InputError(f"{q.name} lives on {q.place}s: ask for it at a {asked}, not at {place.name}")


def _usual(q: Quantity) -> str:
    """Forces add up, densities and kinematics do not."""
    symbol = "" if q.variable is None else str(q.variable.attrs.get("febio_units", ""))
    if not symbol and q.variable is not None:
        from febkit.results.variables import unit_symbol

        symbol = unit_symbol(str(q.variable.attrs.get("febio_name", ""))) or ""
    return "sum" if (symbol == "F" and q.place in ("node", "facet")) or q.name == "reaction_forces" else "mean"


def _weights(q: Quantity, rows: Ints | None, v: Floats) -> Floats:
    """(time, n) deformed volumes of solid elements, 1 elsewhere."""
    from febkit.metrics.summary import _volumes
    from febkit.results.cells import SOLIDS
    from febkit.results.mesh import texts

    ds = q.ds
    if q.place == "element":
        rows = np.arange(ds.sizes["element"]) if rows is None else rows
        kinds = {texts(ds, "element_types")[k] for k in np.unique(ds["element_type"].values[rows])}
        if kinds <= SOLIDS:
            return _volumes(ds, rows)
    return np.ones(v.shape)


def _mean(v: Floats, w: Floats) -> Floats:
    w = np.where(np.isfinite(v), w, 0.0)
    with np.errstate(invalid="ignore"):
        return np.asarray((np.where(w > 0, v, 0.0) * w).sum(axis=1) / w.sum(axis=1))


def _in(v: Floats, q: Quantity, like: Quantity) -> Floats:
    """In the units of the first result."""
    return v * units.factor(q.units, like.units) if q.units and like.units and q.units != like.units else v


def _abscissa(ds: xr.Dataset, x: str, place: Place, take: str | None, model: Model | None) -> Floats:
    if x == "time":
        return np.asarray(ds["time"].values, dtype=float)
    return curve(quantity(ds, x, model), place, take)


def _x_label(ds: xr.Dataset, x: str, model: Model | None) -> str:
    if x == "time":
        return canvas.labelled("time", canvas.unit_of(ds["time"]))
    return quantity(ds, x, model).label


def _how(q: Quantity, take: str | None, parts: Any, sets: Any, nodes: Any, elements: Any) -> str:
    """ "mean stress, zz"; without where a single value is drawn."""
    single = not q.place or q.place == "domain" or ((nodes or elements) and not (parts or sets))
    return q.text if single else f"{take or _usual(q)} of {q.text}"
