"""``febkit study``: plan, run and report a whole study."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import click

from febkit import process

from . import exits, printing
from .outputs import check
from .paths import INPUT, Output

if TYPE_CHECKING:
    from febkit.study.plan import Plan, Work
    from febkit.study.run import Outcome, Summary

_STUDY = click.argument("study", type=INPUT)
_SET = click.option(
    "--set", "overrides", multiple=True, metavar="TABLE.NAME=VALUE", help="Change an entry of STUDY."
)


@click.group("study", context_settings={"max_content_width": 110})
def command() -> None:
    """Carry out a study described by a TOML file: build, solve, couple, solve, measure, compare.

    Finished steps are kept under the address of what they were made of, and never done again.
    """


@command.command()
@_STUDY
@_SET
@click.option(
    "--scheduler",
    default="local",
    show_default=True,
    help='"local" (Dask on this machine), "serial", or a Dask scheduler such as tcp://host:8786.',
)
@click.option("-q", "--quiet", is_flag=True, help="Print nothing but failures.")
def run(study: Path, overrides: tuple[str, ...], scheduler: str, quiet: bool) -> None:
    """Do what is not done yet. Exit code 1 where a step failed."""
    process.one_blas_thread()
    from febkit.study import carry_out

    plan = _plan(study, overrides)
    if quiet:
        summary = carry_out(plan, scheduler)
    else:
        summary = with_progress(plan, scheduler, tell=printing.say)
    for o in summary.failed:
        printing.note(f"failed: {o.label}: {o.message}")
    if not quiet:
        printing.say(
            f"{len(summary.done)} steps done, {summary.reused} kept, {len(summary.failed)} failed, "
            f"{len(summary.skipped)} waiting for them; results in {plan.study.folder}"
        )
    if not summary.complete:
        raise click.exceptions.Exit(exits.NO)


@command.command()
@_STUDY
@_SET
def status(study: Path, overrides: tuple[str, ...]) -> None:
    """Steps done, failed and to do."""
    from febkit import study as studies
    from febkit.metrics.tables import Table

    plan = _plan(study, overrides)
    columns = ["done", "done, files dropped", "failed", "to do", "seconds"]
    rows = [[r["kind"], *(r.get(c, 0) for c in columns)] for r in studies.status(plan)]
    printing.table(Table(plan.study.name, ["step", *columns], rows))
    for label, why in studies.failures(plan):
        printing.say(f"failed: {label}: {why}")


@command.command()
@_STUDY
@_SET
@click.option(
    "-o",
    "--output",
    type=Output(".nc"),
    help="NetCDF file [default: metrics.nc in the study's folder].",
)
def gather(study: Path, overrides: tuple[str, ...], output: Path | None) -> None:
    """All metrics that there are as one dataset (case, handoff, point, seed, variant, cell, time), place by place."""
    from febkit.study import write_results
    from febkit.study.gather import require_results

    plan = _plan(study, overrides)
    path = output or plan.study.folder / "metrics.nc"
    if output is None:
        require_results(plan)  # else its folder may not be there
    check([path], [study, *(f for s in plan.steps().values() for f in s.files.values())])
    n = write_results(plan, path)
    printing.say(f"wrote {path}: {n} of {len(plan.metrics)} results")


@command.command()
@_STUDY
@_SET
@click.option(
    "-o",
    "--output",
    type=click.Path(file_okay=False, path_type=Path),
    help="Folder for report.md, tables, figures and metrics.nc [default: report/ in the study's folder].",
)
@click.option("--no-figures", is_flag=True, help="Tables and dataset only.")
def report(study: Path, overrides: tuple[str, ...], output: Path | None, no_figures: bool) -> None:
    """Tables 2 and 3, figures 4 to 8, and all metrics in one dataset, of what is done so far.

    Says first whether the published study's pattern comes out; for charged mixtures, how far the hand-off is off.
    """
    from febkit.study import write_report
    from febkit.study.report import first_tables

    plan = _plan(study, overrides)
    for table in first_tables(plan):
        printing.table(table)
    for path in write_report(plan, output or plan.study.folder / "report", figures=not no_figures):
        printing.say(f"wrote {path}")


def _plan(study: Path, overrides: tuple[str, ...]) -> Plan:
    from febkit.study.config import read
    from febkit.study.plan import make_plan

    return make_plan(read(study, overrides))


def with_progress(plan: Work, scheduler: str, tell: Callable[[str], None] | None = None) -> Summary:
    """A bar where there is a terminal, else a line for each step; what is planned is told."""
    from febkit.study.run import carry_out

    if not sys.stdout.isatty():
        return carry_out(plan, scheduler, lambda done, total, o: printing.say(f"[{done}/{total}] {_line(o)}"), tell)
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    with Progress(
        TextColumn("{task.description}", markup=False), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn()
    ) as bar:
        task = bar.add_task("starting", total=None)

        def step(done: int, total: int, o: Outcome) -> None:
            bar.update(task, completed=done, total=total, description=o.label)

        return carry_out(plan, scheduler, step, tell and (lambda text: bar.console.out(text, highlight=False)))


def _line(o: Outcome) -> str:
    return f"{o.label}: {o.state}" + (f" ({o.message})" if o.message else f" in {o.seconds:.1f} s")
