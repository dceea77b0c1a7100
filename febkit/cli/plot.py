"""``febkit plot``: the study's figures from metrics and results."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from . import printing, units
from .labels import names as _names
from .numbers import FINITE, POSITIVE
from .outputs import check
from .paths import INPUT, Output

_OUT = click.option(
    "-o",
    "--output",
    type=Output(".png", ".pdf", ".svg"),
    required=True,
    help="PNG, PDF or SVG to write.",
)
_LABELS = click.option("-l", "--label", "labels", multiple=True, help="Names of the files, in order.")
_TITLE = click.option("--title", default="", help="Title of the figure.")


@click.group("plot", context_settings={"max_content_width": 110})
def command() -> None:
    """Draw figures without a display. FILES are metrics (.nc) or results (.xplt)."""


@command.command()
@click.argument("files", nargs=-1, required=True, type=INPUT)
@click.option("-m", "--metric", "metrics", multiple=True, help="Metrics to draw [default: all].")
@click.option("--until", type=POSITIVE, help="Last time shown.")
@_LABELS
@units.OPTION
@_TITLE
@_OUT
def histories(
    files: tuple[Path, ...],
    metrics: tuple[str, ...],
    until: float | None,
    labels: tuple[str, ...],
    title: str,
    output: Path,
    units: str | None,
) -> None:
    """Each metric over time, a line for each cell, a column for each file."""
    from febkit import plots

    _apart(output, *files)
    _save(plots.histories(_measured(files, labels, units), metrics or None, until, title), output)


@command.command()
@click.argument("files", nargs=-1, required=True, type=INPUT)
@click.option("--until", type=POSITIVE, default=1.0, show_default=True, help="Last time shown.")
@_LABELS
@units.OPTION
@_TITLE
@_OUT
def exchange(
    files: tuple[Path, ...], until: float, labels: tuple[str, ...], title: str, output: Path, units: str | None
) -> None:
    """Mass exchange rate over the first second."""
    from febkit import plots

    _apart(output, *files)
    _save(plots.early_exchange(_measured(files, labels, units), until, title), output)


@command.command("bland-altman")
@click.argument("control", type=INPUT)
@click.argument("test", type=INPUT)
@units.OPTION
@_TITLE
@_OUT
def bland_altman(control: Path, test: Path, title: str, output: Path, units: str | None) -> None:
    """Differences over means with limits of agreement, for each metric."""
    from febkit import plots

    from .compare import measured

    _apart(output, control, test)
    _save(plots.bland_altman(measured(control, units), measured(test, units), title=title), output)


@command.command()
@click.argument("control", type=INPUT)
@click.argument("tests", nargs=-1, required=True, type=INPUT)
@click.option("--outside", is_flag=True, help="Count values outside the limits instead.")
@_LABELS
@units.OPTION
@_TITLE
@_OUT
def errors(
    control: Path,
    tests: tuple[Path, ...],
    outside: bool,
    labels: tuple[str, ...],
    title: str,
    output: Path,
    units: str | None,
) -> None:
    """Normalised RMS difference to CONTROL of each file and metric."""
    from febkit import metrics, plots

    from .compare import measured

    _apart(output, control, *tests)
    a = measured(control, units)
    agreed = {control.stem: {n: metrics.compare(a, b) for n, b in _measured(tests, labels, units).items()}}
    _save((plots.outside_counts if outside else plots.errors)(agreed, title), output)


@command.command()
@click.argument("files", nargs=-1, required=True, type=INPUT)
@click.option("-f", "--field", default="effective_strain", show_default=True, help="Element field.")
@click.option("-t", "--time", type=FINITE, help="Time [default: the last].")
@click.option("--normal", type=click.Choice(["x", "y", "z"]), default="y", show_default=True)
@click.option("--at", type=FINITE, default=0.0, show_default=True, help="Where the plane cuts its normal.")
@click.option("-p", "--part", "parts", multiple=True, help="Parts shown [default: all].")
@click.option("--window", type=FINITE, nargs=4, help="Left, right, bottom and top of the picture.")
@click.option("--no-arrows", is_flag=True, help="Leave out the arrows of fluid flux.")
@_LABELS
@units.OPTION
@_TITLE
@_OUT
def section(
    files: tuple[Path, ...],
    field: str,
    time: float | None,
    normal: str,
    at: float,
    parts: tuple[str, ...],
    window: tuple[float, float, float, float] | None,
    no_arrows: bool,
    labels: tuple[str, ...],
    title: str,
    output: Path,
    units: str | None,
) -> None:
    """A field on a cross-section of the deformed mesh, with arrows of fluid flux. FILES are results."""
    from febkit import plots

    from .metrics import opened

    if window is not None and not (window[0] < window[1] and window[2] < window[3]):
        raise click.UsageError("--window LEFT RIGHT BOTTOM TOP: left must lie below right, bottom below top")
    _apart(output, *files)
    data = {name: opened(f, units=units) for name, f in zip(_names(files, labels), files)}
    when = float(next(iter(data.values()))[0]["time"].values[-1]) if time is None else time
    _save(
        plots.sections(data, field, when, normal, at, parts or None, not no_arrows, title, window=window),
        output,
    )


@command.command()
@click.argument("results", type=INPUT)
@click.option(
    "-v",
    "--variable",
    default="displacement:magnitude",
    show_default=True,
    help='Plot variable or element field: "effective fluid pressure", "stress:xx", "effective_strain".',
)
@click.option("-t", "--time", type=FINITE, help="Time [default: the last].")
@click.option("--plane", metavar="AXIS=AT", help='Cut the body open: "x=0" [default: the whole body].')
@click.option("--arrows", metavar="VECTOR", help='Vector drawn as arrows: "fluid flux".')
@click.option("-p", "--part", "parts", multiple=True, help='Parts shown; globs work: "cell*" [default: all].')
@click.option("-m", "--model", type=INPUT, help="Model of the run [default: .feb beside RESULTS].")
@click.option("--limits", type=FINITE, nargs=2, help="Ends of the colours [default: 1 % and 99 % quantiles].")
@click.option("--no-edges", is_flag=True, help="Leave out the edges of the elements.")
@click.option("--size", type=click.IntRange(1, 20_000), nargs=2, default=(1200, 900), show_default=True, help="Pixels.")
@units.OPTION
@_TITLE
@click.option(
    "-o", "--output", type=Output(".png"), required=True, help="PNG to write."
)
def scene(
    results: Path,
    variable: str,
    time: float | None,
    plane: str | None,
    arrows: str | None,
    parts: tuple[str, ...],
    model: Path | None,
    limits: tuple[float, float] | None,
    no_edges: bool,
    size: tuple[int, int],
    title: str,
    output: Path,
    units: str | None,
) -> None:
    """A variable on the deformed mesh in three dimensions, whole or cut open (needs febkit[scenes]).

    \b
    febkit plot scene run.xplt -v "effective fluid pressure" --plane x=0 --arrows "fluid flux" -o out.png
    """
    from febkit import plots

    from .metrics import opened

    if limits is not None and not limits[0] < limits[1]:
        raise click.UsageError("--limits LOW HIGH: low must lie below high")
    _apart(output, results, *([model] if model else []))
    ds, m = opened(results, model, units)
    plots.scene(
        ds, output, variable, time, plane, parts or None, arrows, m, limits, not no_edges, size, title
    )
    printing.say(f"wrote {output}")


def _measured(files: tuple[Path, ...], labels: tuple[str, ...], units: str | None) -> dict[str, Any]:
    from .compare import measured

    return {name: measured(f, units) for name, f in zip(_names(files, labels), files)}


def _apart(output: Path, *inputs: Path) -> None:
    check([output], [p for f in inputs for p in (f, f.with_suffix(".feb"))])


def _save(figure: Any, output: Path) -> None:
    from febkit import plots

    plots.save(figure, output)
    printing.say(f"wrote {output}")
