"""``febkit.sweep``: a model solved at many values of its parameters."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from febkit import observe as observing
from febkit.model import InputError
from febkit.study.config import Resources
from febkit.study.plan import Work
from febkit.study.step import Step
from febkit.study.store import Store

from . import runs
from .content import address
from .design import Range, points, ranges
from .result import Swept, gathered

if TYPE_CHECKING:
    from febkit.modelling import Model

Floats = NDArray[np.float64]
BATCHES, MOST = 40, 25  # of all samples, and samples of a batch at most: what an interruption may cost


@dataclass(frozen=True, slots=True, eq=False)
class Sweep:
    """What is to be solved, and what of each run is kept."""

    model: Model
    over: tuple[Range, ...]
    points: Floats
    observe: dict[str, observing.Observable]
    variables: list[str] | None
    at: list[float] | None
    design: str
    seed: int
    threads: int

    @property
    def paths(self) -> list[str]:
        return [r.path for r in self.over]

    def gather(self, found: Sequence[runs.Found]) -> Swept:
        attrs: dict[str, Any] = {"design": self.design, "seed": self.seed}
        if self.model.units:
            attrs["unit_system"] = self.model.units
        return Swept(gathered(found, self.over, self.points, attrs), self.paths, self.design, self.seed)


def make_sweep(
    model: Model | str | os.PathLike[str], vary: Mapping[str, Sequence[float]], observe: observing.Observe, *,
    samples: int = 64, design: str = "sobol", seed: int = 0, at: Sequence[float] | None = None, threads: int = 1,
) -> Sweep:  # fmt: skip
    """Check all that can be checked before anything is solved. Raises InputError."""
    from febkit.modelling import Model
    from febkit.modelling.solution import kept_at

    m = Model.read(model) if isinstance(model, (str, os.PathLike)) else Model.of(model)
    over, chosen = ranges(vary, m), observing.observables(observe)
    if not chosen:
        raise InputError('say what to observe: observe="reaction top z"')
    wanted = observing.variables(chosen, m.record)
    observing.check(chosen, m.record, wanted)
    times = None if at is None else [float(t) for t in at]
    if times is not None:
        kept_at(m.record, times)
    return Sweep(m, over, points(over, samples, design, seed), chosen, wanted, times, design, seed, threads)


def sweep(
    model: Model | str | os.PathLike[str], vary: Mapping[str, Sequence[float]], *, observe: observing.Observe,
    samples: int = 64, design: str = "sobol", seed: int = 0, at: Sequence[float] | None = None,
    folder: str | os.PathLike[str] | None = None, scheduler: str = "serial", threads: int = 1, workers: int = 0,
    memory: float = 2.0, progress: bool = False,
) -> Swept:  # fmt: skip
    """Solve ``model`` at ``samples`` points of the ranges ``vary``, {path: (low, high)}.

    observe: what is kept of each run, in words ("reaction top z") or as functions of its dataset:
    :mod:`febkit.observe`. design: "sobol", "lhs", "random", "grid" or "saltelli"
    (:data:`febkit.sampling.design.DESIGNS`), with a ``seed``. at: times that are met and kept, instead of the states
    that the model asks for. folder: where results are kept, so that an interrupted sweep goes on; in memory alone where
    none is named. scheduler: "serial" (this process), "local" (worker processes of Dask on this machine) or the address
    of a Dask scheduler; threads and memory (GB) of each run, workers at a time (0: as many as fit).
    Samples that fail are NaN and say why, as do those that an interruption left: ``result.failed``.
    """
    s = make_sweep(model, vary, observe, samples=samples, design=design, seed=seed, at=at, threads=threads)
    if folder is None and scheduler == "serial":
        return s.gather(_here(s, progress))
    with ExitStack() as ends:
        if folder is None:
            folder = ends.enter_context(TemporaryDirectory(prefix="febkit-"))
        p = plan(s, Path(folder), Resources(threads, memory, workers))
        from febkit.study.run import carry_out

        summary = carry_out(p, scheduler, ends.enter_context(_Bar(len(s.points))) if progress else None)
        return p.result({o.key: o.message for o in summary.failed})


def _here(s: Sweep, progress: bool) -> list[runs.Found]:
    """All samples in this process; those that there are when it is interrupted."""
    out: list[runs.Found] = []
    with _Bar(len(s.points)) if progress else ExitStack() as tell:
        try:
            for found in runs.solved(s.model, s.paths, s.points, s.observe, s.variables, s.at, s.threads):
                out.append(found)
                if callable(tell):
                    tell(len(out), len(s.points), None)
        except KeyboardInterrupt:
            pass
    return out


# ---- as steps whose results are kept ---------------------------------------------------------------


@dataclass(frozen=True, slots=True, eq=False)
class Plan(Work):
    """Batches of samples, each a step."""

    sweep: Sweep
    folder: Path
    resources: Resources
    targets: tuple[Step, ...]

    def result(self, failed: Mapping[str, str] | None = None) -> Swept:
        """What there is; ``failed``: batches that a fault ended, and what was said of it."""
        store, out = Store(self.folder), []
        for step in self.targets:
            n = len(step.params["points"])
            if store.has(step.key):
                out += runs.load(store.path(step.key) / runs.FOUND)
            else:
                out += [runs.Found(reason=(failed or {}).get(step.key, runs.NOT_RUN)) for _ in range(n)]
        return self.sweep.gather(out)


def plan(s: Sweep, folder: Path, resources: Resources) -> Plan:
    """The steps of a sweep. Raises InputError for observables that no other process can be told of."""
    for name, o in s.observe.items():
        if o.variables is None:
            raise InputError(f"{name} is a function: sweeps that are kept, or in other processes, take words alone "
                             '("reaction top z")')  # fmt: skip
    file = _written(s.model, folder)
    shared = {
        "model": file.stem, "paths": s.paths, "observe": {n: o.name for n, o in s.observe.items()},
        "variables": s.variables, "at": s.at, "threads": s.threads,
    }  # fmt: skip
    size = max(1, min(MOST, -(-len(s.points) // BATCHES)))
    steps = []
    for k in range(0, len(s.points), size):
        rows = s.points[k : k + size].tolist()
        label = f"sample {k + 1}" + (f" to {k + len(rows)}" if len(rows) > 1 else "")
        params = shared | {"points": rows}
        steps.append(Step("sample", label, params, files={"model": str(file.resolve())}))
    return Plan(s, folder, resources, tuple(steps))


def _written(model: Model, folder: Path) -> Path:
    """The model as a file of its own, named by its content. Raises InputError where no file can say all of it."""
    from febkit.feb import read, write

    content = address(model.record)
    file = folder / f"{content}.feb"
    if not file.is_file():
        folder.mkdir(parents=True, exist_ok=True)
        write(replace(model.record, document=None), file)
        if address(read(file)) != content:
            file.unlink()
            raise InputError("the model says what no single .feb file can: sweep it in this process, without a folder")
    return file


class _Bar:
    """Samples done of all, on a terminal or in a notebook."""

    def __init__(self, total: int) -> None:
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

        columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
        self._bar, self._total = Progress(*columns), total
        self._task = self._bar.add_task("samples", total=total)

    def __enter__(self) -> Callable[[int, int, object], None]:
        self._bar.start()
        return lambda done, total, _: self._bar.update(self._task, completed=done * self._total / total)

    def __exit__(self, *_: object) -> None:
        self._bar.stop()

