"""``febkit plot``: figures of metrics and results."""

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
_WHAT = ('Plot variable, component, principal value or element field: "effective fluid pressure", "stress:xx", '
         '"stress:first", "effective_strain".')  # fmt: skip
_MODEL = click.option("-m", "--model", type=INPUT, help="Model of the run [default: .feb beside RESULTS].")
_LIMITS = click.option("--limits", type=FINITE, nargs=2, help="Ends of the colours [default: 1 % and 99 % quantiles].")
_COLOURS = click.option(
    "--colours", "--cmap", "colours", metavar="NAME", help="Colour map of matplotlib [default: viridis]."
)
_SCALE = click.option(
    "--scale", type=FINITE, default=1.0, show_default=True, help="Displacements drawn so many times as large."
)


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
@click.option("-y", "y", multiple=True, required=True, help=_WHAT)
@click.option("-x", "x", default="time", show_default=True, help="Over what.")
@click.option("-p", "--part", "parts", multiple=True, help="Part or element set: a line each.")
@click.option("-s", "--set", "sets", multiple=True, help="Node set or surface: a line each.")
@click.option("-n", "--node", "nodes", multiple=True, type=int, help="Node of this id: a line each.")
@click.option("-e", "--element", "elements", multiple=True, type=int, help="Element of this id: a line each.")
@click.option(
    "--take", type=click.Choice(["mean", "sum", "least", "greatest"]),
    help="How many values become one [default: sums of forces, means of all else].",
)  # fmt: skip
@click.option("--log", is_flag=True, help="A scale of x that shows ramp and relaxation.")
@_MODEL
@_LABELS
@units.OPTION
@_TITLE
@_OUT
def xy(
    files: tuple[Path, ...], y: tuple[str, ...], x: str, parts: tuple[str, ...], sets: tuple[str, ...],
    nodes: tuple[int, ...], elements: tuple[int, ...], take: str | None, log: bool, model: Path | None,
    labels: tuple[str, ...], units: str | None, title: str, output: Path,
) -> None:  # fmt: skip
    """Any variable of parts, sets, nodes or elements over time, or over another variable. FILES are results.

    \b
    febkit plot xy run.xplt -y "reaction forces:z" -s top -o force.png
    febkit plot xy run.xplt -x "displacement:z" -y "stress:zz" -e 7 -o curve.svg
    """
    from febkit import plots

    from .metrics import opened

    _apart(output, *files, *([model] if model else []))
    made = [opened(f, model, units) for f in files]
    data = dict(zip(_names(files, labels), (ds for ds, _ in made)))
    shown = data if len(data) > 1 or labels else next(iter(data.values()))
    _save(
        plots.xy(
            shown, y, x, parts=parts, sets=sets, nodes=nodes, elements=elements, take=take, log=log,
            model=made[0][1], title=title,
        ),
        output,
    )  # fmt: skip


@command.command()
@click.argument("files", nargs=-1, required=True, type=INPUT)
@click.option("-f", "--field", "-v", "--variable", default="effective_strain", show_default=True, help=_WHAT)
@click.option("-t", "--time", type=FINITE, help="Time [default: the last].")
@click.option("--normal", type=click.Choice(["x", "y", "z"]), default="y", show_default=True)
@click.option("--at", type=FINITE, default=0.0, show_default=True, help="Where the plane cuts its normal.")
@click.option("-p", "--part", "parts", multiple=True, help="Parts shown [default: all].")
@click.option("--window", type=FINITE, nargs=4, help="Left, right, bottom and top of the picture.")
@click.option("--no-arrows", is_flag=True, help="Leave out the arrows of fluid flux.")
@_LIMITS
@_COLOURS
@_SCALE
@_LABELS
@units.OPTION
@_TITLE
@_OUT
def section(
    files: tuple[Path, ...], field: str, time: float | None, normal: str, at: float, parts: tuple[str, ...],
    window: tuple[float, float, float, float] | None, no_arrows: bool, limits: tuple[float, float] | None,
    colours: str | None, scale: float, labels: tuple[str, ...], units: str | None, title: str, output: Path,
) -> None:  # fmt: skip
    """A variable on a cross-section of the deformed mesh, with arrows of fluid flux. FILES are results."""
    from febkit import plots

    from .metrics import opened

    if window is not None and not (window[0] < window[1] and window[2] < window[3]):
        raise click.UsageError("--window LEFT RIGHT BOTTOM TOP: left must lie below right, bottom below top")
    _ordered(limits)
    _apart(output, *files)
    data = {name: opened(f, units=units) for name, f in zip(_names(files, labels), files)}
    figure = plots.sections(
        data, field, time, normal, at, parts or None, not no_arrows, title, limits, window, colours, scale
    )
    _save(figure, output)


