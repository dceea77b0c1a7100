"""Where a study looks: points one by one, along a line, on a grid or from a CSV file, some in depths of the tissue."""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

from febkit.model import InputError

from .entries import Entries

Point = tuple[float, float, float]
CENTRE: Point = (0.0, 0.0, 0.0)
WAYS = {
    "at": (),
    "file": (),
    "from": ("to", "count"),
    "depth": ("x", "y"),
    "z": ("x", "y"),
}  # first entry: its others


@dataclass(frozen=True, slots=True)
class Points:
    """Points as the file says them; ``depths``: their third number is a normalised depth, 0 at the tissue's top
    (largest z) and 1 at its bottom. ``listed``: named one by one, by ``at`` or ``file``. ``said``: not the centre
    for want of others."""

    rows: tuple[Point, ...]
    depths: bool = False
    listed: bool = True
    said: bool = True


def read_points(t: Entries, base: Path) -> Points:
    """[points]: ``at``; ``file``; ``from``, ``to`` and ``count``; or ``x``, ``y`` and ``z`` or ``depth``, each
    a number, a list or {from, to, count}. The centre where nothing is said. Raises InputError."""
    t.only((*WAYS, "to", "count", "x", "y", "coordinates"))
    ways = [w for w in WAYS if w in t.given] or ["at"]
    extra = [k for k in t.given if k not in (ways[0], *WAYS[ways[0]], "coordinates")]
    if extra:
        raise InputError(
            f"{extra[0]} of [points] does not go with {ways[0]}; points are given by at, by file, by from, to and "
            "count, or by x, y and z or depth",
            t.where,
        )
    depths = ways[0] == "depth" or t.choice("coordinates", "xyz", ("xyz", "depth")) == "depth"
    if ways[0] == "file":
        rows, depths = _file(t, base, depths)
    elif ways[0] == "at":
        rows = [point(r, f"point {k + 1}", t) for k, r in enumerate(t.listed("at", [list(CENTRE)]))]
    elif ways[0] == "from":
        rows = _line(t)
    else:
        third = axis(t, ways[0], None)
        rows = [(x, y, z) for x, y, z in product(axis(t, "x", 0.0), axis(t, "y", 0.0), third)]
    if len(set(rows)) < len(rows):
        k, twice = next((k, p) for k, p in enumerate(rows) if p in rows[:k])
        said = ", ".join(f"{c:g}" for c in twice)
        raise InputError(f"a point is given twice: points {rows.index(twice) + 1} and {k + 1} are ({said})", t.where)
    for x, y, d in rows if depths else ():
        if not 0 <= d <= 1:
            raise InputError(
                f"the point ({x:g}, {y:g}, depth {d:g}) lies outside the tissue: depths go from 0 at its top to 1 "
                "at its bottom",
                t.where,
            )
    return Points(tuple(rows), depths, ways[0] in ("at", "file") and not depths, bool({*WAYS} & set(t.given)))


def _line(t: Entries) -> list[Point]:
    missing = [k for k in ("to", "count") if k not in t.given]
    if missing:
        raise InputError(f"a line of [points] needs from, to and count; {missing[0]} is missing", t.where)
    a, b = (point(t.given[k], f"{k} of [points]", t) for k in ("from", "to"))
    n = t.whole("count", 2, 1)
    return [(_mix(a[0], b[0], w), _mix(a[1], b[1], w), _mix(a[2], b[2], w)) for w in _steps(n)]


def _steps(n: int) -> list[float]:
    return [0.0] if n == 1 else [k / (n - 1) for k in range(n)]


def _mix(a: float, b: float, w: float) -> float:
    """a + w (b - a), without the digits that round-off leaves: points are parts of addresses."""
    return float(f"{(1 - w) * a + w * b:.12g}")


def axis(t: Entries, key: str, default: float | None) -> list[float]:
    """The values along one axis: a number, a list, or {from, to, count}."""
    v = t.given.get(key, default)
    if isinstance(v, Mapping):
        e = Entries(v, t.where, f"{t.name}.{key}" if t.name else key)
        e.only(("from", "to", "count"))
        ends = numbers([v.get("from"), v.get("to")])
        if ends is None or "count" not in v:
            raise t.refuse(key, "a number, a list of numbers, or {from = ..., to = ..., count = ...}")
        return [_mix(ends[0], ends[1], w) for w in _steps(e.whole("count", 2, 1))]
    found = numbers(v if isinstance(v, list) else [v])
    if not found:
        raise t.refuse(key, "a number, a list of numbers, or {from = ..., to = ..., count = ...}")
    return found


def _file(t: Entries, base: Path, depths: bool) -> tuple[list[Point], bool]:
    """A CSV file of x,y,z lines; a head may name the columns, x, y and z or depth (x and y are 0 where it has none).
    Lines that begin with # are remarks."""
    path = base / t.text("file", "")
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
        rows = [r for r in csv.reader(x for x in lines if not x.lstrip().startswith("#")) if r]
    except OSError as e:
        raise InputError(f"cannot open the points {path}: {e.strerror}", t.where) from None
    except (UnicodeDecodeError, csv.Error) as e:
        raise InputError(f"the points {path} are no table of numbers: {e}", t.where) from None
    head = ["x", "y", "z"]
    if rows and not numbers(rows[0]):
        head = [c.strip().lower() for c in rows[0]]
        if not {"depth", "z"} & set(head):
            raise InputError(
                f"the head of {path} must name the columns z or depth, and x and y where they are not 0, with commas "
                f"between: {', '.join(rows[0])!r} does not",
                t.where,
            )
        depths, rows = depths or "depth" in head, rows[1:]
    elif rows and len(rows[0]) != 3:
        raise InputError(
            f"point 1 of {path} must be three numbers, x,y,z, not {','.join(rows[0])!r}; other columns need a head "
            "that names them, as x,y,depth",
            t.where,
        )
    if not rows:
        raise InputError(f"there are no points in {path}: a line x,y,z for each, or a head and its columns", t.where)
    third = "depth" if "depth" in head else "z"
    pick = [head.index(c) if c in head else None for c in ("x", "y", third)]
    out = []
    for k, r in enumerate(rows):
        if len(r) != len(head):
            raise InputError(
                f"point {k + 1} of {path} must be {_count(len(head))}, not {', '.join(r)!r}", t.where
            )
        row = [0.0 if c is None else r[c] for c in pick]
        if numbers(row) is None:
            raise InputError(f"point {k + 1} of {path} must be numbers, not {', '.join(r)!r}", t.where)
        out.append(point(row, f"point {k + 1} of {path}", t))
    return out, depths


def _count(n: int) -> str:
    return {1: "one number", 2: "two numbers", 3: "three numbers"}.get(n, f"{n} numbers")


def point(row: Any, what: str, t: Entries) -> Point:
    v = numbers(row)
    if v is None or len(v) != 3:
        raise InputError(f"{what} must be three numbers, not {row!r}", t.where)
    return v[0], v[1], v[2]


def numbers(row: Any) -> list[float] | None:
    """The numbers of a row, all finite; None where it has others."""
    if not isinstance(row, list) or any(isinstance(x, bool) for x in row):
        return None
    try:
        found = [float(x) for x in row]
    except (TypeError, ValueError, OverflowError):
        return None
    return found if all(math.isfinite(x) for x in found) else None
