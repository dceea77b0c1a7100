"""Long lists of rows ``<tag id="1">a,b,c</tag>`` read at once by numpy, without a node per row."""

from __future__ import annotations

import re
import warnings

import numpy as np
from numpy.typing import NDArray

from febkit.record import record

_ROW = re.compile(rb'\s*<([A-Za-z][\w.]*)[ \t]+(id|lid)[ \t]*=[ \t]*"')
_FIRST_VALUE = re.compile(rb'"\s*>([^<]*)</')


@record
class Table:
    """Rows of one tag with one integer attribute and a fixed count of numbers.

    ``labels`` (row,) are the attributes, ``values`` (row, column) the numbers; ``start``, ``end`` are
    the bytes of the rows in the file.
    """

    tag: str
    attr: str
    labels: NDArray[np.int64]
    values: NDArray[np.float64]
    start: int
    end: int


def numbers(text: bytes | str) -> NDArray[np.float64] | None:
    """Numbers separated by blanks, or None where anything else is met."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            return np.fromstring(text, dtype=float, sep=" ")  # type: ignore[call-overload, no-any-return]
        except (DeprecationWarning, ValueError):
            return None


def parse(data: bytes, start: int, end: int) -> Table | None:
    """The rows in ``data[start:end]``, or None where they are not regular (then XML reads them).

    A NaN is put in front of each row: columns line up only where every row has as many numbers.
    """
    first = _ROW.match(data, start, end)
    if first is None:
        return None
    value = _FIRST_VALUE.search(data, first.start(), end)
    if value is None:
        return None
    tag, attr = first.group(1), first.group(2)
    columns = value.group(1).count(b",") + 1
    body = data[start:end]
    rows = body.count(b"</")
    if rows < 8 or body.count(b"<") != 2 * rows or body.count(b",") != rows * (columns - 1):
        return None
    opening = first.group(0).lstrip()
    for old, new in ((opening, b" nan "), (b'">', b" "), (b"</" + tag + b">", b" "), (b",", b" ")):
        body = body.replace(old, new)
    flat = numbers(body)
    if flat is None or flat.size != rows * (columns + 2):
        return None
    grid = flat.reshape(rows, columns + 2)
    labels, values = grid[:, 1], grid[:, 2:]
    if not (np.isnan(grid[:, 0]).all() and np.isfinite(grid[:, 1:]).all()):
        return None
    if (labels != np.rint(labels)).any() or (np.abs(labels) > 2**53).any():
        return None
    return Table(tag.decode(), attr.decode(), labels.astype(np.int64), values, start, end)
