"""``febkit metrics``: measure the cells of a result, or summarise a variable over parts."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from . import printing, units
from .numbers import FINITE, POSITIVE, Finite
from .outputs import check
from .paths import INPUT, Output
from .units import UNKNOWN

if TYPE_CHECKING:
    import xarray as xr

    from febkit.model import Model


@click.command("metrics", context_settings={"max_content_width": 110})
@click.argument("results", type=INPUT)
@click.option(
    "-m",
    "--model",
    type=INPUT,
    help="The model of the run, for stress and flux at integration points [default: .feb beside RESULTS].",
)
@click.option(
    "-c", "--cells", multiple=True, metavar="NAME", help='Parts or sets that are cells; globs work: "cell*".'
)
@click.option(
    "--sides",
    type=click.Choice(["both", "cell"]),
    default="both",
    show_default=True,
    help="Flux on a cell's surface from the elements of both sides, or of the cell alone.",
)
@click.option(
    "--exchange",
    type=click.Choice(["nodal", "consistent"]),
    default="nodal",
    show_default=True,
    help="Mass exchange by nodal fluxes on a cell's surface (the study's), or by the pressure equation of the "
    "elements around it, which is the cell's change of volume on any mesh.",
)
@click.option(
    "--handoff",
    type=INPUT,
    help="Series that drives the model, as febkit boundary --dataset writes it: its estimated error becomes an "
    "uncertainty of each metric.",
)
@click.option("--point", help="Name of the point in --handoff [default: the first].")
@click.option("--density", type=POSITIVE, help="Fluid density in pg per cubic unit of length [default: water].")
@click.option(
    "--at", "times", type=FINITE, multiple=True, metavar="T", help="Times to print [default: the last]."
)
@click.option(
    "-v", "--variable", help='Summarise a plot variable instead: "stress:effective", "fluid_flux:magnitude".'
)
@click.option("-p", "--part", "parts", multiple=True, help="Parts of the summary [default: all].")
@click.option(
    "-q",
    "--quantile",
    "quantiles",
    type=Finite(0, 1),
    multiple=True,
    help="Quantiles of the summary, weighted by deformed volume [default: 0.05 0.25 0.5 0.75 0.95].",
)
@click.option(
    "--fields", is_flag=True, help="Write element fields (strain, stress, flux) instead of cell metrics."
)
@click.option("-o", "--output", type=Output(".nc", ".csv"), help="Write .nc or .csv.")
@printing.STYLE
@units.OPTION
def command(
    results: Path,
    model: Path | None,
    cells: tuple[str, ...],
    sides: str,
    exchange: str,
    handoff: Path | None,
    point: str | None,
    density: float | None,
    times: tuple[float, ...],
    variable: str | None,
    parts: tuple[str, ...],
    quantiles: tuple[float, ...],
    fields: bool,
    output: Path | None,
    style: str,
    units: str | None,
) -> None:
    """Measure each cell of RESULTS at every time: shape, volume, strain, stress, shear, mass exchange; of mixtures with
    solutes, concentrations, amounts and exchange of each, osmolarity, charge, potential, Donnan pressure and swelling.

    \b
    febkit metrics run.xplt                          # cells: parts or sets called cell... or chondrocyte...
    febkit metrics run.xplt -c "chondro*" -o cells.nc
    febkit metrics run.xplt -v stress:effective -p pcm_1 -q 0.5 -q 0.95 --at 0.1 --at 100
    """
    from febkit import metrics
    from febkit.metrics.summary import QUANTILES

    check([output], [results, model, results.with_suffix(".feb"), handoff])
    error = None if handoff is None else _error(handoff, point)
    ds, m = opened(results, model, units)
    if variable:
        data = metrics.summarize(ds, variable, parts or None, quantiles or QUANTILES)
        q = {f"quantile_{x:g}": data["quantiles"].sel(quantile=x) for x in data["quantile"].values}
        data = data.assign({k: v.drop_vars("quantile") for k, v in q.items()})
        _printed(data, ["mean", "least", *q, "greatest"], "part", times, style)
    elif fields:
        data = metrics.element_fields(ds, list(cells) or "*", m)
        if output is None:
            raise click.UsageError("--fields needs -o FILE.nc")
    else:
        data = metrics.cell_metrics(ds, m, list(cells) or None, density, sides, exchange, error)
        _of_cells(data, times, style)
    if "unit_system" not in data.attrs:
        printing.note(UNKNOWN)
    if output is not None:
        _write(data, output)
        printing.note(f"wrote {output}")


def opened(
    results: Path, model: Path | None = None, units: str | None = None
) -> tuple[xr.Dataset, Model | None]:
    """A result, and its model: the one given, or the .feb of the same name beside it.

    ``units`` are those of a result that names none; else those that its model names.
    """
    from febkit import open_results
    from febkit.feb import read
    from febkit.results.dataset import name_units
    from febkit.units import one, system

    beside = results.with_suffix(".feb")
    path = model or (beside if beside.is_file() else None)
    found = read(path) if path else None
    ds = open_results(results, units=units)
    name = one(ds.attrs.get("unit_system"), found.units if found else None, what=f"{results} and {path}")
    if system(name):
        name_units(ds, name)
    return ds, found


def _error(path: Path, point: str | None) -> xr.Dataset:
    """The estimated error over time of a series' hand-off at a point."""
    from febkit.coupling import estimate, read_driving
    from febkit.model import InputError

    driving = read_driving(path)
    names = [str(n) for n in driving["point"].values]
    if point is not None and point not in names:
        raise InputError(f"{path} has no point {point!r}: there is {', '.join(names)}")
    return estimate(driving, 0 if point is None else names.index(point))


