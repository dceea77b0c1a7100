"""Measured and fitted curves of a fit, and their residuals."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from . import canvas

if TYPE_CHECKING:
    from febkit.fitting import Fit


def fitted(found: Fit, experiments: Sequence[str] | None = None) -> Any:
    """A figure of a fit: for each experiment (all by default) what was measured and fitted, and below it residuals in
    units of their weight: scatter without a trend where the model can tell the data."""
    data = found.data()
    names = list(dict.fromkeys(data["experiment"])) if experiments is None else list(experiments)
    figure, axes = canvas.grid(2, len(names), sharex="col")
    with canvas.style():
        for column, name in zip(axes.T, names):
            rows = data[data["experiment"] == name]
            _panel(column, name, rows)
            column[1].set_xlabel(found.axis(name))
    return figure


def _panel(axes: Any, name: str, rows: Any) -> None:
    top, bottom = axes
    for k, (observed, part) in enumerate(rows.groupby("observed", sort=False)):
        colour = canvas.COLOURS[k % len(canvas.COLOURS)]
        part = part.sort_values("x")
        top.plot(part["x"], part["measured"], "o", color=colour, ms=3, mfc="none", label=f"{observed}, measured")
        top.plot(part["x"], part["fitted"], color=colour, label=f"{observed}, fitted")
        bottom.plot(part["x"], part["residual"], "o", color=colour, ms=3)
    top.set_title(name)
    top.legend()
    bottom.axhline(0.0, color="0.6", lw=0.8)
    bottom.set_ylabel("residual")
