"""Solve a model: lower it, run it, let the listeners write."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from os import PathLike, fspath
from pathlib import Path
from typing import TYPE_CHECKING, Any

from febkit.files import Buffer
from febkit.model import InputError, Model, Where, as_record

if TYPE_CHECKING:
    from febkit.output.log import LogListener
    from febkit.solver.graph import MakeGraph
    from febkit.solver.options import Options
    from febkit.solver.problem import Problem
    from febkit.solver.result import Result
    from febkit.solver.run import Listener


def solve(
    model: Model | str | PathLike[str],
    plotfile: str | PathLike[str] | Buffer | None = None,
    logfile: str | PathLike[str] | None = None,
    *,
    threads: int = 0,
    linear: str = "auto",
    factor: str = "auto",
    accuracy: float = 0.0,
    tolerance: float = 0.0,
    quasi: bool = False,
    stabilise: float = 0.0,
    memory: float = 0.0,
    progress: bool = False,
    listeners: Sequence[Listener] = (),
    warn: Callable[[str], None] | None = None,
    data_anywhere: bool = False,
    graph: MakeGraph | None = None,
    checkpoint: str = "",
    resume: bool = False,
    changed: bool = False,
    start: str = "",
) -> Result:
    """Solve ``model``, or the .feb file of that path; write a plotfile and a log where paths are given.

    Earlier results there are replaced as soon as a solved state stands (:mod:`febkit.files`). Data files that the
    model asks for lie in the folder of the log; with ``data_anywhere`` where the model says.

    threads: 0 for all processors; linear: "auto", "pardiso", "superlu", "dense" or "iterative" (needs pyamg);
    factor: "auto", "fresh" or "reuse" (see :class:`febkit.solver.options.Options`). memory: GB that a factorisation may
    take before "auto" turns to the iterative solver; 0 for what the machine has left.
    tolerance: relative increment of displacements, pressures, concentrations at which iterations may end, where the
    file's dtol, ptol, ctol are larger.
    quasi: Broyden's updates where the file has full Newton: fewer factorisations, the same answer to its tolerances.
    accuracy: relative error per step of steps of second order and of their own size, for transient models with
    fluids; 0 for the steps of the file, as FEBio takes them. stabilise: 1 steadies the pressure of steps too small for
    the mesh (:mod:`febkit.solver.kernels.projection`); 0 for FEBio's elements.
    graph: what finds the sparsity that an earlier run left (:class:`febkit.solver.run.Run`); a :class:`febkit.Model`
    brings its own.
    checkpoint: "10min", "30s", "5steps": how often a checkpoint is written beside the plotfile
    (:mod:`febkit.checkpoint`), which is removed after the end, or kept with ",keep". resume: go on from it, with the
    plotfile, log and data files of then; ``changed``: though the model was edited since (other loads, later steps).
    start: "other.xplt" or "other.xplt@TIME": the state of another result to start from (:mod:`febkit.starting`).
    Returns a Result with ``converged``, ``reason``, ``state`` (final nodal fields), ``totals`` and ``times``.
    Raises InputError for bad input and UnsupportedError, before solving, for what febkit does not solve;
    ValueError for an option that means nothing.
    """
    from febkit.feb.validation import require
    from febkit.lower import lower
    from febkit.solver.graph import Graph
    from febkit.solver.options import Options
    from febkit.solver.run import Run

    path = None if isinstance(plotfile, Buffer) else plotfile
    for given in (path, logfile):
        if given is not None and not fspath(given):  # fspath raises TypeError for what is no path
            raise ValueError("a plotfile or logfile needs a name; leave it out to have none written")
    options = Options(
        threads=threads, linear=linear, factor=factor, stabilise=stabilise, accuracy=accuracy, tolerance=tolerance,
        quasi=quasi, memory=memory,
    )  # fmt: skip
    again = getattr(model, "_again", None)
    model = _model(model)
    doubts = require(model)
    data, plan = _destinations(model, path, logfile, checkpoint or resume, start, data_anywhere), None
    if checkpoint or resume or changed:
        from febkit.checkpoint import Plan

        plan = Plan.of(model, path, options, checkpoint, resume, changed)
    marks = plan.marks if plan is not None else lambda _: []
    problem = lower(model)
    if start:
        from febkit.starting import start as begin

        begin(problem, model, start)
    _check(options, problem, model)
    told: list[Listener] = [*listeners]
    say = [warn or (lambda m: warnings.warn(m, stacklevel=3))]

    def tell(message: str) -> None:
        for f in say:
            f(message)

    with ExitStack() as ends:  # of files, where the solver raises
        log: LogListener | None = None
        if logfile is not None:
            from febkit.output.log import LogListener

            log = LogListener(model, logfile, *marks("log"))
            ends.push(log.__exit__)
            say.append(log.warn)
        if data:
            from febkit.output.logdata import LogDataListener

            records = LogDataListener(model, data, tell, marks("data"))
            ends.push(records.__exit__)
            told.append(records)
        if plotfile is not None:
            from febkit.output.plotfile import PlotListener

            plot = PlotListener(model, plotfile, tell, *marks("plotfile"))
            ends.push(plot.__exit__)
            told.append(plot)
        if log is not None:  # after the others, so that it says nothing that is not written yet
            told.append(log)
        if progress:
            from febkit.output.progress import ProgressListener

            told.append(ProgressListener(Path(model.file).name or "solving"))
        if plan is not None and plan.every is not None:
            from febkit.output.checkpoints import CheckpointListener, Writes

            told.append(CheckpointListener(plan, [q for q in told if isinstance(q, Writes)], tell))
        from febkit.output.warned import WarningListener

        for doubt in doubts:
            tell(doubt)
        if graph is None:
            graph = Graph if again is None else ends.enter_context(again.lent()).graphs
        run = Run(problem, [*told, WarningListener(tell)], options, graph)
        ends.callback(run.team.close)
        return run.solve() if plan is None else plan.solve(run)


def _destinations(
    model: Model, plotfile: str | PathLike[str] | None, logfile: str | PathLike[str] | None, checkpoint: bool | str,
    start: str, anywhere: bool,
) -> list[Path]:  # fmt: skip
    """The files of <logfile>'s records. Refuses outputs onto the model, onto each other, onto what is no result."""
    from febkit.feb.read import sources
    from febkit.files import Named, is_ours, keep_apart

    outputs: list[Named] = [(w, p, None) for w, p in (("plotfile", plotfile), ("log", logfile)) if p is not None]
    if checkpoint and plotfile is not None:
        from febkit.checkpoint import beside as named

        outputs.append(("checkpoint", named(plotfile), None))
    data: list[Path] = []
    if model.output.log:
        from febkit.model.data_files import data_files

        beside = Path(logfile or model.file or "febkit")
        data = data_files(model, beside.parent, beside.stem, anywhere)
        outputs += [("data file", path, entry.where) for path, entry in zip(data, model.output.log)]
    inputs: list[Named] = [("model", path, None) for path in sources(model)]
    if start:
        from febkit.starting import place

        inputs.append(("result to start from", place(start)[0], None))
    keep_apart(outputs, inputs)
    for what, path, where in outputs:
        is_ours(path, what, where)
    return data


def _model(given: Any) -> Model:
    if isinstance(given, (str, PathLike)):
        from febkit.feb import read

        return read(given)
    model = as_record(given)
    if not isinstance(model, Model):
        raise TypeError(f"solve() takes a model or the path of a .feb file, not {type(given).__name__}")
    return model


def _check(options: Options, problem: Problem, model: Model) -> None:
    """Raises InputError where this machine or this model cannot have an option: that is no failure of the solve."""
    place = Where(model.file)
    if options.linear == "pardiso":
        from febkit.solver.linear.pardiso import library

        if library() is None:
            raise InputError('linear = "pardiso" needs MKL: pip install mkl, or take "superlu" or "auto"')
    if options.linear == "iterative":
        from febkit.solver.linear import amg

        if not amg.available():
            raise InputError(amg.MISSING)
        if problem.bodies:
            raise InputError('linear = "iterative" does not solve models with rigid bodies', place)
    if options.accuracy:
        from febkit.solver.second_order import refusal

        why = refusal(problem)
        if why:
            raise InputError(f"accuracy = {options.accuracy:g} cannot be had: {why}; leave it out for the file's "
                             "own steps", place)  # fmt: skip
