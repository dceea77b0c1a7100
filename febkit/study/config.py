"""What a study.toml says, checked before anything runs."""

from __future__ import annotations

import csv
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from febkit.model import InputError, Where

CASES = ("A", "B", "C", "D")
RECOVERIES = ("element", "polynomial", "patches")  # those of febkit.coupling, which is not loaded to plan
Point = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Method:
    """How the tissue's field is handed over: "1", "2", "2/1" (order of solid/fluid), "2/2/1" (/solutes) or "overlay".

    An order may name its recovery ("2 element"); without one the study's [coupling] says which.
    """

    name: str
    solid: int | None
    fluid: int | None
    recovery: str | None = None
    solute: int | None = None  # as the fluid where it is not said

    @classmethod
    def parse(cls, text: object, where: Where) -> Method:
        t = " ".join(str(text).split())
        if t == "overlay":
            return cls(t, None, None)
        said, _, recovery = t.partition(" ")
        orders = said.split("/")
        known = recovery in ("", *RECOVERIES)
        if known and len(orders) <= 3 and all(o in ("1", "2", "3") for o in orders):
            solid, fluid, solute = (int(orders[min(k, len(orders) - 1)]) for k in range(3))
            return cls(t, solid, fluid, recovery or None, solute if len(orders) == 3 else None)
        raise InputError(
            f'method {t!r} must be an order "1", "2" or "3", or "2/1" (solid/fluid), or "2/2/1" (/solutes), with or '
            f'without a recovery ({", ".join(RECOVERIES)}) after it, or "overlay"',
            where,
        )


@dataclass(frozen=True, slots=True)
class Resources:
    """Threads and memory of one solve; workers at a time (0: as many as fit the machine)."""

    threads: int = 1
    memory: float = 2.0  # GB
    workers: int = 0


@dataclass(frozen=True, slots=True)
class Study:
    """A study: models, cases, methods, points and seeds; ``folder`` is where its results live.

    ``seeds`` are those of the cells' positions, one model of the cells for each; (None,) where [cell] names no list.
    """

    file: Path
    folder: Path
    name: str
    cases: tuple[str, ...]
    methods: tuple[Method, ...]
    control: bool
    points: tuple[Point, ...]
    seeds: tuple[int | None, ...]
    tissue: Mapping[str, Any]
    cell: Mapping[str, Any]
    embedded: Mapping[str, Any]
    coupling: Mapping[str, Any]
    measure: Mapping[str, Any]
    resources: Resources = field(default_factory=Resources)
    keep: str = "all"


_TOP = {
    "name",
    "cases",
    "methods",
    "control",
    "folder",
    "model",
    "tissue",
    "cell",
    "embedded",
    "points",
    "coupling",
    "measure",
    "run",
}


def read(path: str | Path, overrides: Sequence[str] = ()) -> Study:
    """Read a study.toml; ``overrides`` are "table.name=value" with values in TOML's spelling.

    Raises InputError naming the file and what is wrong.
    """
    path = Path(path)
    where = Where(str(path))
    try:
        t = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as e:
        raise InputError(f"cannot open the study: {e.strerror}", where) from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as e:
        raise InputError(f"not well-formed TOML: {e}", where) from None
    for o in overrides:
        _override(t, o)
    for key in t:
        if key not in _TOP:
            raise InputError(f"unknown entry {key!r}; a study has {', '.join(sorted(_TOP))}", where)
    shared, embedded = _table(t, "model", where), _table(t, "embedded", where)
    cell, seeds = _seeds(shared | _table(t, "cell", where), embedded, where)
    control = bool(t.get("control", True))
    return Study(
        file=path,
        folder=path.parent / str(t.get("folder", f"{path.stem}.study")),
        name=str(t.get("name", path.stem)),
        cases=_cases(t.get("cases", list(CASES)), where),
        methods=tuple(Method.parse(m, where) for m in t.get("methods", ["1", "2"])),
        control=control,
        points=_points(_table(t, "points", where), path.parent, where),
        seeds=seeds,
        tissue=_located(shared | _table(t, "tissue", where), path.parent, where),
        cell=_located(cell, path.parent, where),
        embedded=_located(_control(cell, embedded), path.parent, where),
        coupling=_table(t, "coupling", where),
        measure=_measure(_table(t, "measure", where), where),
        resources=_resources(_table(t, "run", where), where),
        keep=_keep(_table(t, "run", where), where),
    )


def _override(t: dict[str, Any], text: str) -> None:
    name, _, value = text.partition("=")
    try:
        parsed = tomllib.loads(f"v = {value}")["v"]
    except tomllib.TOMLDecodeError:
        parsed = value
    *tables, last = name.strip().split(".")
    for k in tables:
        t = t.setdefault(k, {})
    t[last] = parsed


