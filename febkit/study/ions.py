"""Does the hand-off hold when ions move too? Errors of each metric, case and method of a study of charged mixtures."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from febkit.metrics.tables import Table, short

from .plan import Place

if TYPE_CHECKING:
    import xarray as xr


def table(agreed: Mapping[Place, xr.Dataset]) -> Table:
    """RMS difference to the control over the control's range: rows are metrics, columns cases and methods."""
    columns = list(dict.fromkeys((p.case, p.method) for p in agreed))
    metrics = list(dict.fromkeys(str(m) for ds in agreed.values() for m in ds["metric"].values))
    errors = np.array([[_error(agreed, c, m) for c in columns] for m in metrics])
    rows: list[list[object]] = [[short(m), *errors[k]] for k, m in enumerate(metrics)]
    rows.append(["largest", *np.nanmax(errors, axis=0)])
    return Table(
        "Errors of the hand-off, motion and ions",
        ["", *(f"{case} {method}" for case, method in columns)],
        rows,
        "RMS difference to the control over cells and times, over the control's range (eq 20); seeds and points by "
        "their mean. A metric that hardly changes in the control has a small range: its absolute error is in "
        "the next table.",
    )


def _error(agreed: Mapping[Place, xr.Dataset], column: tuple[str, str], metric: str) -> float:
    found = [
        float(ds["nrms"].sel(metric=metric))
        for p, ds in agreed.items()
        if (p.case, p.method) == column and metric in ds["metric"].values
    ]
    return float(np.mean(found)) if found else np.nan
