"""From a study to its graph of steps."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from febkit.model import InputError

from .config import Method, Point, Resources, Study
from .step import Step
from .store import Store

CONTROL = "control"


class Place(NamedTuple):
    """Where in the study a result stands.

    ``method`` is a :class:`Method`'s name or "control"; ``point``, ``seed`` and ``variant`` are indices into
    the study's.
    """

    case: str
    method: str
    point: int = 0
    seed: int = 0
    variant: int = 0


class Work:
    """Steps whose results are wanted, the folder where these are kept, and what doing one takes."""

    __slots__ = ()
    targets: tuple[Step, ...]
    folder: Path
    resources: Resources

    def steps(self) -> dict[str, Step]:
        """All steps by address, inputs before what rests on them."""
        return {s.key: s for t in self.targets for s in t.walk()}

    def needed(self, store: Store) -> dict[str, Step]:
        """Steps still to be done: unfinished targets, and of their inputs those not in the store."""
        out: dict[str, Step] = {}

        def visit(s: Step) -> None:
            if s.key in out or store.has(s.key):
                return
            for i in s.inputs.values():
                visit(i)
            out[s.key] = s

        for t in self.targets:
            visit(t)
        return out


@dataclass(frozen=True, slots=True, eq=False)
class Plan(Work):
    """Steps whose results are the study's: metrics and agreement by their place."""

    study: Study
    metrics: Mapping[Place, Step]
    agreement: Mapping[Place, Step]

    @property
    def targets(self) -> tuple[Step, ...]:  # type: ignore[override]
        return (*self.metrics.values(), *self.agreement.values())

    @property
    def folder(self) -> Path:  # type: ignore[override]
        return self.study.folder

    @property
    def resources(self) -> Resources:  # type: ignore[override]
        return self.study.resources


def make_plan(study: Study) -> Plan:
    """The graph of a study: build, solve, series, drive, solve, measure, compare."""
    metrics: dict[Place, Step] = {}
    agreement: dict[Place, Step] = {}
    steps = _Shared(study)
    centre = _centre(study.points) if study.control else None
    for c, case in enumerate(study.cases):
        for v in range(len(study.variants)):
            for j in range(len(study.seeds)):
                if centre is not None:
                    metrics[Place(case, CONTROL, centre, j, v)] = steps.control(c, centre, j, v)
                for method in study.methods:
                    for k in range(len(study.points)):
                        at = Place(case, method.name, k, j, v)
                        metrics[at] = steps.driven(at, method)
                    if centre is not None:
                        at = Place(case, method.name, centre, j, v)
                        inputs = {"control": metrics[at._replace(method=CONTROL)], "test": metrics[at]}
                        label = f"{case} order {method.name}{which(study, None, j, v)}: compare"
                        agreement[at] = Step("compare", label, {}, inputs)
    return Plan(study, metrics, agreement)


def which(study: Study, point: int | None, seed: int | None, variant: int | None = 0) -> str:
    """Point, seed and variant in a label, where there are several; None where it is of all."""
    out = f" point {point + 1}" if point is not None and len(study.points) > 1 else ""
    out += f" seed {study.seeds[seed]}" if seed is not None and len(study.seeds) > 1 else ""
    return out + (f" {study.variants[variant].name}" if variant is not None and len(study.variants) > 1 else "")


def _centre(points: Iterable[Point]) -> int | None:
    """Index of the point in the middle of the tissue, where the control's cells are."""
    for k, p in enumerate(points):
        if p == (0.0, 0.0, 0.0):
            return k
    return None


