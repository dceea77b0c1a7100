"""From a study to its graph of steps."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .config import Method, Point, Study
from .step import Step
from .store import Store

CONTROL = "control"


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """Steps whose results are the study's: metrics by (case, method, point), agreement likewise.

    ``method`` is a :class:`Method`'s name or "control"; ``point`` an index into the study's points.
    """

    study: Study
    metrics: Mapping[tuple[str, str, int], Step]
    agreement: Mapping[tuple[str, str, int], Step]

    @property
    def targets(self) -> tuple[Step, ...]:
        return (*self.metrics.values(), *self.agreement.values())

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


def make_plan(study: Study) -> Plan:
    """The graph of a study: build, solve, series, drive, solve, measure, compare."""
    metrics: dict[tuple[str, str, int], Step] = {}
    agreement: dict[tuple[str, str, int], Step] = {}
    centre = _centre(study.points)
    for case in study.cases:
        tissue = _tissue(study, case)
        cell = _model("cell", study.cell, case)
        if study.control and centre is not None:
            control = _solved("embedded", study.embedded, case)
            metrics[case, CONTROL, centre] = _measure(study, f"{case} control: measure", control, ())
        for method in study.methods:
            for k in range(len(study.points)):
                metrics[case, method.name, k] = _driven(study, case, method, k, cell, tissue)
            if (case, CONTROL, centre) in metrics and centre is not None:
                inputs = {
                    "control": metrics[case, CONTROL, centre],
                    "test": metrics[case, method.name, centre],
                }
                label = f"{case} order {method.name}: compare"
                agreement[case, method.name, centre] = Step("compare", label, {}, inputs)
    return Plan(study, metrics, agreement)


def _centre(points: Iterable[Point]) -> int | None:
    """Index of the point in the middle of the tissue, where the control's cells are."""
    for k, p in enumerate(points):
        if p == (0.0, 0.0, 0.0):
            return k
    return None


def _model(name: str, table: Mapping[str, Any], case: str) -> Step:
    """The step that makes a model: from its template, or adopted from a user's file."""
    if "file" in table:
        return _adopt(name, {"model": table["file"]})
    params = {k: v for k, v in table.items() if k != "results"}
    if name == "cell":  # the drive comes from the tissue, not from the case
        params |= {"drive": "none"}
        return Step("build", f"{name}: build", {"template": name, "values": params})
    return Step("build", f"{case} {name}: build", {"template": name, "values": {**params, "case": case}})


def _solved(name: str, table: Mapping[str, Any], case: str) -> dict[str, Step]:
    """Steps that hold a model and its plotfile."""
    if "results" in table:
        files = {"results": table["results"]} | ({"model": table["file"]} if "file" in table else {})
        step = _adopt(name, files)
        return {"model": step, "results": step}
    model = _model(name, table, case)
    return {"model": model, "results": Step("solve", f"{case} {name}: solve", {}, {"model": model})}


def _tissue(study: Study, case: str) -> dict[str, Step]:
    return _solved("tissue", study.tissue, case)


def _series(study: Study, case: str, method: Method, tissue: Mapping[str, Step]) -> Step:
    """Series of the tissue's field at all points, of the order that is handed off: one small file."""
    order = max(method.solid or 1, method.fluid or 1)
    params: dict[str, Any] = {"points": [list(p) for p in study.points], **study.coupling, "order": order}
    if method.recovery:
        params["recovery"] = method.recovery
    label = f"{case} tissue: series of order {order} at {len(study.points)} points"
    return Step("series", label + (f", {method.recovery}" if method.recovery else ""), params, dict(tissue))


def _driven(
    study: Study, case: str, method: Method, k: int, cell: Step, tissue: Mapping[str, Step]
) -> Step:
    label = f"{case} order {method.name}" + (f" point {k + 1}" if len(study.points) > 1 else "")
    params: dict[str, Any] = {"point": k, "solid": method.solid, "fluid": method.fluid}
    if method.name == "overlay":
        params |= {"at": list(study.points[k])}
        inputs = {"cell": cell, **{f"tissue_{n}": s for n, s in tissue.items()}}
    else:
        inputs = {"cell": cell, "series": _series(study, case, method, tissue)}
    model = Step("drive", f"{label}: drive", params, inputs)
    results = Step("solve", f"{label}: solve", {}, {"model": model})
    drop = ("model", "results") if study.keep == "metrics" else ()
    return _measure(study, f"{label}: measure", {"model": model, "results": results}, drop)


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
