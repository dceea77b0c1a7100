"""The six metrics of every cell at every time (Sibole et al. 2013, eqs 10-18), and those of charged mixtures."""

from __future__ import annotations

from os import PathLike
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from . import exchange as exchanges
from . import flux, osmotic, shape, uncertainty
from . import groups as grouping
from .fields import SCALARS, Sweep
from .kinematics import Group, State
from .scale import Scale, unit_system
from .selection import Cells, Selection, select_cells
from .sources import Sources

if TYPE_CHECKING:
    import xarray as xr

    from febkit.model import Model

Floats = NDArray[np.float64]
Exchange = exchanges.Nodal | exchanges.Consistent

# the six of the study, in the order of its tables
METRICS = (
    "aspect_ratio_change",
    "volumetric_strain",
    "effective_strain",
    "effective_stress",
    "max_shear_strain",
    "mass_exchange_rate",
)
# name -> long name, unit kind, formula
TABLE = {
    "aspect_ratio_change": (
        "aspect ratio change",
        "",
        "L3/L1 - (L3/L1)(reference), L_i = 1/sqrt(lambda_i) of the inertia of element centroids about the "
        "cell's, weighted by V_e(t) (eqs 10-12, as printed; not an ellipsoid's axes)",
    ),
    "volumetric_strain": ("volumetric strain", "", "sum V_e(t) / sum V_e(reference) - 1 (eq 13)"),
    "effective_strain": (
        "effective strain",
        "",
        "sqrt(((E1-E2)^2 + (E2-E3)^2 + (E3-E1)^2)/2) of Green-Lagrange strain at integration points, "
        "mean per element, V_e(t)-weighted mean over the cell (eq 15)",
    ),
    "effective_stress": (
        "effective stress",
        "stress",
        "sqrt(((s1-s2)^2 + (s2-s3)^2 + (s3-s1)^2)/2) of Cauchy stress at integration points, "
        "mean per element, V_e(t)-weighted mean over the cell (eq 14)",
    ),
    "max_shear_strain": (
        "maximum shear strain",
        "",
        "max |Ei - Ej| of Green-Lagrange strain (no factor 1/2, as printed), averaged likewise (eq 16)",
    ),
    "mass_exchange_rate": (
        "mass exchange rate",
        "mass",
        exchanges.Nodal.formula,
    ),
    "volume": ("volume", "volume", "sum V_e(t)"),
    "volume_loss_rate": (
        "mass exchange rate by balance",
        "mass",
        "-rho dV/dt, difference to the state before: what leaves through the surface, by mass balance "
        "(right where every solved step is plotted)",
    ),
    "axes_ratio_change": (
        "ellipsoid axis ratio change",
        "",
        "a_max/a_min - its reference value, a^2 = 5/(2M) (lambda_b + lambda_c - lambda_a) of the "
        "inertia-equivalent ellipsoid, inertia integrated over the cell's deformed volume",
    ),
    "axes": (
        "semi-axes of the inertia-equivalent ellipsoid, shortest first",
        "length",
        "a^2 = 5/(2M) (lambda_b + lambda_c - lambda_a)",
    ),
    "centroid": ("centroid", "length", "sum V_e x_e / sum V_e"),
}