class _Shared:
    """Steps by what they are of: each is made once, whatever rests on it."""

    def __init__(self, study: Study) -> None:
        self.study = study
        self._made: dict[tuple[object, ...], Any] = {}

    def _once(self, key: tuple[object, ...], make: Callable[[], Any]) -> Any:
        if key not in self._made:
            self._made[key] = make()
        return self._made[key]

    def tissue(self, case: str, variant: int) -> dict[str, Step]:
        varied = self.study.differ("tissue")
        suffix = which(self.study, None, None, variant) if varied else ""
        table = self.study.tissues[variant][case]
        made: dict[str, Step] = self._once(
            ("tissue", case, variant if varied else 0), lambda: _solved("tissue", table, case, suffix)
        )
        return made

    def cell(self, point: int, seed: int, variant: int) -> Step:
        """The model of the cells at a point: that of its zone."""
        study, zone = self.study, self.study.zone(point)

        def make() -> Step:
            varied = variant if study.differ("cell") else None
            suffix = ("" if zone is None else f" {zone.name}") + which(study, None, seed, varied)
            return _model("cell", self._seeded(study.cells(point, variant), seed), "", suffix)

        step: Step = self._once(("cell", zone and zone.name, seed, variant), make)
        return step

    def control(self, case: int, point: int, seed: int, variant: int) -> Step:
        varied = variant if self.study.differ("cell", "embedded") else None
        name, suffix = self.study.cases[case], which(self.study, None, seed, varied)
        table = self._seeded(self.study.controlled(case, point, variant), seed)
        label = f"{name} control{suffix}: measure"
        return _measure(self.study, label, _solved("embedded", table, name, suffix), ())

    def series(self, case: str, method: Method, point: int, variant: int) -> Step:
        """Series of the tissue's field at all points that are listed, one small file; else at one, so that other
        points may come and go."""
        order = max(method.solid or 1, method.fluid or 1, method.solute or 1)
        study = self.study
        at = list(study.points) if study.listed else [study.points[point]]
        where = f"at {len(at)} points" if study.listed else f"at point {point + 1}"
        box = _box(study, study.cells(point, variant)) if method.chosen else None

        def make() -> Step:
            params: dict[str, Any] = {"points": [list(p) for p in at], **study.coupling, "order": order}
            if box is not None:
                params |= {"order": "auto", "box": box}
            if method.recovery:
                params["recovery"] = method.recovery
            label = f"{case} tissue{which(study, None, None, varied)}: series of order {params['order']} {where}"
            label += f", {method.recovery}" if method.recovery else ""
            return Step("series", label, params, self.tissue(case, variant))

        varied = variant if study.differ("tissue") else None
        at_point = -1 if study.listed else point
        step: Step = self._once(("series", case, order, box, method.recovery, at_point, varied), make)
        return step

    def driven(self, at: Place, method: Method) -> Step:
        """What a method makes of the cells at a place: drive, solve, measure."""
        study, k = self.study, at.point
        label = f"{at.case} order {method.name}{which(study, k, at.seed, at.variant)}"
        cell = self.cell(k, at.seed, at.variant)
        params: dict[str, Any] = {"point": k if study.listed else 0, "solid": method.solid, "fluid": method.fluid}
        params |= {} if method.solute is None else {"solute": method.solute}
        tissue = self.tissue(at.case, at.variant)
        if study.background:
            cell = self._background(at, cell)
        if method.name == "overlay":
            params |= {"at": list(study.points[k])} | _units(study)
            inputs = {"cell": cell, **{f"tissue_{n}": s for n, s in tissue.items()}}
        else:
            inputs = {"cell": cell, "series": self.series(at.case, method, k, at.variant)}
        model = Step("drive", f"{label}: drive", params, inputs)
        results = Step("solve", f"{label}: solve", {}, {"model": model})
        drop = ("model", "results") if study.keep == "metrics" else ()
        return _measure(study, f"{label}: measure", {"model": model, "results": results}, drop)

    def _background(self, at: Place, cell: Step) -> Step:
        """The model of the cells with the tissue's own material around them."""
        study = self.study

        def make() -> Step:
            params = {"at": list(study.points[at.point]), "material": study.background}
            label = f"{at.case} cell{which(study, at.point, at.seed, at.variant)}: material of the tissue"
            inputs = {"cell": cell, "tissue": self.tissue(at.case, at.variant)["model"]}
            return Step("background", label, params, inputs)

        step: Step = self._once(("background", at._replace(method="")), make)
        return step

    def _seeded(self, table: Mapping[str, Any], j: int) -> Mapping[str, Any]:
        """Parameters of a model with cells: with its seed, and with what the metrics need of febkit's own templates."""
        seed = self.study.seeds[j]
        needs = self.study.measure.get("exchange") == "consistent" and "template" not in table
        return ({"velocity": True} if needs else {}) | dict(table) | ({} if seed is None else {"seed": seed})


def _model(name: str, table: Mapping[str, Any], case: str, suffix: str = "") -> Step:
    """The step that makes a model: from its template, or adopted from a user's file."""
    if "file" in table:
        return _adopt(name, {"model": table["file"]})
    values = {k: v for k, v in table.items() if k != "results"}
    template = name
    if "template" in table:
        from .models import template_of

        t = template_of(table, name)
        if "drive" in t.parameters and name == "cell":
            values |= {"drive": "none"}
        if t.name == table["template"]:  # built in
            template = values.pop("template")
    elif name == "cell":  # the drive comes from the tissue, not from the case
        values |= {"drive": "none"}
    prefix = f"{case} " if case else ""
    return Step("build", f"{prefix}{name}{suffix}: build", {"template": template, "values": values})


def _solved(name: str, table: Mapping[str, Any], case: str, suffix: str = "") -> dict[str, Step]:
    """Steps that hold a model and its plotfile."""
    if "results" in table:
        files = {"results": table["results"]} | ({"model": table["file"]} if "file" in table else {})
        step = _adopt(name, files)
        return {"model": step, "results": step}
    model = _model(name, table, case, suffix)
    return {"model": model, "results": Step("solve", f"{case} {name}{suffix}: solve", {}, {"model": model})}


def _box(study: Study, cell: Mapping[str, Any]) -> float:
    """Edge of the cell model, over which the error of a hand-off is estimated."""
    if "box" in study.coupling:
        return float(study.coupling["box"])
    if {"file", "template"} & set(cell):
        raise InputError(f'{study.file}: method "auto" with a cell model of your own: say its edge, box in [coupling]')
    from febkit.templates.template import load

    return float(cell.get("edge", load("cell").parameters["edge"].default))


def _units(study: Study) -> dict[str, Any]:
    """The unit system that the study names for results that name none, where it does."""
    return {k: study.measure[k] for k in ("units",) if k in study.measure}


def _measure(study: Study, label: str, solved: Mapping[str, Step], drop: tuple[str, ...]) -> Step:
    return Step("measure", label, dict(study.measure), dict(solved), drop)


def _adopt(name: str, files: Mapping[str, str]) -> Step:
    label = f"{name}: {', '.join(Path(f).name for f in files.values())}"
    return Step("adopt", label, {k: _content(f) for k, f in files.items()}, files=files)


def _content(path: str) -> str:
    """sha256 of a file: an edited file is another input, a moved one is not."""
    h = hashlib.sha256()
    with open(path, "rb") as f:
        while block := f.read(1 << 20):
            h.update(block)
    return h.hexdigest()
