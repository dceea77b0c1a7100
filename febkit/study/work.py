"""What each kind of step does, in a folder of its own."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from febkit.model import Model

MODEL, RESULTS, SERIES, METRICS, AGREEMENT, ERROR = (
    "model.feb",
    "run.xplt",
    "series.nc",
    "metrics.nc",
    "agreement.nc",
    "error.nc",
)


class SolveFailed(Exception):
    """A solve ended without reaching the end time; the message says why and when."""


@dataclass(frozen=True, slots=True)
class Job:
    """Where to write, what to do, folders of the inputs by name, and the step's record to add facts to."""

    folder: Path
    params: Mapping[str, Any]
    inputs: Mapping[str, Path]
    record: dict[str, Any]
    files: Mapping[str, str]


def build(job: Job) -> None:
    """A model from a template."""
    from febkit import feb, templates

    values = dict(job.params["values"])
    folder = values.pop("template", None)
    model = templates.new(job.params["template"], template=folder, **values)
    feb.write(model, job.folder / MODEL)
    job.record["nodes"] = len(model.mesh.X)
    job.record["elements"] = sum(len(b.ids) for b in model.mesh.blocks)


def adopt(job: Job) -> None:
    """A user's own model or plotfile, linked where the file system can, else copied."""
    for what, name in (("model", MODEL), ("results", RESULTS)):
        if what in job.files:
            try:
                os.link(job.files[what], job.folder / name)
            except OSError:
                shutil.copyfile(job.files[what], job.folder / name)


def solve(job: Job) -> None:
    """Solve a model; keeps the plotfile and the log."""
    from febkit import feb, process
    from febkit.solving import solve as run

    process.keep_freed_memory()
    model = feb.read(job.inputs["model"] / MODEL)
    threads = int(os.environ.get("FEBKIT_THREADS", "0"))
    said: list[str] = []
    result = run(model, job.folder / RESULTS, job.folder / "run.log", threads=threads, warn=said.append)
    if not result.converged:
        raise SolveFailed(result.reason)
    job.record["steps"], job.record["iterations"] = result.totals.steps, result.totals.iterations
    job.record["compiling_seconds"] = round(result.totals.seconds.get("compiling", 0.0), 3)  # in "seconds" too
    job.record["warnings"] = said
    job.record["peak_memory_mb"] = _peak_memory()


def series(job: Job) -> None:
    """Taylor series of the tissue's field at every point, of the order handed off and what it leaves out."""
    from febkit import coupling, results

    options = {k: v for k, v in job.params.items() if k in ("order", "recovery", "own_part", "box")}
    with results.open(job.inputs["results"] / RESULTS, units=job.params.get("units")) as tissue:
        found = coupling.series(tissue, job.params["points"], beyond=True, **options)
    found.to_netcdf(job.folder / SERIES)


def drive(job: Job) -> None:
    """A cell model with the tissue's field on its surface; the checks' findings go into the record."""
    from febkit import coupling, feb
    from febkit.coupling.checks import error_of
    from febkit.coupling.errors import known

    model = feb.read(job.inputs["cell"] / MODEL)
    nodes = coupling.surface_nodes(model.mesh)
    given, driving, point = _handoff(job, model, model.mesh.X[nodes])
    found = coupling.check(given, driving, point)
    job.record["said"], job.record["problems"] = list(found.lines), list(found.problems)
    if driving is not None and known(driving):
        error_of(given, driving, point).to_netcdf(job.folder / ERROR)
    driven = coupling.drive(model, given, nodes)
    lost = coupling.write(driven, job.folder / MODEL)
    job.record["problems"] += [str(x) for x in lost or ()]


def _handoff(job: Job, model: Model, X: Any) -> tuple[Any, Any, int]:
    """What the tissue does at the surface nodes ``X``, the series behind it (None: overlay), its point."""
    from febkit import coupling, results

    if "series" not in job.inputs:
        path = job.inputs["tissue_results"] / RESULTS
        with results.open(path, units=job.params.get("units")) as tissue:
            field = coupling.from_dataset(tissue)
        coupling.same_units(field.units, model.units)
        return coupling.overlay(field, X, job.params["at"]), None, 0
    driving = coupling.read_driving(job.inputs["series"] / SERIES)
    coupling.same_units(driving.attrs.get("unit_system"), model.units)
    point = int(job.params["point"])
    solid, fluid, solute = job.params["solid"], job.params["fluid"], job.params.get("solute")
    order = "auto" if solid is None else solid
    given = coupling.handoff(driving, X, point=point, order=order, fluid_order=fluid, solute_order=solute)
    return given, driving, point


def measure(job: Job) -> None:
    """Metrics of every cell."""
    from febkit import feb, results
    from febkit.metrics import cell_metrics

    path = job.inputs["model"] / MODEL
    model = feb.read(path) if path.is_file() else None
    told = {k: v for k, v in job.params.items() if k != "units"}
    error = job.inputs["model"] / ERROR  # of the hand-off, where it was estimated
    told |= {"error": error} if error.is_file() else {}
    with results.open(job.inputs["results"] / RESULTS, units=job.params.get("units")) as ds:
        cell_metrics(ds, model, **told).to_netcdf(job.folder / METRICS)


def compare(job: Job) -> None:
    """Agreement of a method's metrics with the control's."""
    import xarray as xr

    from febkit.metrics import compare as agree

    with (
        xr.open_dataset(job.inputs["control"] / METRICS) as a,
        xr.open_dataset(job.inputs["test"] / METRICS) as b,
    ):
        agree(a.load(), b.load()).to_netcdf(job.folder / AGREEMENT)


def sample(job: Job) -> None:
    """A model at some points of its parameters: a batch of a sweep (:mod:`febkit.sampling`)."""
    from febkit.sampling.runs import batch

    batch(job.files["model"], job.params, job.folder)


def _peak_memory() -> float:
    """MB this process has held at most, this step or an earlier one."""
    import resource
    import sys

    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return round(peak / (1e6 if sys.platform == "darwin" else 1e3), 1)


KINDS: Mapping[str, Callable[[Job], None]] = {
    "build": build,
    "adopt": adopt,
    "solve": solve,
    "series": series,
    "drive": drive,
    "measure": measure,
    "compare": compare,
    "sample": sample,
}
