"""What all figures share: a headless canvas, colours, axis labels."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from febkit.files import written
from febkit.metrics.tables import heading
from febkit.model import InputError

if TYPE_CHECKING:
    import xarray as xr

CELL_COLOURS = "viridis"
# colour-blind safe (Okabe and Ito)
COLOURS = ("#000000", "#E69F00", "#56B4E9", "#009E73", "#D55E00", "#CC79A7", "#0072B2", "#F0E442")


def grid(rows: int, columns: int, width: float = 3.2, height: float = 2.3, **options: Any) -> tuple[Any, Any]:
    """A figure drawn without a display, and its axes (rows, columns)."""
    try:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    except ImportError:
        raise InputError('figures need matplotlib: pip install "febkit[plots]"') from None
    figure = Figure(figsize=(width * columns, height * rows), layout="constrained")
    FigureCanvasAgg(figure)
    return figure, figure.subplots(rows, columns, squeeze=False, **options)


def label_of(v: xr.DataArray, metric: str) -> str:
    """Axis label with its unit, where it is known."""
    return heading(metric, unit_of(v))


def unit_of(v: xr.DataArray) -> str:
    return str(v.attrs.get("units", ""))


def time_axis(ax: Any, last: float) -> None:
    """Time from 0 on a scale that shows both the ramp and the relaxation."""
    ax.set_xscale("symlog", linthresh=0.1, linscale=0.4)
    ax.set_xlim(0, last)
    ticks = [0, 0.1, 1, 10, 100]
    ax.set_xticks([t for t in ticks if t <= last * 1.001], [f"{t:g}" for t in ticks if t <= last * 1.001])
    ax.minorticks_off()


def cell_colours(n: int) -> list[Any]:
    from matplotlib import colormaps

    return [colormaps[CELL_COLOURS](0.9 * i / max(n - 1, 1)) for i in range(n)]


def save(figure: Any, path: Any, dpi: int = 150) -> None:
    """Write PNG, PDF or SVG by the path's ending."""
    with written(path) as part:
        figure.savefig(part, dpi=dpi)
