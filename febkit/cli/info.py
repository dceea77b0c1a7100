"""``febkit info``: what is in a model, a results file or a log."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import click

from . import printing
from .paths import INPUT

if TYPE_CHECKING:
    from febkit.results.summary import PlotSummary, VariableSummary


@click.command("info", context_settings={"max_content_width": 110})
@click.argument("files", nargs=-1, required=True,
                type=INPUT)
@click.option("--ranges", is_flag=True, help="Ranges over all states, not only the last.")
@click.option("--times", is_flag=True, help="List every time.")
def command(files: tuple[Path, ...], ranges: bool, times: bool) -> None:
    """Say what is in a model (.feb), results (.xplt, .plt, .nc) or a log (.log).

    \b
    febkit info model.feb
    febkit info run.xplt --ranges
    """
    for i, file in enumerate(files):
        if len(files) > 1:
            printing.say(f"{'' if i == 0 else chr(10)}{file}:")
        for line in _lines(file, ranges, times):
            printing.say(line)


def _lines(file: Path, ranges: bool, times: bool) -> Iterator[str]:
    kind = file.suffix.lower()
    if kind == ".feb":
        from febkit.feb import read
        from febkit.modelling.describe import model_lines

        yield from model_lines(read(file))
    elif kind == ".xplt":
        from febkit.results.summary import summarize

        yield from plot_lines(summarize(file, ranges), ranges, times)
    elif kind == ".log":
        yield from _log_lines(file)
    elif kind in (".plt", ".nc", ".nc4", ".h5"):
        from febkit import results

        yield from str(results.open(file)).splitlines()
    else:
        raise click.UsageError(f"{file.name} is none of .feb, .xplt, .plt, .nc, .log")


def plot_lines(s: PlotSummary, every: bool, all_times: bool) -> Iterator[str]:
    """A plotfile in words."""
    from febkit.modelling.describe import sizes_line

    said = [f"plotfile version {s.version:#x}", s.software, f"units {s.units}" if s.units else ""]
    yield ", ".join(x for x in (*said, "compressed" if s.compressed else "") if x)
    yield f"nodes     {s.nodes}"
    yield f"elements  {sum(n for _, _, n, _ in s.parts)}"
    for name, type_, n, material in s.parts:
        yield f"  part {name}: {n} {type_}, material {material}"
    yield from sizes_line("node sets", s.node_sets)
    yield from sizes_line("surfaces", s.surfaces)
    yield from sizes_line("element sets", s.element_sets)
    if s.meshes > 1:
        yield f"meshes    {s.meshes} (sizes are of the last)"
    yield f"states    {len(s.times)}" + (f", t = {s.times[0]:g} to {s.times[-1]:g}" if len(s.times) else "")
    if all_times:
        yield "  " + " ".join(f"{t:g}" for t in s.times)
    if (s.statuses == 2).any():
        yield f"  {int((s.statuses == 2).sum())} states did not converge"
    if s.leftover:
        yield f"  {s.leftover} bytes of a state that is not complete: still being written, or cut"
    yield f"variables (range {'over all states' if every else 'in the last state'})"
    width = max((len(v.name) for v in s.variables), default=0)
    for v in s.variables:
        yield f"  {v.name:<{width}}  {v.section:<7} {v.format:<6} {v.type:<6}  {_range(v)}"


def _range(v: VariableSummary) -> str:
    if all(x != x for x in v.low):
        return "no data"
    spans = [f"{c}[{a:.4g}, {b:.4g}]" for c, a, b in zip(v.components, v.low, v.high)]
    unit = f" {v.units}" if v.units not in ("", "1") else ""
    return " ".join(spans[:9]) + (" ..." if len(spans) > 9 else "") + unit


def _log_lines(file: Path) -> Iterator[str]:
    from febkit.results.log import read_log

    log = read_log(file)
    done = int(log.steps["converged"].sum()) if len(log.steps) else 0
    end = {True: "normal termination", False: "error termination", None: "not finished"}[log.normal]
    yield end
    yield f"time steps  {len(log.steps)} tried, {done} converged"
    if done:
        yield f"last time   {log.steps.loc[log.steps['converged'], 'time'].iloc[-1]:g}"
    yield f"iterations  {len(log.iterations)}"
    for m in log.messages:
        yield f"{m.kind.lower()} (line {m.line}): {m.text}"
    if log.records:
        yield f"data records  {', '.join(dict.fromkeys(r.data for r in log.records))}"
    for k, v in log.summary.items():
        yield f"  {k}: {v:g}"
