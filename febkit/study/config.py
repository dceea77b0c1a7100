"""What a study.toml says, checked before anything runs."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from febkit.model import InputError, Where
from febkit.units import SYSTEMS

from . import depth, models
from .entries import Entries, load
from .models import CASES, Case, Variant, Zone
from .points import CENTRE, Point, Points, read_points

__all__ = ["CASES", "Method", "Point", "Resources", "Study", "read"]

RECOVERIES = ("element", "polynomial", "patches")  # those of febkit.coupling, which is not loaded to plan


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

    @property
    def chosen(self) -> bool:
        """Are the orders those with the least estimated error?"""
        return self.name.partition(" ")[0] == "auto"

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
    """Threads and memory (GB) of one solve, workers at a time; 0: planned from the size of the models and the machine.

    ``limit``: seconds after which a solve is given up, 0 for none; ``retry``: failed ones again, with smaller steps;
    ``checkpoint``: "10min", how often a solve writes what a later sitting goes on from, empty: never.
    """

    threads: int = 1
    memory: float = 2.0
    workers: int = 0
    limit: float = 0.0
    retry: bool = False
    checkpoint: str = ""


@dataclass(frozen=True, slots=True)
class Study:
    """A study: models, cases, methods, points and seeds; ``folder`` is where its results live.

    ``seeds`` are those of the cells' positions, one model of the cells for each; (None,) where [cell] names no list.
    ``depths`` and ``zone_of`` belong to the points, where depths are known and there are zones. ``tissues`` are the
    tissue by case, for each variant; ``embedded`` what the control has beside the cells' parameters.
    """

    file: Path
    folder: Path
    name: str
    loads: tuple[Case, ...]
    methods: tuple[Method, ...]
    control: bool
    points: tuple[Point, ...]
    seeds: tuple[int | None, ...]
    tissues: tuple[Mapping[str, Mapping[str, Any]], ...]
    cell: Mapping[str, Any]
    embedded: Mapping[str, Any]
    coupling: Mapping[str, Any]
    measure: Mapping[str, Any]
    resources: Resources = field(default_factory=Resources)
    keep: str = "all"
    listed: bool = True  # points named one by one: their series stand in one file, as they always have
    depths: tuple[float, ...] = ()
    zones: tuple[Zone, ...] = ()
    zone_of: tuple[int, ...] = ()
    variants: tuple[Variant, ...] = (Variant(""),)
    background: str = ""  # material of the cell model that is the tissue's at the point
    instantaneous: float | None = None

    @property
    def cases(self) -> tuple[str, ...]:
        return tuple(c.name for c in self.loads)

    @property
    def tissue(self) -> Mapping[str, Any]:
        """The tissue of the first case and variant."""
        return self.tissues[0][self.loads[0].name]

    def every_tissue(self) -> dict[str, Mapping[str, Any]]:
        """All tissues, by case and, where there are several, variant."""
        if not self.differ("tissue"):
            return dict(self.tissues[0])
        pairs = zip(self.variants, self.tissues, strict=True)
        return {f"{case} {v.name}": t for v, tissues in pairs for case, t in tissues.items()}

    def differ(self, *models: str) -> bool:
        """Do the variants differ in any of these models: "cell", "embedded", "tissue"?"""
        return any(getattr(v, m) for v in self.variants for m in models)

    def zone(self, point: int) -> Zone | None:
        return self.zones[self.zone_of[point]] if self.zones else None

    def cells(self, point: int, variant: int) -> dict[str, Any]:
        """Parameters of the cell model at a point."""
        zone = self.zone(point)
        return _over(_over(dict(self.cell), {} if zone is None else zone.cell), self.variants[variant].cell)

    def controlled(self, case: int, point: int, variant: int) -> dict[str, Any]:
        """Parameters of the control: the cells' own, and what [embedded], the case and the variant say of it."""
        own = models.control(self.cells(point, variant), self.embedded)
        return own | dict(self.loads[case].embedded) | dict(self.variants[variant].embedded)


def _over(table: dict[str, Any], more: Mapping[str, Any]) -> dict[str, Any]:
    """A model's table with what comes instead; another file has no parameters, and parameters have no file."""
    if "file" in more:
        return dict(more)
    return {k: v for k, v in table.items() if k != "file" or not more} | dict(more)


