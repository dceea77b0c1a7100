"""Printable tables: text, markdown, CSV and rich from the same rows."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import xarray as xr

# metric -> short heading, scale to the unit printed, that unit (for a model in mm, N, s)
HEADINGS = {
    "aspect_ratio_change": ("aspect ratio", 1.0, ""),
    "volumetric_strain": ("volumetric strain", 1.0, ""),
    "effective_strain": ("effective strain", 1.0, ""),
    "effective_stress": ("effective stress", 1.0, None),
    "max_shear_strain": ("max shear strain", 1.0, ""),
    "mass_exchange_rate": ("mass exchange", 1.0, None),
}
SPREAD = ("median", "least", "greatest")
_SCALES = {"MPa": (1e3, "kPa"), "Pa": (1e-3, "kPa")}


@dataclass(frozen=True, slots=True)
class Table:
    """A title, column headings, and rows of text or numbers."""

    title: str
    columns: Sequence[str]
    rows: Sequence[Sequence[object]] = field(default_factory=list)
    note: str = ""

    def cells(self) -> list[list[str]]:
        return [[_text(v) for v in row] for row in self.rows]

    def markdown(self) -> str:
        lines = [f"**{self.title}**", ""] if self.title else []
        lines += ["| " + " | ".join(self.columns) + " |", "|" + "---|" * len(self.columns)]
        lines += ["| " + " | ".join(r) + " |" for r in self.cells()]
        return "\n".join([*lines, *(["", self.note] if self.note else [])]) + "\n"

    def text(self) -> str:
        body = [list(self.columns), *self.cells()]
        width = [max(len(r[k]) for r in body) for k in range(len(self.columns))]
        lines = ["  ".join([r[0].ljust(width[0]), *map(str.rjust, r[1:], width[1:])]) for r in body]
        lines.insert(1, "  ".join("-" * w for w in width))
        return "\n".join([t for t in (self.title, *lines, self.note) if t]) + "\n"

    def csv(self) -> str:
        import csv

        out = io.StringIO()
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(self.columns)
        writer.writerows([["" if v is None else v for v in row] for row in self.rows])
        return out.getvalue()

    def rich(self) -> Any:
        from rich.table import Table as RichTable

        table = RichTable(title=self.title or None, caption=self.note or None)
        for k, name in enumerate(self.columns):
            table.add_column(name, justify="left" if k == 0 else "right")
        for row in self.cells():
            table.add_row(*row)
        return table

    def render(self, style: str) -> str:
        """``style`` is "text", "markdown" or "csv"."""
        return {"text": self.text, "markdown": self.markdown, "csv": self.csv}[style]()


def _text(v: object) -> str:
    if v is None:
        return ""
    if isinstance(v, (float, np.floating)):
        return "-" if np.isnan(v) else f"{v:.4g}"
    return str(v)


def heading(metric: str, units: str) -> tuple[str, float]:
    """Column heading with its unit, and the factor that brings values to it."""
    name = HEADINGS.get(metric, (metric.replace("_", " "), 1.0, None))[0]
    scale, unit = _SCALES.get(units, (1.0, units))
    return (name if unit in ("", "1") else f"{name} ({unit})"), scale


def rms_table(results: Sequence[tuple[str, xr.Dataset]], title: str = "RMS difference (normalised)") -> Table:
    """The study's table 2: one row for each (label, :func:`compare` result)."""
    names = [str(m) for m in results[0][1]["metric"].values]
    head = [heading(m, str(u)) for m, u in zip(names, results[0][1]["units"].values)]
    rows = []
    for label, ds in results:
        row: list[object] = [label]
        for m, (_, scale) in zip(names, head):
            if m not in ds["metric"].values:
                row.append(None)
                continue
            r = ds.sel(metric=m)
            row.append(f"{float(r['rms']) * scale:.2e} ({float(r['nrms']):.3f})")
        rows.append(row)
    return Table(title, ["", *(h for h, _ in head)], rows)


def limits_table(ds: xr.Dataset, title: str = "Limits of agreement (test - control)") -> Table:
    """Bias, limits and counts of one :func:`compare` result."""
    rows = []
    for m in ds["metric"].values:
        r = ds.sel(metric=m)
        name, scale = heading(str(m), str(r["units"].values))
        rows.append(
            [
                name,
                *(float(r[k]) * scale for k in ("rms",)),
                float(r["nrms"]),
                *(float(r[k]) * scale for k in ("bias", "lower", "upper")),
                f"{int(r['outside'])}/{int(r['n'])}",
            ]
        )
    return Table(title, ["metric", "rms", "normalised", "bias", "lower", "upper", "outside"], rows)


def spread_table(
    results: Sequence[tuple[str, xr.Dataset]], title: str = "Median [least, greatest] over the cells"
) -> Table:
    """One row for each (label, :func:`spread` result) and moment."""
    first = results[0][1]
    head = [heading(str(m), str(u)) for m, u in zip(first["metric"].values, first["units"].values)]
    rows = []
    for label, ds in results:
        for moment in ds["moment"].values:
            r = ds.sel(moment=moment)
            v = [[f"{float(r[k][i]) * s:.3g}" for k in SPREAD] for i, (_, s) in enumerate(head)]
            row = [f"{mid} [{least}, {greatest}]" for mid, least, greatest in v]
            rows.append([label, str(moment), *row])
    return Table(title, ["", "moment", *(h for h, _ in head)], rows)


def rank_table(
    results: Sequence[tuple[str, xr.Dataset]], title: str = "Spearman rank correlation with the control"
) -> Table:
    """The study's table 3: (label, dataset) of :func:`compare_orders`, or of :func:`rank_correlation`."""
    names = [str(m) for m in results[0][1]["metric"].values]
    two = "rho_first" in results[0][1]
    rows = []
    for label, ds in results:
        for moment in ds["moment"].values:
            r = ds.sel(moment=moment)
            rho = [r["rho_first"], r["rho_second"]] if two else [r["rho"]]
            cells = [
                f"{' / '.join(f'{float(v[i]):.2f}' for v in rho)} ({float(r['p'][i]):.2g})"
                for i in range(len(names))
            ]
            rows.append([label, str(moment), *cells])
    first = "first / second, in brackets the p-value of Fisher's z between the two"
    note = first if two else "in brackets the p-value of the correlation"
    return Table(title, ["", "moment", *(HEADINGS.get(m, (m,))[0] for m in names)], rows, note)