def _shown(f: Any) -> Any:
    """Options that scenes and movies share."""
    for option in reversed((
        click.option("-v", "--variable", default="displacement:magnitude", show_default=True, help=_WHAT),
        click.option("--plane", metavar="AXIS=AT", help='Cut the body open: "x=0" [default: the whole body].'),
        click.option("--arrows", metavar="VECTOR", help='Vector drawn as arrows: "fluid flux".'),
        click.option("-p", "--part", "parts", multiple=True, help='Parts shown; globs work: "cell*" [default: all].'),
        _MODEL,
        _LIMITS,
        _COLOURS,
        _SCALE,
        click.option("--camera", metavar="VIEW", help='"iso", an axis ("x", "-z"), or degrees: "AZIMUTH,ELEVATION".'),
        click.option("--zoom", type=POSITIVE, default=1.0, show_default=True),
        click.option("--no-edges", is_flag=True, help="Leave out the edges of the elements."),
        units.OPTION,
        _TITLE,
    )):  # fmt: skip
        f = option(f)
    return f


def _size(default: tuple[int, int]) -> Any:
    pixels = click.IntRange(100, 20_000)
    return click.option("--size", type=pixels, nargs=2, default=default, show_default=True, help="Pixels.")


@command.command()
@click.argument("results", type=INPUT)
@click.option("-t", "--time", type=FINITE, help="Time [default: the last].")
@_shown
@_size((1200, 900))
@_OUT
def scene(results: Path, time: float | None, size: tuple[int, int], output: Path, **options: Any) -> None:
    """A variable on the deformed mesh in three dimensions, whole or cut open (needs febkit[scenes]).

    \b
    febkit plot scene run.xplt -v "effective fluid pressure" --plane x=0 --arrows "fluid flux" -o out.png
    """
    from febkit import plots

    ds, shown = _scene(results, output, options)
    _save(plots.scene(ds, time=time, size=size, **shown), output)


@command.command()
@click.argument("results", type=INPUT)
@click.option("-t", "--time", "times", type=FINITE, multiple=True, help="Times shown [default: all states].")
@click.option("--fps", type=POSITIVE, default=10.0, show_default=True, help="States a second.")
@_shown
@_size((800, 600))
@click.option("-o", "--output", type=Output(".gif", ".mp4"), required=True, help="GIF, or MP4 (febkit[movies]).")
def movie(
    results: Path, times: tuple[float, ...], fps: float, size: tuple[int, int], output: Path, **options: Any
) -> None:
    """A scene over time, as an animation (needs febkit[scenes]).

    \b
    febkit plot movie run.xplt -v "stress:zz" --plane y=0 -o run.gif
    """
    from febkit import plots

    ds, shown = _scene(results, output, options)
    plots.movie(ds, output, times=times or None, fps=fps, size=size, **shown)
    printing.say(f"wrote {output}")


def _scene(results: Path, output: Path, options: dict[str, Any]) -> tuple[Any, dict[str, Any]]:
    """The dataset, and the options as :func:`febkit.plots.scene` takes them."""
    from .metrics import opened

    shown = dict(options)
    model, system = shown.pop("model"), shown.pop("units")
    _ordered(shown["limits"])
    _apart(output, results, *([model] if model else []))
    ds, shown["model"] = opened(results, model, system)
    shown["parts"], shown["edges"] = shown["parts"] or None, not shown.pop("no_edges")
    return ds, shown


def _ordered(limits: tuple[float, float] | None) -> None:
    if limits is not None and not limits[0] < limits[1]:
        raise click.UsageError("--limits LOW HIGH: low must lie below high")


def _measured(files: tuple[Path, ...], labels: tuple[str, ...], units: str | None) -> dict[str, Any]:
    from .compare import measured

    return {name: measured(f, units) for name, f in zip(_names(files, labels), files)}


def _apart(output: Path, *inputs: Path) -> None:
    check([output], [p for f in inputs for p in (f, f.with_suffix(".feb"))])


def _save(figure: Any, output: Path) -> None:
    from febkit import plots

    plots.save(figure, output)
    printing.say(f"wrote {output}")
