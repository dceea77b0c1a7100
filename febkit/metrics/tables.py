"""Printable tables: text, markdown and CSV from the same rows."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import xarray as xr

HEADINGS = {  # metric -> short heading
    "aspect_ratio_change": "aspect ratio",
    "volumetric_strain": "volumetric strain",
    "effective_strain": "effective strain",
    "effective_stress": "effective stress",
    "max_shear_strain": "max shear strain",
    "mass_exchange_rate": "mass exchange",
    "solute_concentration": "concentration",
    "solute_amount": "amount",
    "solute_exchange_rate": "exchange",
}
SPREAD = ("median", "least", "greatest")


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

    def text(self, width: int | None = None) -> str:
        """Columns in line; where they are wider than ``width``, in bands that each begin with the first column."""
        body = [list(self.columns), *self.cells()]
        wide = [max(len(r[k]) for r in body) for k in range(len(self.columns))]
        lines: list[str] = []
        for band in _bands(wide, width):
            lines += [""] * bool(lines)
            rows = [[r[k].ljust(wide[k]) if k == 0 else r[k].rjust(wide[k]) for k in band] for r in body]
            rows.insert(1, ["-" * wide[k] for k in band])
            lines += ["  ".join(r).rstrip() for r in rows]
        return "\n".join([*([self.title] if self.title else []), *lines, *([self.note] if self.note else [])]) + "\n"

    def csv(self) -> str:
        import csv

        out = io.StringIO()
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(self.columns)
        writer.writerows([["" if v is None else v for v in row] for row in self.rows])
        return out.getvalue()

    def render(self, style: str) -> str:
        """``style`` is "text", "markdown" or "csv"."""
        return {"text": self.text, "markdown": self.markdown, "csv": self.csv}[style]()


def _bands(wide: Sequence[int], width: int | None) -> list[list[int]]:
    """Columns that stand side by side: the first, and as many others as ``width`` has room for, at least one."""
    if not width:
        return [list(range(len(wide)))]
    bands: list[list[int]] = []
    left = -1
    for k in range(1, len(wide)):
        if wide[k] + 2 > left:
            bands.append([0])
            left = width - wide[0]
        bands[-1].append(k)
        left -= wide[k] + 2
    return bands or [[0]]


def _text(v: object) -> str:
    if v is None:
        return ""
    if isinstance(v, (float, np.floating)):
        return "-" if np.isnan(v) else f"{v:.4g}"
    return str(v)


def heading(metric: str, units: str) -> str:
    """Column heading with its unit; without where the value is a pure number, or its unit is not known."""
    if metric.endswith("_uncertainty"):
        return f"± {heading(metric.removesuffix('_uncertainty'), units)}"
    stem, solute, of = metric.partition("[")
    name = HEADINGS.get(stem, stem.replace("_", " ")) + (f" {of[:-1]}" if solute else "")
    if metric == "mass_exchange_rate" and not units:
        name = "volume exchange"  # there is no density without units
    return with_unit(name, units)


def short(metric: str) -> str:
    """The heading without a unit."""
    return HEADINGS.get(metric) or heading(metric, "")


def with_unit(name: str, units: str) -> str:
    """ "stress (kPa)"; the name alone where there is no unit to say."""
    return name if units in ("", "1") else f"{name} ({units})"


def rms_table(results: Sequence[tuple[str, xr.Dataset]], title: str = "RMS difference (normalised)") -> Table:
    """The study's table 2: one row for each (label, :func:`compare` result)."""
    names = [str(m) for m in results[0][1]["metric"].values]
    head = [heading(m, str(u)) for m, u in zip(names, results[0][1]["units"].values)]
    rows = []
    for label, ds in results:
        row: list[object] = [label]
        for m in names:
            if m not in ds["metric"].values:
                row.append(None)
                continue
            r = ds.sel(metric=m)
            row.append(f"{float(r['rms']):.2e} ({float(r['nrms']):.3f})")
        rows.append(row)
    return Table(title, ["", *head], rows)


def limits_table(ds: xr.Dataset, title: str = "Limits of agreement (test - control)") -> Table:
    """Bias, limits and counts of one :func:`compare` result."""
    rows = []
    for m in ds["metric"].values:
        r = ds.sel(metric=m)
        values = [float(r[k]) for k in ("rms", "nrms", "bias", "lower", "upper")]
        rows.append([heading(str(m), str(r["units"].values)), *values, f"{int(r['outside'])}/{int(r['n'])}"])
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
            v = [[f"{float(r[k][i]):.3g}" for k in SPREAD] for i in range(len(head))]
            row = [f"{mid} [{least}, {greatest}]" for mid, least, greatest in v]
            rows.append([label, str(moment), *row])
    return Table(title, ["", "moment", *head], rows)


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
    return Table(title, ["", "moment", *(short(m) for m in names)], rows, note)