def cell_metrics(
    ds: xr.Dataset,
    model: Model | None = None,
    cells: Cells = None,
    density: float | None = None,
    sides: str = "both",
    exchange: str = "nodal",
    error: xr.Dataset | str | PathLike[str] | None = None,
) -> xr.Dataset:
    """Metrics (cell, time) of each cell of a result.

    ds         result (time, node, element), from FEBio or febkit
    model      the .feb model of the run: materials, for stress and flux at integration points; without it
               the plotfile's element means are used and ``attrs["how"]`` says so. Its units are the result's
    cells      parts, sets, element rows or labels: see :func:`febkit.metrics.select_cells`
    density    fluid density in pg per cubic unit of the model's length; water by default
    sides      nodal flux on a cell's surface is the mean over the elements of the cell ("cell") or of all
               elements at the node ("both")
    exchange   mass exchange from nodal fluxes on the surface ("nodal", the study's), or the flux that the
               discrete pressure equation balances ("consistent"): see :class:`.exchange.Consistent`
    error      of a driven cell model, the estimated error of its hand-off over time (febkit.coupling.estimate, or its
               NetCDF file): adds ``<metric>_uncertainty``, see :mod:`.uncertainty`

    Where the model is of solutes (biphasic-solute, triphasic, multiphasic), what the cells hold as well, by solute
    (cell, time, solute) and altogether: see :data:`febkit.metrics.osmotic.TABLE`.

    Values are in kPa, um, um^3, pg/s, mM (mmol/l), nmol, nmol/s and mV where the
    unit system is known (``attrs["unit_system"]``). Where it is not
    they are plain numbers in units of the model, and without a density the exchange is a rate of volume.

    Raises InputError where cells or displacement are missing, or result and model differ in units. Metrics that
    lack a source are left out and named in ``attrs["missing"]``.
    """
    pick = select_cells(ds, cells)
    system = unit_system(ds, model)
    sources = Sources(ds, model)
    groups = grouping.make(ds, pick.rows, pick.owner, sources.parts or None)
    on = flux.surface(groups, len(pick.names))
    flow = exchanges.make(ds, pick, on, sources, exchange, sides)
    data = _measure(ds, groups, pick, sources, flow)
    rho = density if density is not None else system.water if system else 1.0
    times = np.asarray(ds["time"].values, dtype=float)
    data["volume_loss_rate"] = -rho * _rate(data["volume"], times)
    if "solute_amount" in data:
        data["solute_exchange_rate"] = -_rate(data["solute_amount"], times)
    if flow is not None:
        data["mass_exchange_rate"] *= rho
    out = _dataset(ds, data, pick, sources, Scale(system))
    if density is not None:  # in pg, whatever the length
        for name in {"mass_exchange_rate", "volume_loss_rate"} & set(out):
            out[name].attrs["units"] = "pg/s"
    if flow is not None:
        about: dict[str, object] = {"formula": flow.formula}
        if density is not None or system:
            length = system.units["L"] if system else "unit of length"
            about |= {"density": rho, "density_units": f"pg/{length}^3"}
        about |= flow.about() if exchange == "consistent" else {**flow.about(), "sides": sides}
        out["mass_exchange_rate"].attrs.update(about)
    if error is None:
        return out
    scale = Scale(system)
    return uncertainty.add(out, error, rho * scale.by("mass") / scale.by("volume"))


def _measure(
    ds: xr.Dataset, groups: list[Group], pick: Selection, sources: Sources, exchange: Exchange | None
) -> dict[str, Floats]:
    """Arrays (cell, time[, component]) of everything in :data:`TABLE` that has a source."""
    n, times = len(pick.names), ds.sizes["time"]
    rest = _Moments(n)
    for g in groups:
        rest.add(g, g.at(np.zeros_like(g.X)))
    sweep = Sweep(ds, groups, sources)
    inside = osmotic.Osmotic.make(groups, n, sources)
    raw: dict[str, Floats] = {}

    def put(name: str, t: int, value: Floats) -> None:
        raw.setdefault(name, np.full((n, times, *value.shape[1:]), np.nan))[:, t] = value

    for t, states in sweep:
        now = _Moments(n)
        weighted: dict[str, Floats] = {}
        for k, (g, s) in enumerate(zip(groups, states)):
            now.add(g, s)
            for name, v in sweep.scalars(k, g, s, t).items():
                weighted[name] = weighted.get(name, 0) + shape.sums(g.owner, v * s.volume, n)
        for name in SCALARS:
            if name in weighted:
                put(name, t, weighted[name] / now.volume)
        for name, value in now.compared_with(rest).items():
            put(name, t, value)
        if inside is not None:
            for name, value in inside.at(states, t).items():
                put(name, t, value)
        if exchange is not None:
            put("mass_exchange_rate", t, exchange.outflow(sources.displacement(t), t))
    return raw


