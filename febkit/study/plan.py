"""From a study to its graph of steps."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping
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

    ``method`` is a :class:`Method`'s name or "control"; ``point`` and ``seed`` are indices into the study's.
    """

    case: str
    method: str
    point: int = 0
    seed: int = 0


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
    centre = _centre(study.points)
    for case in study.cases:
        tissue = _solved("tissue", study.tissue, case)
        for j in range(len(study.seeds)):
            suffix = which(study, None, j)
            cell = _model("cell", _seeded(study, study.cell, j), case, suffix)
            if study.control and centre is not None:
                control = _solved("embedded", _seeded(study, study.embedded, j), case, suffix)
                at = Place(case, CONTROL, centre, j)
                metrics[at] = _measure(study, f"{case} control{suffix}: measure", control, ())
            for method in study.methods:
                for k in range(len(study.points)):
                    at = Place(case, method.name, k, j)
                    metrics[at] = _driven(study, at, method, cell, tissue)
                if study.control and centre is not None:
                    at = Place(case, method.name, centre, j)
                    inputs = {"control": metrics[at._replace(method=CONTROL)], "test": metrics[at]}
                    label = f"{case} order {method.name}{suffix}: compare"
                    agreement[at] = Step("compare", label, {}, inputs)
    return Plan(study, metrics, agreement)


def _seeded(study: Study, table: Mapping[str, Any], j: int) -> Mapping[str, Any]:
    """Parameters of a model with cells: with its seed, and with what the metrics need of febkit's own templates."""
    seed = study.seeds[j]
    needs = study.measure.get("exchange") == "consistent" and "template" not in table
    return ({"velocity": True} if needs else {}) | dict(table) | ({} if seed is None else {"seed": seed})


def which(study: Study, point: int | None, seed: int) -> str:
    """Point and seed in a label, where there are several."""
    out = f" point {point + 1}" if point is not None and len(study.points) > 1 else ""
    return out + (f" seed {study.seeds[seed]}" if len(study.seeds) > 1 else "")


def _centre(points: Iterable[Point]) -> int | None:
    """Index of the point in the middle of the tissue, where the control's cells are."""
    for k, p in enumerate(points):
        if p == (0.0, 0.0, 0.0):
            return k
    return None


def _model(name: str, table: Mapping[str, Any], case: str, suffix: str = "") -> Step:
    """The step that makes a model: from its template, or adopted from a user's file."""
    if "file" in table:
        return _adopt(name, {"model": table["file"]})
    params = {k: v for k, v in table.items() if k != "results"}
    if name == "cell":  # the drive comes from the tissue, not from the case
        params |= {"drive": "none"}
        return Step("build", f"{name}{suffix}: build", {"template": name, "values": params})
    values = {**params, "case": case}
    return Step("build", f"{case} {name}{suffix}: build", {"template": name, "values": values})


def _solved(name: str, table: Mapping[str, Any], case: str, suffix: str = "") -> dict[str, Step]:
    """Steps that hold a model and its plotfile."""
    if "results" in table:
        files = {"results": table["results"]} | ({"model": table["file"]} if "file" in table else {})
        step = _adopt(name, files)
        return {"model": step, "results": step}
    model = _model(name, table, case, suffix)
    return {"model": model, "results": Step("solve", f"{case} {name}{suffix}: solve", {}, {"model": model})}


def _series(study: Study, case: str, method: Method, tissue: Mapping[str, Step]) -> Step:
    """Series of the tissue's field at all points, of the order that is handed off: one small file."""
    order = max(method.solid or 1, method.fluid or 1, method.solute or 1)
    params: dict[str, Any] = {"points": [list(p) for p in study.points], **study.coupling, "order": order}
    if method.solid is None:
        params |= {"order": "auto", "box": _box(study)}
    if method.recovery:
        params["recovery"] = method.recovery
    label = f"{case} tissue: series of order {params['order']} at {len(study.points)} points"
    return Step("series", label + (f", {method.recovery}" if method.recovery else ""), params, dict(tissue))


def _box(study: Study) -> float:
    """Edge of the cell model, over which the error of a hand-off is estimated."""
    if "box" in study.coupling:
        return float(study.coupling["box"])
    if {"file", "template"} & set(study.cell):
        raise InputError(f'{study.file}: method "auto" with a cell model of your own: say its edge, box in [coupling]')
    from febkit.templates.template import load

    return float(study.cell.get("edge", load("cell").parameters["edge"].default))


def _driven(study: Study, at: Place, method: Method, cell: Step, tissue: Mapping[str, Step]) -> Step:
    k = at.point
    label = f"{at.case} order {method.name}{which(study, k, at.seed)}"
    params: dict[str, Any] = {"point": k, "solid": method.solid, "fluid": method.fluid}
    params |= {} if method.solute is None else {"solute": method.solute}
    if method.name == "overlay":
        params |= {"at": list(study.points[k])} | _units(study)
        inputs = {"cell": cell, **{f"tissue_{n}": s for n, s in tissue.items()}}
    else:
        inputs = {"cell": cell, "series": _series(study, at.case, method, tissue)}
    model = Step("drive", f"{label}: drive", params, inputs)
    results = Step("solve", f"{label}: solve", {}, {"model": model})
    drop = ("model", "results") if study.keep == "metrics" else ()
    return _measure(study, f"{label}: measure", {"model": model, "results": results}, drop)


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
