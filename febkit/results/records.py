"""Data that a run's ``<logfile>`` section asked for: files of node, element or rigid-body values over time.

A file holds blocks ``*Step = 1``, ``*Time = 0.1``, ``*Data = x;y;z`` and rows ``id value value ...``, with
any delimiter; without comments, rows only, each time step starting at the first id again.
"""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from febkit.model import InputError, Where

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

_HEAD = re.compile(r"^\*?\s*(Step|Time|Data|File|Title)\s*=\s*(.*)$")
_SPLIT = re.compile(r"[\s,;|]+")


@dataclass(frozen=True, slots=True, eq=False)
class Record:
    """Values of some items at one time."""

    step: int | None
    time: float | None
    data: str  # "x;y;z"
    items: np.ndarray
    values: np.ndarray  # (item, quantity)

    @property
    def names(self) -> list[str]:
        return quantity_names(self.data, self.values.shape[1])


def quantity_names(data: str, n: int) -> list[str]:
    """Column names: FEBio's where their number fits."""
    names = [p.strip() for p in data.split(";") if p.strip()]
    return names if len(names) == n else [f"value{i + 1}" for i in range(n)]


def read_records(path: str | os.PathLike[str]) -> list[Record]:
    """All blocks of a data file."""
    where = Where(str(path))
    try:
        lines = Path(path).read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError as e:
        raise InputError(f"cannot read the data file: {e.strerror}", where) from None
    out: list[Record] = []
    head: dict[str, str] = {}
    rows: list[str] = []
    first = 1
    for number, line in enumerate([*lines, "*Step = end"], start=1):
        found = _HEAD.match(line)
        if found is None:
            if line.strip() and not line.startswith("*"):
                first = first if rows else number
                rows.append(line)
            continue
        if rows:
            out += _blocks(head, rows, Where(where.file, first))
            head, rows = {}, []
        head[found[1]] = found[2].strip()
    return out


def _blocks(head: dict[str, str], rows: list[str], where: Where) -> list[Record]:
    table = _table(rows, where)
    items = table[:, 0].astype(np.int64)
    step, time = _int(head.get("Step")), _float(head.get("Time"))
    starts = [0]
    if step is None and time is None:  # no comments: a step begins where the first id comes again
        starts = np.flatnonzero(items == items[0]).tolist()
    ends = [*starts[1:], len(items)]
    data = head.get("Data", "")
    counted = step is None and len(starts) > 1
    return [
        Record(k if counted else step, time, data, items[a:b], table[a:b, 1:])
        for k, (a, b) in enumerate(zip(starts, ends), start=1)
    ]


def _table(rows: list[str], where: Where) -> np.ndarray:
    """Rows of numbers of equal length."""
    width = len(_SPLIT.split(rows[0].strip(" ,;|\t")))
    try:
        flat = np.array(_SPLIT.split(" ".join(r.strip(" ,;|\t") for r in rows)), dtype=np.float64)
    except ValueError as e:
        raise InputError(f"not a row of numbers: {e}", where) from None
    ids = flat[::width]
    if flat.size == width * len(rows) and not (np.abs(ids) < 2.0**53).all():
        raise InputError("a row does not begin with the number of an item", where)
    if flat.size != width * len(rows):
        raise InputError("the rows of a block differ in length", where)
    return flat.reshape(len(rows), width)


def _int(text: str | None) -> int | None:
    try:
        return None if text is None else int(text)
    except ValueError:
        return None


def _float(text: str | None) -> float | None:
    try:
        return None if text is None else float(text)
    except ValueError:
        return None


def in_log(lines: Sequence[str], i: int) -> tuple[Record, int]:
    """A data record within a log, and the line after it."""
    head: dict[str, str] = {}
    rows: list[str] = []
    i += 1
    while i < len(lines):
        line = lines[i].strip()
        found = _HEAD.match(line)
        if found:
            head[found[1]] = found[2].strip()
        elif re.match(r"^[-+.\d]", line) and "File" not in head:
            rows.append(line)
        elif not line.startswith("===") or rows or head:
            break
        i += 1
    try:
        table = _table(rows, Where()) if rows else np.empty((0, 1))
    except InputError:  # text of the user's own format
        table = np.empty((0, 1))
    items = table[:, 0].astype(np.int64)
    step, time = _int(head.get("Step")), _float(head.get("Time"))
    return Record(step, time, head.get("Data", ""), items, table[:, 1:]), i


def read_data(path: str | os.PathLike[str]) -> pd.DataFrame:
    """A data file as a table: step, time, item and one column per quantity."""
    return frame(read_records(path))


def frame(records: Sequence[Record]) -> pd.DataFrame:
    """Records as one table."""
    import pandas as pd

    parts = []
    for r in records:
        part = pd.DataFrame(r.values, columns=r.names)
        part.insert(0, "item", r.items)
        part.insert(0, "time", r.time)
        part.insert(0, "step", r.step)
        parts.append(part)
    return pd.concat(parts, ignore_index=True) if parts else pd.DataFrame(columns=["step", "time", "item"])


def open_data(path: str | os.PathLike[str]) -> xr.Dataset:
    """A data file as a dataset of dimensions (time, item); NaN where an item has no value at a time."""
    import xarray as xr

    table = frame(read_records(path))
    key = "time" if table["time"].notna().all() and len(table) else "step"
    names = [str(c) for c in table.columns if c not in ("step", "time", "item")]
    # two states at one time: the later one stays, as on a curve that FEBio draws
    wide = table.drop_duplicates([key, "item"], keep="last").set_index([key, "item"])[names]
    ds = xr.Dataset.from_dataframe(wide)
    return ds.rename({"step": "time"}) if key == "step" else ds
