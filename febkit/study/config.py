"""What a study.toml says, checked before anything runs."""

from __future__ import annotations

import csv
import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from febkit.model import InputError, Where
from febkit.units import SYSTEMS

from .entries import Entries, load

CASES = ("A", "B", "C", "D")
RECOVERIES = ("element", "polynomial", "patches")  # those of febkit.coupling, which is not loaded to plan
Point = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Method:
    """How the tissue's field is handed over: "1", "2", "2/1" (order of solid/fluid), "2/2/1" (/solutes), "auto" (at
    each point the orders with the least estimated error) or "overlay".

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
        if known and said == "auto":
            return cls(t, None, None, recovery or None)
        if known and len(orders) <= 3 and all(o in ("1", "2", "3") for o in orders):
            solid, fluid, solute = (int(orders[min(k, len(orders) - 1)]) for k in range(3))
            return cls(t, solid, fluid, recovery or None, solute if len(orders) == 3 else None)
        raise InputError(
            f'method {t!r} must be an order "1", "2" or "3", or "2/1" (solid/fluid), or "2/2/1" (/solutes), with or '
            f'without a recovery ({", ".join(RECOVERIES)}) after it, "auto", or "overlay"',
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


_TOP = (
    "name", "cases", "methods", "control", "folder", "model", "tissue", "cell", "embedded", "points", "coupling",
    "measure", "run", "units",
)  # fmt: skip


def read(path: str | Path, overrides: Sequence[str] = ()) -> Study:
    """Read a study.toml; ``overrides`` are "table.name=value" with values in TOML's spelling.

    Raises InputError naming the file, the entry and what is wrong. ``folder`` of the file lies beside it or below;
    an override may name any.
    """
    path = Path(path)
    t, where = load(path, "the study")
    own = _folder(Entries(t, where), path)
    for o in overrides:
        _override(t, o)
    top = Entries(t, where)
    top.only(_TOP)
    shared, embedded = _model(top, "model"), _model(top, "embedded")
    cell, seeds = _seeds(shared | _model(top, "cell"), embedded, where)
    run = top.table("run")
    run.only(("threads", "memory", "workers", "keep"))
    units = _units(top)
    return Study(
        file=path,
        folder=path.parent / top.text("folder", "") if _told(overrides) else own,
        name=top.text("name", path.stem),
        cases=_cases(top),
        methods=tuple(Method.parse(m, where) for m in top.listed("methods", ["1", "2"])),
        control=top.flag("control", True),
        points=_points(top.table("points"), path.parent),
        seeds=seeds,
        tissue=_located(shared | _model(top, "tissue"), "tissue", path.parent, where),
        cell=_located(cell, "cell", path.parent, where),
        embedded=_located(_control(cell, embedded), "embedded", path.parent, where),
        coupling=_coupling(top.table("coupling")) | units,
        measure=_measure(top.table("measure")) | units,
        resources=Resources(run.whole("threads", 1, 1), run.positive("memory", 2.0), run.whole("workers", 0, 0)),
        keep=run.choice("keep", "all", ("all", "metrics")),
    )


def _override(t: dict[str, Any], text: str) -> None:
    name, equals, value = text.partition("=")
    *tables, last = name.strip().split(".")
    if not equals or not all((*tables, last)):
        raise InputError(f"--set {text}: it takes TABLE.NAME=VALUE, as in --set cell.seed=2")
    try:
        parsed = tomllib.loads(f"v = {value}")["v"]
    except tomllib.TOMLDecodeError:
        parsed = value
    for k in tables:
        t = t.setdefault(k, {})
        if not isinstance(t, dict):
            raise InputError(f"--set {text}: {k} is not a table")
    t[last] = parsed


def _told(overrides: Sequence[str]) -> bool:
    return any(o.partition("=")[0].strip() == "folder" for o in overrides)


def _units(top: Entries) -> dict[str, str]:
    """``units`` = "mm-N-s": of results that name none themselves."""
    return {"units": top.choice("units", "", tuple(SYSTEMS))} if "units" in top.given else {}


def _folder(top: Entries, path: Path) -> Path:
    """Where the file has its results: below the folder it lies in, as what is in there may be deleted."""
    said = top.text("folder", f"{path.stem}.study")
    folder, home = (path.parent / said).resolve(), path.parent.resolve()
    if Path(said).is_absolute() or home not in folder.parents:
        raise InputError(
            f"folder = {said!r} is not below the study's own folder; to have results elsewhere say so in the command: "
            f"--set folder=PATH",
            top.where,
        )
    return path.parent / said


def _model(top: Entries, name: str) -> dict[str, Any]:
    """A model's parameters; the template checks them."""
    table = dict(top.table(name).given)
    for key in ("file", "results", "template"):
        if key in table:
            table[key] = top.table(name).text(key, "")
    return table


