"""Time histories of each metric, a line for each cell, control beside the methods (study figs 4, 5, 7)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from febkit.metrics.agreement import in_units_of, usual
from febkit.metrics.osmotic import split
from febkit.metrics.tables import with_unit
from febkit.model import InputError

from . import canvas

if TYPE_CHECKING:
    import xarray as xr


def histories(
    results: Mapping[str, xr.Dataset],
    metrics: Sequence[str] | None = None,
    until: float | None = None,
    title: str = "",
) -> Any:
    """A row of axes for each metric, a column for each result (label -> metrics (cell, time)).

    until  last time shown; None for all, on a scale that shows ramp and relaxation
    """
    first = next(iter(results.values()))
    results = {label: split(in_units_of(first, ds)) for label, ds in results.items()}
    first = split(first)
    names = [m for m in (metrics or usual(first)) if m in first]
    unknown = [m for m in metrics or () if m not in first]
    if unknown or not names:
        what = f"no metric {unknown[0]!r}" if unknown else "no metrics"
        raise InputError(f"there is {what} in the first result; it has {', '.join(map(str, first.data_vars))}")
    wide = 3.4 if len(results) > 1 else 4.6
    figure, axes = canvas.grid(len(names), len(results), wide, 2.0, sharex="col", sharey="row")
    for c, (label, ds) in enumerate(results.items()):
        t = np.asarray(ds["time"].values, dtype=float)
        show = t <= (t.max() if until is None else until * (1 + 1e-6))
        colours = canvas.cell_colours(ds.sizes["cell"])
        for r, m in enumerate(names):
            ax = axes[r, c]
            if m in ds:
                v = ds[m].transpose("cell", "time").values
                for k, colour in enumerate(colours):
                    ax.plot(t[show], v[k, show], color=colour, lw=1)
            if until is None:
                canvas.time_axis(ax, float(t.max()))
            else:
                ax.set_xlim(0, until)
            ax.axhline(0, color="0.7", lw=0.5, zorder=0)
            if c == 0:
                ax.set_ylabel(canvas.label_of(first[m], m))
        axes[0, c].set_title(label)
        axes[-1, c].set_xlabel(with_unit("time", canvas.unit_of(ds["time"])))
    cells = [str(c) for c in first["cell"].values]  # numbers from 0 where they have no names
    canvas.cell_legend(figure, cells, canvas.cell_colours(len(cells)))
    figure.align_ylabels(axes[:, 0])
    figure.suptitle(title)
    return figure


def early_exchange(results: Mapping[str, xr.Dataset], until: float = 1.0, title: str = "") -> Any:
    """Mass exchange rate over the first second (fig 7)."""
    return histories(results, ["mass_exchange_rate"], until, title)