def _table(t: Mapping[str, Any], name: str, where: Where) -> dict[str, Any]:
    v = t.get(name, {})
    if not isinstance(v, dict):
        raise InputError(f"[{name}] must be a table", where)
    return dict(v)


def _cases(v: object, where: Where) -> tuple[str, ...]:
    cases = tuple(str(c) for c in (v if isinstance(v, list) else [v]))
    for c in cases:
        if c not in CASES:
            raise InputError(f"case {c!r} is none of {', '.join(CASES)}", where)
    if not cases:
        raise InputError("a study needs at least one case", where)
    return cases


def _points(t: Mapping[str, Any], base: Path, where: Where) -> tuple[Point, ...]:
    """``at`` = [[x, y, z], ...] or ``file`` = a CSV of x,y,z lines; the centre where neither is given."""
    if "file" in t:
        path = base / str(t["file"])
        try:
            rows = [r for r in csv.reader(path.read_text(encoding="utf-8").splitlines()) if r]
        except OSError as e:
            raise InputError(f"cannot open the points {path}: {e.strerror}", where) from None
        if rows and not _numbers(rows[0]):
            rows = rows[1:]
    else:
        rows = t.get("at", [[0.0, 0.0, 0.0]])
    points = []
    for k, r in enumerate(rows):
        v = _numbers(r)
        if v is None or len(v) != 3:
            raise InputError(f"point {k + 1} must be three numbers, not {r!r}", where)
        points.append((v[0], v[1], v[2]))
    if len(set(points)) < len(points):
        raise InputError("a point is given twice", where)
    return tuple(points)


def _seeds(
    cell: dict[str, Any], embedded: Mapping[str, Any], where: Where
) -> tuple[dict[str, Any], tuple[int | None, ...]]:
    """``seed`` = [1, 2, 3] of [cell]: a model of the cells for each, all else the same."""
    seeds = cell.get("seed")
    if not isinstance(seeds, list):
        return cell, (None,)
    for name, table, files in (
        ("cell", cell, ("file",)),
        ("embedded", embedded, ("file", "results", "seed")),
    ):
        for other in files:
            if other in table:
                raise InputError(f"[cell] has several seeds, so [{name}] must have no {other}", where)
    if not seeds or not all(type(s) is int and s >= 0 for s in seeds):
        raise InputError(f"seeds must be whole numbers from 0 on, not {seeds!r}", where)
    if len(set(seeds)) < len(seeds):
        raise InputError("a seed is given twice", where)
    return {k: v for k, v in cell.items() if k != "seed"}, tuple(seeds)


def _numbers(row: Any) -> list[float] | None:
    try:
        return [float(x) for x in row]
    except (TypeError, ValueError):
        return None


def _located(t: dict[str, Any], base: Path, where: Where) -> dict[str, Any]:
    """Paths of a model's own files, relative to the study."""
    for k in ("file", "results", "template"):
        if k in t:
            p = (base / str(t[k])).resolve()
            if not p.exists():
                raise InputError(f"{p} does not exist", where)
            t[k] = str(p)
    return t


def _control(cell: Mapping[str, Any], own: Mapping[str, Any]) -> dict[str, Any]:
    """The control is made of the cell model's own parameters, but not of its files."""
    return {k: v for k, v in cell.items() if k not in ("file", "template", "drive")} | dict(own)


def _resources(t: Mapping[str, Any], where: Where) -> Resources:
    unknown = set(t) - {"threads", "memory", "workers", "keep"}
    if unknown:
        raise InputError(f"unknown entry {sorted(unknown)[0]!r} in [run]", where)
    return Resources(int(t.get("threads", 1)), float(t.get("memory", 2.0)), int(t.get("workers", 0)))


def _measure(t: dict[str, Any], where: Where) -> dict[str, Any]:
    """What :func:`febkit.metrics.cell_metrics` is told beside the result and the model."""
    from febkit.metrics.exchange import METHODS, SIDES

    known = {"cells": None, "density": None, "sides": SIDES, "exchange": METHODS}
    for name, value in t.items():
        if name not in known:
            raise InputError(f"unknown entry {name!r} in [measure]; it has {', '.join(known)}", where)
        choices = known[name]
        if choices is not None and value not in choices:
            raise InputError(f"{name} of [measure] must be {' or '.join(choices)}, not {value!r}", where)
    return t


def _keep(t: Mapping[str, Any], where: Where) -> str:
    keep = str(t.get("keep", "all"))
    if keep not in ("all", "metrics"):
        raise InputError(f'keep must be "all" or "metrics", not {keep!r}', where)
    return keep