def _of_cells(data: xr.Dataset, times: tuple[float, ...], style: str) -> None:
    """Print the study's six and, of mixtures, what the cells hold."""
    from febkit import metrics
    from febkit.metrics import osmotic

    flat = osmotic.split(data)
    _printed(flat, [k for k in metrics.METRICS if k in flat], "cell", times, style)
    unsure = [f"{k}_uncertainty" for k in metrics.METRICS if f"{k}_uncertainty" in flat]
    if unsure:
        printing.note(f"uncertainty: {data.attrs['uncertainty']}")
        _printed(flat, unsure, "cell", times, style)
    held = list(osmotic.names(flat))
    if held:
        _printed(flat, held, "cell", times, style)
    _notes(data)


def _printed(data: xr.Dataset, names: list[str], dim: str, times: tuple[float, ...], style: str) -> None:
    import numpy as np

    from febkit.metrics.tables import Table, heading
    from febkit.results.subsets import state_at

    t = np.asarray(data["time"].values, dtype=float)
    head = [heading(n, str(data[n].attrs.get("units", ""))) for n in names]
    unit = str(data["time"].attrs.get("units", ""))
    for want in times or (None,):
        k = state_at(t, want, 1e-3, 1e-3)
        rows = [
            [str(c), *(float(data[n].isel(time=k).sel({dim: c})) for n in names)]
            for c in data[dim].values
        ]
        printing.table(Table(f"t = {t[k]:g} {unit}".rstrip(), [dim, *head], rows), style)



def _notes(data: xr.Dataset) -> None:
    said: dict[str, list[str]] = {}
    for name in data.data_vars:
        how = data[name].attrs.get("how")
        if how:
            said.setdefault(how, []).append(str(name))
    for how, names in said.items():
        printing.note(f"{', '.join(names)}: {how}")
    if data.attrs.get("missing"):
        printing.note(f"missing: {data.attrs['missing']}")


def _write(data: xr.Dataset, path: Path) -> None:
    from febkit.files import put

    if path.suffix == ".csv":
        from febkit.metrics.osmotic import split

        data = split(data)
        flat = data[[k for k in data.data_vars if data[k].ndim == 2]]
        put(path, _csv(flat).encode())
    else:
        from febkit.results.netcdf import save

        save(data, path)


def _csv(data: xr.Dataset) -> str:
    from febkit.metrics.tables import Table, with_unit

    names = [str(k) for k in data.data_vars]
    head = [with_unit(str(k), str(data[k].attrs.get("units", ""))) for k in (*data[names[0]].dims, *names)]
    dims = data[names[0]].dims
    stack = {n: data[n].transpose(*dims).values.ravel() for n in names}
    a, b = (data[d].values for d in dims)
    rows = [
        [x, y, *(stack[n][i * len(b) + j] for n in names)] for i, x in enumerate(a) for j, y in enumerate(b)
    ]
    return Table("", head, rows).csv()
