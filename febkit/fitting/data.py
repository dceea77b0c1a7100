"""What was measured, from arrays, pandas, xarray or a file of comma-separated values."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from febkit.model import InputError, Where
from febkit.model.values import spells_number

Floats = NDArray[np.float64]
Columns = dict[str, tuple[Floats, Floats]]
WANTED = "data are (x, y), an array (n, 2), a Series or DataFrame, a DataArray or Dataset, or the path of a .csv file"


def columns(data: Any, names: Sequence[str]) -> Columns:
    """x and y of each observable by its name.

    The first column, the index or the one coordinate is x (time, in most cases). Columns that are called as observables
    are theirs; else they follow in the observables' order. Rows in which y is nan, or blank in a file, are left out.
    """
    if isinstance(data, (str, PathLike)):
        found = _file(Path(data))
    elif hasattr(data, "data_vars"):
        found = {str(n): _array(v) for n, v in data.data_vars.items()}
    elif hasattr(data, "dims") and hasattr(data, "coords"):
        found = {str(data.name): _array(data)}
    elif hasattr(data, "columns") and hasattr(data, "index"):
        found = _frame(data)
    elif hasattr(data, "index") and hasattr(data, "to_numpy"):
        found = {str(data.name): (_numbers(data.index), _numbers(data))}
    else:
        found = _plain(data)
    if set(names) <= found.keys():
        found = {n: found[n] for n in names}
    elif len(found) != len(names):
        raise InputError(f"the data have {len(found)} columns ({', '.join(found) or 'none'}) beside x, and "
                         f"{len(names)} are observed ({', '.join(names)})")  # fmt: skip
    return {n: _clean(n, *pair) for n, pair in zip(names, found.values())}


def _numbers(values: Any) -> Floats:
    try:
        return np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        raise InputError(f"data must be numbers; {WANTED}") from None


def _plain(data: Any) -> Columns:
    """(x, y, ...) or an array (n, columns)."""
    a = [_numbers(v) for v in data] if isinstance(data, (tuple, list)) else _numbers(data)
    if isinstance(a, list) and isinstance(data, list):
        a = _numbers(data)
    parts = list(a) if isinstance(a, list) else list(a.T) if a.ndim == 2 else []
    if len(parts) < 2 or any(p.ndim != 1 or len(p) != len(parts[0]) for p in parts):
        raise InputError(WANTED)
    return {str(k): (parts[0], y) for k, y in enumerate(parts[1:], 1)}


def _array(v: Any) -> tuple[Floats, Floats]:
    if v.ndim != 1:
        raise InputError(f"data {v.name!r} have the dimensions {', '.join(map(str, v.dims))}: one is wanted")
    return _numbers(v[v.dims[0]].values), _numbers(v.values)


def _frame(frame: Any) -> Columns:
    """The first column is x where it is called time, t or x, the index elsewhere."""
    first, *rest = list(frame.columns)
    if str(first).strip().lower() in ("time", "t", "x"):
        x = _numbers(frame[first])
    else:
        x, rest = _numbers(frame.index), [first, *rest]
    return {str(c): (x, _numbers(frame[c])) for c in rest}


def _file(path: Path) -> Columns:
    """Comma-separated values, under a line of names or not; what begins with # does not count."""
    where = Where(str(path))
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as e:
        raise InputError(f"cannot read the data: {getattr(e, 'strerror', None) or e}", where) from None
    rows = [(k, r) for k, r in enumerate(csv.reader(lines), 1) if r and not r[0].lstrip().startswith("#")]
    names: list[str] = []
    if rows and not spells_number(rows[0][1][0]):
        names = [c.strip() for c in rows.pop(0)[1]]
    table = []
    for line, row in rows:
        if len(row) != len(rows[0][1]) or (names and len(row) != len(names)):
            raise InputError(f"{len(row)} values, in the first row {len(rows[0][1])}", Where(str(path), line))
        try:
            table.append([float(c) if c.strip() else np.nan for c in row])
        except ValueError:
            raise InputError(f"{','.join(row)!r} are no numbers", Where(str(path), line)) from None
        if np.isinf(table[-1]).any():
            raise InputError(f"{','.join(row)!r} has a value that is not finite", Where(str(path), line))
    a = np.array(table)
    if a.ndim != 2 or a.shape[1] < 2:
        raise InputError("two columns at least are wanted: x, y", where)
    return {n: (a[:, 0], y) for n, y in zip(names[1:] or map(str, range(1, a.shape[1])), a.T[1:])}


def _clean(name: str, x: Floats, y: Floats) -> tuple[Floats, Floats]:
    if len(x) != len(y):
        raise InputError(f"data of {name}: {len(x)} places for {len(y)} values")
    if np.isinf(y).any():
        raise InputError(f"data of {name} have a value that is not finite")
    keep = np.isfinite(y)
    if not keep.any() or not np.isfinite(x[keep]).all():
        raise InputError(f"data of {name} have no finite " + ("x" if keep.any() else "values"))
    return x[keep], y[keep]
