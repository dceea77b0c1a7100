"""``febkit compare``: how well cell models agree with their control."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from . import printing, units
from .labels import names as labels_of
from .numbers import FINITE
from .outputs import check
from .paths import INPUT, Output
from .units import UNKNOWN

if TYPE_CHECKING:
    import xarray as xr


@click.command("compare", context_settings={"max_content_width": 110})
@click.argument("control", type=INPUT)
@click.argument(
    "tests", nargs=-1, required=True, type=INPUT
)
@click.option(
    "-l", "--label", "labels", multiple=True, help="Names of the tests, in order [default: file names]."
)
@click.option(
    "--instantaneous", type=FINITE, default=0.1, show_default=True, help="Time called instantaneous."
)
@click.option(
    "-o",
    "--output",
    type=Output(".nc"),
    help="Write agreement (test, metric) as NetCDF.",
)
@printing.STYLE
@units.OPTION
def command(
    control: Path,
    tests: tuple[Path, ...],
    labels: tuple[str, ...],
    instantaneous: float,
    output: Path | None,
    style: str,
    units: str | None,
) -> None:
    """RMS differences, limits of agreement and ranks of TESTS against CONTROL.

    Files are metrics (.nc of febkit metrics) or results (.xplt, .plt with the .feb beside them).

    \b
    febkit compare control.nc order1.nc order2.nc
    """
    from febkit import metrics
    from febkit.metrics import tables

    names = labels_of(tests, labels)
    check([output], [p for f in (control, *tests) for p in (f, f.with_suffix(".feb"))])
    a = measured(control, units)
    data = {name: metrics.in_units_of(a, measured(t, units)) for name, t in zip(names, tests)}
    if "unit_system" not in a.attrs:
        printing.note(UNKNOWN)
    agreed = [(name, metrics.compare(a, b)) for name, b in data.items()]
    found = [tables.rms_table(agreed)]
    found += [tables.limits_table(r, f"{name}: limits of agreement (test - control)") for name, r in agreed]
    spreads = [(n, metrics.spread(b, instantaneous)) for n, b in [("control", a), *data.items()]]
    found.append(tables.spread_table(spreads))
    if len(data) >= 2:
        first, *others = data.items()
        pairs = [
            (f"{first[0]} / {n}", metrics.compare_orders(a, first[1], b, instantaneous)) for n, b in others
        ]
        found.append(tables.rank_table(pairs))
    else:
        ((name, b),) = data.items()
        found.append(tables.rank_table([(name, metrics.rank_correlation(a, b, instantaneous))]))
    for t in found:
        printing.table(t, style)
    if output is not None:
        import xarray as xr

        from febkit.results.netcdf import save

        save(xr.concat([r for _, r in agreed], xr.DataArray(names, dims="test", name="test")), output)
        printing.note(f"wrote {output}")


def measured(path: Path, units: str | None = None) -> xr.Dataset:
    """Cell metrics from a metrics file, or measured now; ``units`` of a result that names none."""
    from febkit import metrics
    from febkit.results import netcdf

    from .metrics import opened

    if path.suffix.lower() == ".nc":
        with netcdf.opened(path) as ds:
            if "cell" in ds.dims:
                _check_units(path, ds.attrs.get("unit_system"), units)
                return ds.load()
    data: xr.Dataset = metrics.cell_metrics(*opened(path, units=units))
    return data


def _check_units(path: Path, named: str | None, told: str | None) -> None:
    """Metrics are measured in the units of their result, which cannot be told afterwards."""
    from febkit.model import InputError

    if told and named != told:
        said = f"were measured in {named}" if named else "were measured without units"
        raise InputError(f"{path}: these metrics {said}: measure the result again with --units {told}")
