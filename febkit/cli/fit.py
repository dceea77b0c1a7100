"""``febkit fit``: parameters of models from experiments."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from febkit import process

from . import exits, printing, signals
from .outputs import FORCE, check
from .paths import INPUT, Output

if TYPE_CHECKING:
    from febkit.fitting import Fit


@click.command("fit", short_help="Fit parameters of models to experiments.")
@click.argument("fit", type=INPUT)
@click.argument("model", type=INPUT, required=False)
@click.option("-i", "input_", type=INPUT, help="The model of an optimisation file (FEBio's spelling).")
@click.option("-o", "log", type=Output(), help="Log of an optimisation file (default: beside it).")
@click.option("-w", "--write", type=Output(".feb"), help="Write the (first) model with the fitted values.")
@click.option("-d", "--data", type=Output(".csv"), help="Write data, fitted curves and residuals.")
@click.option("-p", "--plot", type=Output(".png", ".pdf", ".svg"), help="Draw data, fitted curves and residuals.")
@click.option("-t", "--threads", type=click.IntRange(0), default=1, show_default=True, help="Threads of each solve.")
@click.option("-silent", "--silent", is_flag=True, help="Print nothing but errors.")
@FORCE
def command(
    fit: Path, model: Path | None, input_: Path | None, log: Path | None, write: Path | None, data: Path | None,
    plot: Path | None, threads: int, silent: bool, force: bool,
) -> None:
    """Fit what FIT asks for: a fit.toml, or an optimisation file of FEBio's and the MODEL it is for.

    Exit code 0: fitted; 1: ended before it was done, the best so far is said; 2: bad input, or a model that does not
    solve at its starting values; 130: interrupted, the best so far is said.
    """
    if model is not None and input_ is not None:
        raise click.UsageError(f"two models, {input_} and {model}: fit one at a time")
    found = fitted(fit, model or input_, log, threads, silent, (write, data, plot), force)
    report(found, write, data, plot, silent, force)


def fitted(
    path: Path, model: Path | None, log: Path | None, threads: int, silent: bool,
    outputs: tuple[Path | None, ...] = (), force: bool = False,
) -> Fit:
    """The fit that a file asks for. ``outputs``: files for its model, and others, that are none of its inputs."""
    process.one_blas_thread()
    process.keep_freed_memory()
    if path.suffix.lower() == ".toml":
        if model is not None or log is not None:
            raise exits.Refused(f"{path} names its models itself, and has no log" if model else f"{path} has no log")
        return _of_toml(path, threads, silent, outputs, force)
    if model is None:
        raise exits.Refused(f"{path}: an optimisation file names no model: febkit fit {path} MODEL.feb")
    _keep_apart(outputs, [path, model], force)
    return _of_febio(path, model, log or path.with_suffix(".log"), threads, silent)


def _keep_apart(outputs: tuple[Path | None, ...], inputs: list[Path], force: bool) -> None:
    check(outputs[:1], inputs, force)
    check(outputs[1:], inputs)


def _of_toml(path: Path, threads: int, silent: bool, outputs: tuple[Path | None, ...], force: bool) -> Fit:
    from febkit.fitting import fit, toml
    from febkit.model import InputError

    asked = toml.read(path)
    named = [f for e in asked.experiments for f in (e.model, e.data) if isinstance(f, Path)]
    _keep_apart(outputs, [path, *named], force)
    try:
        return fit(asked.experiments, asked.parameters, progress=not silent, threads=threads, **asked.options)
    except InputError as e:
        own = [n for x in asked.experiments for n in [*x.parameters, *x.settings]]
        raise toml.placed(e, path, [*asked.parameters, *own]) from None


def _of_febio(path: Path, model: Path, log: Path, threads: int, silent: bool) -> Fit:
    from febkit.feb import read
    from febkit.files import is_ours, keep_apart
    from febkit.fitting import febio, optimise
    from febkit.fitting.log import OptimisationLog
    from febkit.fitting.progress import Progress

    file, m = optimise.read(path), read(model)
    keep_apart([("log", log, None)], [("model", model, None), ("optimisation file", path, None)])
    is_ours(log, "log")
    if not silent:
        for remark in file.remarks:
            printing.warn(f"{path}: {remark}")
    with OptimisationLog(file, log) as written:
        problem = written.problem = febio.posed(file, m, threads=threads)
        if silent:
            problem.tell = written.trial
            found = febio.carried_out(file, problem)
        else:
            with Progress(problem.parameters.names, written.trial) as shown:
                problem.tell = shown.trial
                found = febio.carried_out(file, problem)
        written.end(found)
    if not silent:
        printing.say(f"wrote {log}")
    return found


def report(
    found: Fit, write: Path | None = None, data: Path | None = None, plot: Path | None = None, silent: bool = False,
    force: bool = False,
) -> None:
    """Say what was found, write what is asked for, and end with the exit code."""
    if not silent:
        printing.say(repr(found))
    if write is not None:
        from febkit.feb import write as put

        put(found.model().record, write, None, force)
    if data is not None:
        from febkit.files import written

        with written(data) as part:
            found.data().to_csv(part, index=False)
    if plot is not None:
        from febkit.plots import save

        save(found.plot(), plot)
    for path in (write, data, plot):
        if path is not None and not silent:
            printing.say(f"wrote {path}")
    if not found.converged:
        printing.fail(found.reason)
        raise click.exceptions.Exit(signals.exit_code() if found.interrupted else exits.NO)