_TOP = (
    "name", "cases", "methods", "control", "folder", "model", "tissue", "cell", "embedded", "points", "coupling",
    "measure", "run", "units", "zones", "variants", "instantaneous",
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
    if not t:
        raise InputError("there is nothing in it; docs/howto/depths.md and examples/ show what a study may say", where)
    top, home = Entries(t, where), path.parent
    top.only(_TOP)
    shared, embedded = models.given(top, "model"), models.given(top, "embedded")
    cell, seeds = _seeds(shared | models.given(top, "cell"), embedded, where)
    tissue = models.located(shared | models.given(top, "tissue"), "tissue", home, where)
    loads = models.cases(top, tissue)
    run = top.table("run")
    run.only(("threads", "memory", "workers", "keep", "limit", "retry", "checkpoint"))
    units = _units(top)
    coupling, background = _coupling(top.table("coupling"))
    published = not isinstance(top.given.get("cases"), Mapping) and loads[0].name != models.OWN
    points = read_points(top.table("points"), home)
    methods = tuple(Method.parse(m, where) for m in top.listed("methods", ["1", "2"]))
    if len({m.name for m in methods}) < len(methods):
        raise InputError("a method is given twice", where)
    variants = models.variants(top)
    study = Study(
        file=path,
        folder=home / top.text("folder", "") if _told(overrides) else own,
        name=top.text("name", path.stem),
        loads=tuple(replace(c, embedded=models.located(c.embedded, "embedded", home, where)) for c in loads),
        methods=methods,
        control=top.flag("control", published or "embedded" in t),
        points=points.rows,
        seeds=seeds,
        tissues=tuple(models.tissues(tissue, loads, v, home, where) for v in variants),
        cell=models.located(cell, "cell", home, where),
        embedded=models.located(embedded, "embedded", home, where),
        coupling=coupling | units,
        measure=_measure(top.table("measure")) | units,
        resources=_resources(run),
        keep=run.choice("keep", "all", ("all", "metrics")),
        listed=points.listed,
        zones=models.zones(top, home),
        variants=variants,
        background=background,
        instantaneous=top.positive("instantaneous", 0.0) if "instantaneous" in t else None,
    )
    return _checked(_deep(study, points, where), where)


def _deep(study: Study, points: Points, where: Where) -> Study:
    """With depths and zones of the points, where something asks for them; points outside the tissue are refused."""
    plain = points.listed and not study.zones
    tissues = study.every_tissue()
    if plain and points.rows == (CENTRE,) and all(models.central(t) for t in tissues.values()):
        return study  # no mesh is needed to know that it is inside
    columns = depth.columns(tissues, where)
    if not points.said:
        depth.check_centre(columns, where)
    if plain:
        depth.check_inside(points, columns, where)
        return study
    at, depths = depth.placed(points, columns, where)
    zone_of = tuple(models.zone_at(study.zones, d, f"point {k + 1} ({', '.join(f'{c:g}' for c in at[k])})", where)
                    for k, d in enumerate(depths)) if study.zones else ()  # fmt: skip
    return replace(study, points=at, depths=depths, zone_of=zone_of)


def _checked(study: Study, where: Where) -> Study:
    """Raises InputError for parameters that some template of the study does not have."""
    one_each = {study.zone_of[k] if study.zones else 0: k for k in reversed(range(len(study.points)))}
    for k in one_each.values():
        for v in range(len(study.variants)):
            cell, zone = study.cells(k, v), study.zone(k)
            others = [f"zones.{zone.name}"] if zone is not None and zone.cell else []
            others += ["variants"] if len(study.variants) > 1 else []
            if "file" not in cell:
                models.check(cell, "cell", where, *others)
            for c in range(len(study.loads)) if study.control else ():
                control = study.controlled(c, k, v)
                if "file" not in control:
                    models.check(control, "embedded", where, *others)
    return study


def _resources(run: Entries) -> Resources:
    numbers = {k: run.positive(k, 1.0) for k in ("memory", "limit") if k in run.given}
    threads = run.whole("threads", 1, 1) if "threads" in run.given else 0
    both = numbers.get("memory", 0.0), run.whole("workers", 0, 0)
    every = run.text("checkpoint", "") if "checkpoint" in run.given else ""
    if every:
        from febkit.checkpoint import Every

        try:
            Every.of(every)
        except ValueError:
            raise run.refuse("checkpoint", 'a time or a number of steps such as "10min" or "50steps"') from None
    return Resources(threads, *both, numbers.get("limit", 0.0), run.flag("retry", True), every)


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


def _coupling(t: Entries) -> tuple[dict[str, Any], str]:
    """What :func:`febkit.coupling.series` is told beside points and order; the material that is the tissue's."""
    t.only(("recovery", "own_part", "background", "material", "box"))
    if "box" in t.given:
        t.positive("box", 1.0)
    if "recovery" in t.given:
        t.choice("recovery", "", RECOVERIES)
    t.flag("own_part", True)
    material = t.text("material", "ecm")
    tissues = t.choice("background", "cell", ("cell", "tissue")) == "tissue"
    return {k: v for k, v in t.given.items() if k in ("recovery", "own_part", "box")}, material if tissues else ""


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