class _Moments:
    """Sums over each cell that its shape is made of: of element centroids, and of the whole volume."""

    def __init__(self, cells: int) -> None:
        self.cells = cells
        self.volume = np.zeros(cells)
        self.first, self.second = np.zeros((3, cells)), np.zeros((6, cells))
        self.lumped = np.zeros((6, cells))

    def add(self, g: Group, s: State) -> None:
        V = s.volume
        first, second = shape.second_moments(s.dv, g.at_points(s.x))
        _, lumped = shape.second_moments(V, first / V)
        self.volume += shape.sums(g.owner, V, self.cells)
        self.first += shape.sums(g.owner, first, self.cells)
        self.second += shape.sums(g.owner, second, self.cells)
        self.lumped += shape.sums(g.owner, lumped, self.cells)

    def printed_ratio(self) -> Floats:
        return shape.printed_ratio(shape.central(self.volume, self.first, self.lumped))

    def axes(self) -> Floats:
        return shape.ellipsoid_axes(self.volume, shape.central(self.volume, self.first, self.second))

    def compared_with(self, rest: _Moments) -> dict[str, Floats]:
        axes, axes0 = self.axes(), rest.axes()
        return {
            "aspect_ratio_change": self.printed_ratio() - rest.printed_ratio(),
            "volumetric_strain": self.volume / rest.volume - 1,
            "volume": self.volume,
            "axes": axes,
            "axes_ratio_change": _ratio(axes) - _ratio(axes0),
            "centroid": (self.first / self.volume).T,
        }


def _rate(v: Floats, t: Floats) -> Floats:
    """(cell, time, ...) backward difference; NaN at the first time."""
    out = np.full(v.shape, np.nan)
    with np.errstate(divide="ignore", invalid="ignore"):
        out[:, 1:] = np.diff(v, axis=1) / np.diff(t).reshape(-1, *[1] * (v.ndim - 2))
    return out


def _ratio(axes: Floats) -> Floats:
    """(cell,) longest over shortest; NaN for a cell without width (one linear tetrahedron)."""
    return axes[:, 2] / np.where(axes[:, 0] > 0, axes[:, 0], np.nan)


def _dataset(
    ds: xr.Dataset,
    data: dict[str, Floats],
    pick: Selection,
    sources: Sources,
    scale: Scale,
) -> xr.Dataset:
    import xarray as xr

    dims = {"axes": ("axis",), "centroid": ("xyz",), **dict.fromkeys(osmotic.BY_SOLUTE, ("solute",))}
    out = {}
    for name, (long_name, kind, formula) in (TABLE | osmotic.TABLE).items():
        if name not in data:
            continue
        attrs: dict[str, object] = {"long_name": long_name, **scale.attrs(kind), "formula": formula}
        if sources.notes.of(name):
            attrs["how"] = sources.notes.of(name)
        out[name] = (("cell", "time", *dims.get(name, ())), data[name] * scale.by(kind), attrs)
    missing = [f"{m}: {sources.notes.of(m)}" for m in METRICS if m not in out]
    first = osmotic.SCALARS[0]
    if first not in out and sources.notes.of(first):
        missing.append(f"{first} and what else a mixture holds: {sources.notes.of(first)}")
    counts = np.bincount(pick.owner, minlength=len(pick.names))
    coords = {
        "cell": list(pick.names),
        "time": ("time", np.asarray(ds["time"].values), scale.attrs("time")),
        "xyz": ["x", "y", "z"],
        "elements": ("cell", counts),
        **({"solute": [str(s) for s in ds["solute"].values]} if "solute_amount" in out else {}),
    }
    about = {
        "source": "Sibole et al. 2013, eqs 10-18",
        "reference": "undeformed coordinates",
        "missing": "; ".join(missing),
        **({"unit_system": scale.system.name} if scale.system else {}),
    }
    return xr.Dataset(out, coords=coords, attrs=about)
