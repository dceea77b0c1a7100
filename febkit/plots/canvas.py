"""What all figures share: a canvas that needs no display and shows itself in notebooks, colours, labels, saving."""

from __future__ import annotations

import io
import re
from functools import cache
from typing import TYPE_CHECKING, Any

from febkit.files import written
from febkit.metrics.tables import heading, with_unit
from febkit.model import InputError

if TYPE_CHECKING:
    import xarray as xr

CELL_COLOURS = "viridis"
FIELD_COLOURS = "viridis"
DPI = 150
_NAMED = 12  # cells up to which a legend names each
# colour-blind safe (Okabe and Ito), without the yellow that is lost on white
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
DASHES = ("-", "--", "-.", ":")
_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_STYLE = {
    "font.size": 9, "axes.titlesize": 10, "axes.labelsize": 9, "xtick.labelsize": 8, "ytick.labelsize": 8,
    "legend.fontsize": 8, "figure.titlesize": 11, "axes.spines.top": False, "axes.spines.right": False,
    "axes.linewidth": 0.8, "lines.linewidth": 1.4, "pdf.fonttype": 42, "axes.formatter.useoffset": False,
}  # fmt: skip


@cache
def _class() -> Any:
    """matplotlib's Figure that a notebook shows without %matplotlib."""
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise InputError('figures need matplotlib: pip install "febkit[plots]"') from None

    class Shown(Figure):
        def _repr_png_(self) -> bytes:
            out = io.BytesIO()
            self.savefig(out, format="png")
            return out.getvalue()

    return Shown


def require() -> None:
    """Raises InputError where there is nothing to draw with."""
    _class()


def blank(width: float, height: float, dpi: float = DPI, layout: str | None = "constrained") -> Any:
    """A figure of this size in inches, drawn without a display."""
    shown = _class()
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    figure = shown(figsize=(width, height), dpi=dpi, layout=layout)
    FigureCanvasAgg(figure)
    return figure


def style() -> Any:
    """The context in which axes are made and figures are saved."""
    _class()
    from matplotlib import rc_context

    return rc_context(_STYLE)


def grid(rows: int, columns: int, width: float = 3.2, height: float = 2.3, **options: Any) -> tuple[Any, Any]:
    """A figure and its axes (rows, columns), each of this size in inches."""
    figure = blank(width * columns, height * rows)
    with style():
        return figure, figure.subplots(rows, columns, squeeze=False, **options)


def label_of(v: xr.DataArray, metric: str) -> str:
    """Axis label with its unit, where it is known."""
    return heading(metric, pretty(unit_of(v)))


def labelled(name: str, unit: str) -> str:
    """ "stress (kPa)"; the name alone where there is no unit to say."""
    return with_unit(name, pretty(unit))


def pretty(unit: str) -> str:
    """A unit as it is printed: "um^3" is "µm³", "degC" "°C"."""
    text = re.sub(r"\^(-?\d+)", lambda m: m[1].translate(_SUPERSCRIPTS), unit)
    text = re.sub(r"\bu(?=(?:m|N|J|W|A|g|mol)(?![a-z]))", "µ", text)
    return text.replace("degC", "°C").replace("deg", "°")


def unit_of(v: xr.DataArray) -> str:
    return str(v.attrs.get("units", ""))


def time_axis(ax: Any, last: float) -> None:
    """Time from 0 on a scale that shows both the ramp and the relaxation."""
    ax.set_xscale("symlog", linthresh=0.1, linscale=0.4)
    ax.set_xlim(0, last)
    ticks = [0, 0.1, 1, 10, 100, 1000, 1e4, 1e5, 1e6]
    ax.set_xticks([t for t in ticks if t <= last * 1.001], [f"{t:g}" for t in ticks if t <= last * 1.001])
    ax.minorticks_off()


def cell_colours(n: int) -> list[Any]:
    from matplotlib import colormaps

    return [colormaps[CELL_COLOURS](0.9 * i / max(n - 1, 1)) for i in range(n)]


def cell_legend(
    figure: Any, names: list[str], colours: list[Any], more: tuple[list[Any], list[str]] = ([], [])
) -> None:
    """Below all axes, what the colours mean: each cell's name, or of many the first and the last; ``more`` before."""
    from matplotlib.lines import Line2D

    n = len(names)
    shown = range(n) if n <= _NAMED else (0, n // 2, n - 1)
    handles = [*more[0], *(Line2D([], [], color=colours[k], lw=2) for k in shown)]
    words = [*more[1], *(names[k] if n <= _NAMED or k != n // 2 else f"… {names[k]} …" for k in shown)]
    columns = max(1, min(len(words), int(figure.get_figwidth() / 1.2)))
    with style():
        figure.legend(handles, words, loc="outside lower center", ncols=columns, frameon=False)


def line_style(k: int) -> dict[str, Any]:
    """Colour and dashes of the k-th line: 28 that differ."""
    return {"color": COLOURS[k % len(COLOURS)], "ls": DASHES[k // len(COLOURS) % len(DASHES)]}


def colour_map(name: str | None) -> Any:
    """matplotlib's colour map of this name. Raises InputError where there is none."""
    _class()
    from matplotlib import colormaps

    try:
        return colormaps[name or FIELD_COLOURS]
    except KeyError:
        from difflib import get_close_matches

        near = get_close_matches(str(name), list(colormaps), 3, 0.5) or ["viridis", "cividis", "coolwarm"]
        raise InputError(f"no colour map is called {name!r}; {', '.join(near)} are some") from None


def save(figure: Any, path: Any, dpi: int | None = None) -> None:
    """Write PNG, PDF or SVG by the path's ending."""
    with written(path) as part, style():
        figure.savefig(part, dpi=dpi or figure.dpi)
