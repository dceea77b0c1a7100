"""A property over normalised depth: 0 at the articular surface, 1 at the bone.

Given as a number, one number for each zone, a table of [depth, value] rows, a CSV file, or a table of these with the
rule that fills the gaps between the rows. Beyond the first and the last row a table keeps their values.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from febkit.model import InputError, Where
from febkit.model.mesh import Floats

RULES = ("linear", "cubic", "monotone", "steps")
FORMS = 'a number, one number for each zone, [[depth, value], ...], "file.csv", or {points = [...], rule = "cubic"}'
FIELDS = {"points", "file", "column", "rule"}


@dataclass(frozen=True, slots=True)
class Profile:
    """Values over depth. ``rule``: how they go on between ``depths`` (:data:`RULES`), "constant" or "zones".

    linear: straight lines; cubic: spline with continuous second derivatives (natural ends); monotone: spline that
    never leaves the range of the two rows beside it (Fritsch & Carlson, SIAM J. Numer. Anal. 17 (1980) 238); steps:
    each row's value down to the next. With "zones", ``values`` are those of the zones from the surface down.
    """

    values: tuple[float, ...]
    depths: tuple[float, ...] = ()
    rule: str = "constant"
    file: str = ""
    where: Where | None = None  # what gave it, for messages

    def at(self, depth: Floats) -> Floats:
        """Values at depths (n,)."""
        x = np.asarray(depth, float)
        if self.rule == "constant":
            return np.full(x.shape, self.values[0])
        d, v = np.array(self.depths), np.array(self.values)
        if self.rule == "steps":
            return np.asarray(v[np.clip(np.searchsorted(d, x, side="right") - 1, 0, len(v) - 1)])
        x = np.clip(x, d[0], d[-1])
        if self.rule == "linear" or len(d) == 2:
            return np.asarray(np.interp(x, d, v))
        from scipy.interpolate import CubicSpline, PchipInterpolator

        made = CubicSpline(d, v, bc_type="natural") if self.rule == "cubic" else PchipInterpolator(d, v)
        return np.asarray(made(x), float)

    def plain(self) -> Any:
        """The value that gives this profile without any file."""
        if self.rule == "zones":
            return list(self.values)
        if not self.depths:
            return self.values[0]
        return {"points": [list(row) for row in zip(self.depths, self.values, strict=True)], "rule": self.rule}

    def samples(self) -> list[tuple[float, float]]:
        """(depth, value) where bounds are to be held: all rows, and 400 depths along splines; NaN for the depth of
        none."""
        rows = list(zip(self.depths or (math.nan,) * len(self.values), self.values, strict=True))
        if self.rule in ("cubic", "monotone"):
            d = np.linspace(0.0, 1.0, 401)
            rows += list(zip(d.tolist(), self.at(d).tolist(), strict=True))
        return rows

    def zone(self, number: int, zones: int, name: str) -> Profile:
        """What holds in one of the zones."""
        if self.rule != "zones":
            return self
        if len(self.values) != zones:
            raise InputError(f"{name} has {len(self.values)} numbers and there are {zones} zones: give one number "
                             "for each zone from the surface down, or rows [[depth, value], ...]", self.where)
        return Profile((self.values[number],))


def anchored(value: Any, where: Where) -> Any:
    """The value with a path of a CSV file made relative to the folder of the file that names it."""
    if isinstance(value, str) and value:
        return str(Path(where.file).parent / value) if where.file else value
    if isinstance(value, Mapping) and isinstance(value.get("file"), str):
        return dict(value) | {"file": anchored(value["file"], where)}
    return value


def profile(name: str, value: Any, where: Where | None = None) -> Profile:
    """The profile that a parameter's value says, or an InputError that says what is wrong with it."""
    if isinstance(value, Profile):
        return value
    if isinstance(value, str):
        value = {"file": value}
    if isinstance(value, Mapping):
        return _of_table(name, value, where)
    if isinstance(value, list):
        if value and all(isinstance(x, int | float) and not isinstance(x, bool) for x in value):
            return Profile(tuple(_number(name, x, where) for x in value), rule="zones", where=where)
        return _of_rows(name, value, "linear", "", where)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(f"{name} must be {FORMS}, not {value!r}", where)
    return Profile((_number(name, value, where),))


def _of_table(name: str, table: Mapping[str, Any], where: Where | None) -> Profile:
    unknown = set(table) - FIELDS
    if unknown or ("points" in table) == ("file" in table):
        wrong = f"has no entry '{sorted(unknown)[0]}'" if unknown else "needs either points or file"
        raise InputError(f"{name} {wrong}; a profile takes points = [[depth, value], ...] or file = \"file.csv\", "
                         "with column (of the file) and rule", where)
    rule = table.get("rule", "linear")
    if rule not in RULES:
        raise InputError(f"{name}: rule must be one of {', '.join(RULES)}, not {rule!r}", where)
    if "points" in table:
        return _of_rows(name, table["points"], rule, "", where)
    file = table["file"]
    if not isinstance(file, str) or not file:
        raise InputError(f"{name}: file must be the path of a CSV file, not {file!r}", where)
    from .columns import columns

    rows, lines = columns(Path(file), name, table.get("column"), where)
    return _of_rows(name, rows, rule, file, None, lines)


def _of_rows(name: str, rows: Any, rule: str, file: str, where: Where | None,
             lines: list[int] | None = None) -> Profile:  # fmt: skip
    """A profile of [depth, value] rows; ``lines`` are their lines in ``file``."""
    def at(k: int) -> Where | None:
        return Where(file, lines[k]) if lines is not None else where

    if not isinstance(rows, list) or not rows:
        raise InputError(f"{name} must be {FORMS}, not {rows!r}", Where(file) if file else where)
    pairs = []
    for k, row in enumerate(rows):
        if not isinstance(row, list | tuple) or len(row) != 2:
            raise InputError(f"{name}: row {k + 1} must be two numbers, [depth, value], not {row!r}", at(k))
        pairs.append((_number(f"depth of {name}", row[0], at(k)), _number(name, row[1], at(k))))
        if not 0.0 <= pairs[-1][0] <= 1.0:
            raise InputError(f"{name}: depth {row[0]:g} is outside 0 (articular surface) to 1 (bone): divide depths "
                             "by the thickness", at(k))
    for k, ((a, _), (b, _)) in enumerate(pairwise(pairs)):
        if b <= a:
            raise InputError(f"{name}: depths must rise from row to row, and {b:g} follows {a:g}: sort the rows "
                             "from the articular surface (0) to the bone (1)", at(k + 1))
    depths, values = zip(*pairs, strict=True)
    if len(pairs) == 1:
        return Profile(values, file=file, where=where)
    return Profile(values, depths, rule, file, Where(file) if file else where)


def _number(name: str, value: Any, where: Where | None) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise InputError(f"{name} must be a finite number, not {value!r}", where)
    return float(value)
