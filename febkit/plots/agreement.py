"""How methods agree with the control: counts outside the limits (fig 6), Bland-Altman, errors by case."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from febkit.metrics.agreement import bland_altman as differences
from febkit.metrics.osmotic import split
from febkit.metrics.tables import short

from . import canvas

if TYPE_CHECKING:
    import xarray as xr


_LIMITS = "95 % limits of agreement"
_HATCHES = ("", "//", "..")


def _names(metrics: Sequence[str]) -> list[str]:
    return [short(m) for m in metrics]


def bland_altman(
    control: xr.Dataset, test: xr.Dataset, metrics: Sequence[str] | None = None, title: str = ""
) -> Any:
    """Difference over mean for each metric, with bias and 95 % limits; a colour for each cell."""
    d, control = differences(control, test, metrics), split(control)
    names = [str(m) for m in d["metric"].values]
    columns = min(3, len(names))
    figure, axes = canvas.grid(-(-len(names) // columns), columns)
    colours = canvas.cell_colours(d.sizes["cell"])
    for ax, m in zip(axes.flat, names):
        one = d.sel(metric=m)
        text = canvas.label_of(control[m], m)
        for k, colour in enumerate(colours):
            ax.scatter(one["mean"][k], one["difference"][k], s=8, color=colour, edgecolor="none")
        for key, style, said in (("bias", "-", "bias"), ("lower", "--", _LIMITS), ("upper", "--", None)):
            ax.axhline(float(one[key]), color="0.3", ls=style, lw=0.9, label=said)
        count = int(one["outside"].sum())
        ax.set_title(f"{text}\n{count} of {one['outside'].size} outside", fontsize=9)
        ax.set_xlabel("mean of both")
        ax.set_ylabel("test − control")
        ax.ticklabel_format(scilimits=(-3, 3))
    for ax in axes.flat[len(names) :]:
        ax.set_axis_off()
    canvas.cell_legend(figure, [str(c) for c in d["cell"].values], colours, axes[0, 0].get_legend_handles_labels())
    figure.suptitle(title)
    return figure


def outside_counts(agreement: Mapping[str, Mapping[str, xr.Dataset]], title: str = "") -> Any:
    """Values outside the limits of agreement (fig 6): a group for each case, a bar for each method.

    ``agreement`` is case -> method -> result of :func:`febkit.metrics.compare`.
    """
    return _bars(agreement, "outside", "values outside limits", title)


def errors(agreement: Mapping[str, Mapping[str, xr.Dataset]], title: str = "") -> Any:
    """Normalised RMS difference by case, method and metric: the study's table 2 as a picture."""
    return _bars(agreement, "nrms", "RMS / range of control", title)


def _bars(agreement: Mapping[str, Mapping[str, xr.Dataset]], key: str, label: str, title: str) -> Any:
    cases = list(agreement)
    methods = list(dict.fromkeys(m for c in cases for m in agreement[c]))
    metrics = [str(m) for m in next(iter(agreement[cases[0]].values()))["metric"].values]
    columns = min(3, len(metrics))
    wide = float(np.clip(0.9 + 0.3 * len(cases) * (len(methods) + 0.5), 2.2, 5.0))
    figure, axes = canvas.grid(-(-len(metrics) // columns), columns, wide)
    width = 0.8 / max(len(methods), 2)  # a single bar is a bar, no wall
    for ax, metric, name in zip(axes.flat, metrics, _names(metrics)):
        for k, method in enumerate(methods):
            v = [
                float(agreement[c][method][key].sel(metric=metric)) if method in agreement[c] else np.nan
                for c in cases
            ]
            place = np.arange(len(cases)) + (k - (len(methods) - 1) / 2) * width
            look = {"color": canvas.COLOURS[k % len(canvas.COLOURS)], "hatch": _HATCHES[k // len(canvas.COLOURS) % 3]}
            ax.bar(place, v, width * 0.92, label=f"order {method}" if method[0].isdigit() else method, **look)
        ax.set_xticks(range(len(cases)), cases)
        ax.set_xlim(-0.6, len(cases) - 0.4)
        if not any(float(b.get_height() or 0) > 0 for b in ax.patches):
            ax.set_ylim(0, 1)  # zeros are at the foot
        if key == "outside":
            ax.yaxis.get_major_locator().set_params(integer=True)
        ax.set_title(name)
    for ax in axes[:, 0]:
        ax.set_ylabel(label)
    for ax in axes.flat[len(metrics) :]:
        ax.set_axis_off()
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=columns, frameon=False)
    figure.suptitle(title)
    return figure


def convergence(
    size: Sequence[float],
    error: Mapping[str, Sequence[float]],
    x_label: str = "element size",
    y_label: str = "error",
    slopes: Sequence[float] = (1.0, 2.0),
    title: str = "",
) -> Any:
    """Errors over element or step size on logarithmic axes, with the measured order of each line."""
    figure, axes = canvas.grid(1, 1, 4.8, 3.6)
    ax, h = axes[0, 0], np.asarray(size, dtype=float)
    least = np.inf
    for k, (label, e) in enumerate(error.items()):
        y = np.asarray(e, dtype=float)
        order = np.polyfit(np.log(h), np.log(y), 1)[0] if len(h) > 1 else np.nan
        ax.loglog(
            h, e, marker="os^Dv"[k % 5], ms=4, label=f"{label}: {order:.2f}", **canvas.line_style(k)
        )
        least = min(least, float(y.min()))
    for p in slopes:
        ax.loglog(h, 0.6 * least * (h / h.min()) ** p, color="0.7", lw=0.8, ls=":", zorder=0)
        end = (h.max(), 0.6 * least * (h.max() / h.min()) ** p)
        ax.annotate(f"slope {p:g}", end, (3, 0), textcoords="offset points", fontsize=7, color="0.4", va="center")
    ax.set_xlabel(x_label)
    ax.set_ylabel(y_label)
    ax.legend(fontsize=8, frameon=False, title="measured order")
    ax.set_title(title)
    return figure
