"""What each kind of step does, in a folder of its own."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from febkit.model import InputError

if TYPE_CHECKING:
    from febkit.model import Model
    from febkit.solver.result import Result

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
class Try:
    """How hard a solve is tried: seconds after which it is given up (0: none), and whether once more if it fails.

    ``every``: how often a checkpoint is written in ``begun``, where a later sitting goes on; empty: never.
    """

    limit: float = 0.0
    retry: bool = False
    every: str = ""
    begun: Path = Path()


@dataclass(frozen=True, slots=True)
class Job:
    """Where to write, what to do, folders of the inputs by name, and the step's record to add facts to."""

    folder: Path
    params: Mapping[str, Any]
    inputs: Mapping[str, Path]
    record: dict[str, Any]
    files: Mapping[str, str]
    tried: Try = Try()


def build(job: Job) -> None:
    """A model from a template."""
    from febkit import feb, templates

    values = dict(job.params["values"])
    folder = values.pop("template", None)
    model = templates.new(job.params["template"], template=folder, **values)
    feb.write(model, job.folder / MODEL)
    _sized(job, model)


def _sized(job: Job, model: Model) -> None:
    """What is planned by, and told in reports."""
    job.record["nodes"], job.record["unknowns"] = len(model.mesh.X), size(model)
    job.record["elements"] = sum(len(b.ids) for b in model.mesh.blocks)


def size(model: Any) -> int:
    """Unknowns of a model: three for each node, one more with a fluid, one for each solute."""
    from febkit.model.species import solutes

    wet = model.module in ("biphasic", "multiphasic", "solute", "biphasic-FSI")
    return len(model.mesh.X) * (
        3 + wet + (len(solutes(model)) if model.module in ("multiphasic", "solute") else 0)
    )


def adopt(job: Job) -> None:
    """A user's own model or plotfile, linked where the file system can, else copied."""
    from febkit import feb

    for what, name in (("model", MODEL), ("results", RESULTS)):
        if what in job.files:
            try:
                os.link(job.files[what], job.folder / name)
            except OSError:
                shutil.copyfile(job.files[what], job.folder / name)
    if "model" in job.files:
        _sized(job, feb.read(job.folder / MODEL))


def solve(job: Job) -> None:
    """Solve a model, where it fails once more with smaller steps; keeps the plotfile and the log."""
    from febkit import feb, process

    process.keep_freed_memory()
    process.forget_peak()  # of solves that this process did before
    model = feb.read(job.inputs["model"] / MODEL)
    said: list[str] = []
    result = _solved(job, model, said, job.tried.every)
    if not result.converged and job.tried.retry:
        from .again import SAID, smaller_steps

        job.record["before"], job.record["retried"] = result.reason, SAID
        said.clear()
        result = _solved(job, smaller_steps(model), said)
        if not result.converged:
            raise SolveFailed(f"{job.record['before']}; at a second try, {SAID}: {result.reason}")
    if not result.converged:
        raise SolveFailed(result.reason)
    job.record["steps"], job.record["iterations"] = result.totals.steps, result.totals.iterations
    job.record["compiling_seconds"] = round(result.totals.seconds.get("compiling", 0.0), 3)  # in "seconds" too
    job.record["warnings"] = said
    peak = process.peak_memory()
    if peak is not None:
        job.record["peak_memory_mb"] = peak


def _solved(job: Job, model: Model, said: list[str], every: str = "") -> Result:
    """One try; with ``every`` one that goes on where an earlier sitting left it.

    Raises SolveFailed where it takes longer than it may, KeyboardInterrupt where it is interrupted.
    """
    import time

    from febkit.solver.run import Listener, Run
    from febkit.solving import solve as run

    class Limit(Listener):
        """Gives a solve up."""

        until = time.monotonic() + job.tried.limit

        def iteration(self, run: Run, it: object) -> None:
            if time.monotonic() > self.until:
                raise SolveFailed(f"given up after {job.tried.limit:g} s (limit of [run]), at time {run.state.time:g}")

    threads = int(os.environ.get("FEBKIT_THREADS", "0"))
    listeners = [Limit()] if job.tried.limit else []
    go = partial(run, model, threads=threads, warn=said.append, listeners=listeners)
    names = RESULTS, "run.log"
    if not every:
        result = go(*(job.folder / n for n in names))
    else:
        from . import sittings

        result, before, why = sittings.solve(go, job.tried.begun, names, every)
        said += [why] if why else []
        job.record["earlier_seconds"] = round(before, 3)
    if result.interrupted:
        raise KeyboardInterrupt
    if every:
        for n in names if result.converged else ():
            shutil.move(job.tried.begun / n, job.folder / n)
        shutil.rmtree(job.tried.begun, ignore_errors=True)
    return result


def series(job: Job) -> None:
    """Taylor series of the tissue's field at every point, of the order handed off and what it leaves out."""
    from febkit import coupling, results

    options = {k: v for k, v in job.params.items() if k in ("order", "recovery", "own_part", "box")}
    with results.open(job.inputs["results"] / RESULTS, units=job.params.get("units")) as tissue:
        found = coupling.series(tissue, job.params["points"], beyond=True, **options)
    found.to_netcdf(job.folder / SERIES)


def background(job: Job) -> None:
    """A cell model whose surroundings are the tissue's own material at a point."""
    from febkit import feb

    from .background import with_background

    tissue = job.inputs["tissue"] / MODEL
    if not tissue.is_file():
        raise InputError("the tissue has results alone: name its model too, [tissue] file = ..., for its material")
    cell = feb.read(job.inputs["cell"] / MODEL)
    model, job.record["said"] = with_background(cell, feb.read(tissue), job.params["at"], job.params["material"])
    feb.write(model, job.folder / MODEL)


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


KINDS: Mapping[str, Callable[[Job], None]] = {
    "build": build,
    "adopt": adopt,
    "solve": solve,
    "series": series,
    "drive": drive,
    "measure": measure,
    "compare": compare,
    "sample": sample,
    "background": background,
}
