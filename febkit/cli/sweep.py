"""``febkit sweep``: a model at many values of its parameters."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from febkit import process

from . import exits, printing
from .paths import INPUT, Output

if TYPE_CHECKING:
    from febkit.metrics.tables import Table
    from febkit.sampling.result import Swept

FILE = "sweep.nc"
_MANY = 10  # failures that are told one by one


@click.command("sweep", context_settings={"max_content_width": 110})
@click.argument("model", type=INPUT)
@click.option("--vary", "vary", multiple=True, required=True, metavar="PATH=LOW:HIGH",
              help="A parameter by its path, and its range: --vary cartilage.solid.E=0.1:2.")  # fmt: skip
@click.option("--observe", "observe", multiple=True, required=True, metavar="WORDS",
              help='What is kept of each run: "reaction top z", "stress part plug zz", ...')  # fmt: skip
@click.option("--samples", default=64, show_default=True, help="How many.")
@click.option("--design", default="sobol", show_default=True, help="sobol, lhs, random, grid or saltelli.")
@click.option("--seed", default=0, show_default=True, help="Of the design.")
@click.option("--at", metavar="T1,T2,...", help="Times that are met and kept, instead of the model's own states.")
@click.option("--folder", type=click.Path(file_okay=False, path_type=Path),
              help="Where results are kept, so that an interrupted sweep goes on  [default: MODEL.sweep].")  # fmt: skip
@click.option("-o", "--output", type=Output(".nc", ".nc4", ".h5"),
              help=f"The dataset as NetCDF  [default: {FILE} in the folder].")  # fmt: skip
@click.option("--scheduler", default="local", show_default=True,
              help='"local" (Dask on this machine), "serial", or a Dask scheduler: tcp://host:8786.')  # fmt: skip
@click.option("--workers", default=0, help="Runs at a time; as many as fit the machine where none is said.")
@click.option("-t", "--threads", default=1, show_default=True, help="Of each run.")
@click.option("--memory", default=2.0, show_default=True, help="GB that a run may take.")
@click.option("-q", "--quiet", is_flag=True, help="Print nothing but failures.")
def command(
    model: Path, vary: tuple[str, ...], observe: tuple[str, ...], samples: int, design: str, seed: int, at: str | None,
    folder: Path | None, output: Path | None, scheduler: str, workers: int, threads: int, memory: float, quiet: bool,
) -> None:  # fmt: skip
    """Solve MODEL at many values of its parameters, and keep what is observed of each run in one dataset.

    Finished samples are kept under the address of what they were made of, and never solved again. Exit code 1 where
    some did not solve: they are NaN in the dataset, and say why.
    """
    process.one_blas_thread()
    from febkit.model import InputError, Where
    from febkit.sampling.design import told
    from febkit.sampling.sweep import make_sweep, plan
    from febkit.study.config import Resources
    from febkit.study.run import carry_out

    from .study import with_progress

    folder = folder or model.with_suffix(".sweep")
    output = output or folder / FILE
    over = dict(map(told, vary))
    if len(over) < len(vary):
        raise exits.Refused("--vary: a path is given twice; each takes one range")
    times = None if at is None else _times(at)
    try:
        s = make_sweep(model, over, observe, samples=samples, design=design, seed=seed, at=times, threads=threads)
    except InputError as e:
        raise e if e.where is not None else InputError(e.message, Where(str(model))) from None
    work = plan(s, folder, Resources(threads, memory, workers))
    summary = carry_out(work, scheduler) if quiet else with_progress(work, scheduler)
    result = work.result({o.key: o.message for o in summary.failed})
    from febkit.results.netcdf import save

    save(result.dataset, output, engine="netcdf4")
    _tell(result, output, quiet)
    if not result:
        raise click.exceptions.Exit(exits.NO)


def _times(text: str) -> list[float]:
    try:
        return [float(t) for t in text.split(",")]
    except ValueError:
        raise exits.Refused(f"--at {text}: it takes times, as in --at 1,10,100") from None


def _tell(result: Swept, output: Path, quiet: bool) -> None:
    failed = list(result.failed.items())
    for k, why in failed[:_MANY]:
        printing.note(f"sample {k} failed: {why}")
    if failed[_MANY:]:
        printing.note(f"and {len(failed) - _MANY} more")
    if quiet:
        return
    if result.design == "saltelli" and result:
        printing.table(_indices(result))
    printing.say(f"{result!r}; results in {output}")


def _indices(result: Swept) -> Table:
    """Sobol indices at the last time."""
    from febkit.metrics.tables import Table

    found = result.sobol()
    last = found.isel(time=-1) if "time" in found.dims else found
    names = [n for n in last.data_vars if not str(n).endswith(" confidence")]
    rows = [
        [n, p, *(f"{float(last[n].sel(index=i, parameter=p)):.3f}" for i in ("first", "total"))]
        for n in names for p in result.parameters
    ]  # fmt: skip
    return Table("Sobol indices at the last time", ["observable", "parameter", "first", "total"], rows)