def _cases(top: Entries) -> tuple[str, ...]:
    cases = top.listed("cases", list(CASES))
    for c in cases:
        if c not in CASES:
            raise InputError(f"case {c!r} is none of {', '.join(CASES)}", top.where)
    if len(set(cases)) < len(cases):
        raise InputError("a case is given twice", top.where)
    return tuple(cases)


def _points(t: Entries, base: Path) -> tuple[Point, ...]:
    """``at`` = [[x, y, z], ...] or ``file`` = a CSV of x,y,z lines; the centre where neither is given."""
    t.only(("at", "file"))
    if "file" in t.given:
        path = base / t.text("file", "")
        try:
            rows = [r for r in csv.reader(path.read_text(encoding="utf-8").splitlines()) if r]
        except OSError as e:
            raise InputError(f"cannot open the points {path}: {e.strerror}", t.where) from None
        except (UnicodeDecodeError, csv.Error) as e:
            raise InputError(f"the points {path} are no table of numbers: {e}", t.where) from None
        if rows and not _numbers(rows[0]):
            rows = rows[1:]
        if not rows:
            raise InputError(f"the points {path} are none", t.where)
    else:
        rows = t.listed("at", [[0.0, 0.0, 0.0]])
    points = []
    for k, r in enumerate(rows):
        v = _numbers(r)
        if v is None or len(v) != 3:
            raise InputError(f"point {k + 1} must be three numbers, not {r!r}", t.where)
        points.append((v[0], v[1], v[2]))
    if len(set(points)) < len(points):
        raise InputError("a point is given twice", t.where)
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
    """The numbers of a row, all finite; None where it has others."""
    if not isinstance(row, list) or any(isinstance(x, bool) for x in row):
        return None
    try:
        numbers = [float(x) for x in row]
    except (TypeError, ValueError, OverflowError):
        return None
    return numbers if all(math.isfinite(x) for x in numbers) else None


def _located(t: dict[str, Any], name: str, base: Path, where: Where) -> dict[str, Any]:
    """A model's parameters, checked by its template, with paths of its own files relative to the study."""
    for k in ("file", "results", "template"):
        if k in t:
            p = (base / t[k]).resolve()
            if not p.exists():
                raise InputError(f"{p} does not exist", where)
            if p.is_dir() != (k == "template"):
                raise InputError(f"{k} of [{name}] must be a {'folder' if k == 'template' else 'file'}: {p}", where)
            t[k] = str(p)
    if "file" not in t:
        _check(t, name, where)
    return t


def _check(t: dict[str, Any], name: str, where: Where) -> None:
    from febkit.templates.template import load

    own = {k: v for k, v in t.items() if k not in ("results", "template")}
    given = Where(f"{where}: [{name}]")
    load(name, Path(t["template"]) if "template" in t else None).values([(own, given)])


def _control(cell: Mapping[str, Any], own: Mapping[str, Any]) -> dict[str, Any]:
    """The control is made of the cell model's own parameters, but not of its files."""
    return {k: v for k, v in cell.items() if k not in ("file", "template", "drive")} | dict(own)


def _coupling(t: Entries) -> dict[str, Any]:
    """What :func:`febkit.coupling.series` is told beside the points and the order."""
    t.only(("recovery", "own_part", "box"))
    if "box" in t.given:
        t.positive("box", 1.0)
    if "recovery" in t.given:
        t.choice("recovery", "", RECOVERIES)
    t.flag("own_part", True)
    return dict(t.given)


def _measure(t: Entries) -> dict[str, Any]:
    """What :func:`febkit.metrics.cell_metrics` is told beside the result and the model."""
    from febkit.metrics.exchange import METHODS, SIDES

    t.only(("cells", "density", "sides", "exchange"))
    for name, choices in (("sides", SIDES), ("exchange", METHODS)):
        if name in t.given:
            t.choice(name, "", choices)
    if "density" in t.given:
        t.positive("density", 1.0)
    cells = t.given.get("cells", "")
    names = [*cells, *cells.values()] if isinstance(cells, Mapping) else t.listed("cells", [cells])
    if not all(isinstance(c, str) for c in names):
        raise t.refuse("cells", "names of parts or sets")
    return dict(t.given)
