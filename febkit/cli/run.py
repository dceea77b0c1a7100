"""``febkit run``: solve a model."""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from pathlib import Path

import click


@click.command("run", short_help="Solve a .feb model.")
@click.argument("model", required=False, type=click.Path(dir_okay=False))
@click.option("-i", "input_", type=click.Path(dir_okay=False), help="The model (FEBio's spelling).")
@click.option("-o", "log", type=click.Path(dir_okay=False), help="Log file (default: beside the model).")
@click.option("-p", "plot", type=click.Path(dir_okay=False), help="Plotfile (default: beside the model).")
@click.option("-silent", "--silent", is_flag=True, help="Print nothing but errors.")
@click.option("-t", "--threads", default=0, show_default="all processors", help="Threads to use.")
@click.option("--linear", default="auto", show_default=True,
              type=click.Choice(["auto", "pardiso", "superlu", "dense", "iterative"]),
              help="Linear solver; auto takes iterative (needs pyamg) where a factorisation does not fit in memory.")
@click.option("--memory", type=click.FloatRange(0.0), default=0.0, show_default="what is left", metavar="GB",
              help="What a factorisation may take before auto turns to iterative.")
@click.option("--factor", default="auto", show_default=True, type=click.Choice(["auto", "fresh", "reuse"]),
              help="Keep factorisations over time steps, or renew them where FEBio does.")
@click.option("--accuracy", type=click.FloatRange(0.0, 0.1), default=0.0, show_default="the file's steps",
              help="Steps of second order and of their own size, of this relative error each (transient biphasic).")
@click.option("--stabilise", is_flag=True, help="Steady the pressure where steps are too small for the mesh.")
@click.option("--data-anywhere", is_flag=True,
              help="Let the model write data files outside the folder of the log.")
@click.option("-v", "--verbose", is_flag=True, help="Print every warning and where the time went.")
def command(
    model: str | None, input_: str | None, log: str | None, plot: str | None, silent: bool, threads: int,
    linear: str, memory: float, factor: str, accuracy: float, stabilise: bool, data_anywhere: bool, verbose: bool,
) -> None:
    """Solve MODEL and write its plotfile (.xplt) and log beside it.

    Earlier results there are replaced as soon as a solved state stands in the new ones, and kept where none comes.

    Exit code 0: solved; 1: did not converge (states written so far stay readable); 2: bad input, or a
    feature that febkit does not solve.
    """
    path = Path(model or input_ or "")
    if not (model or input_):
        raise click.UsageError("which model? febkit run MODEL.feb")
    # numpy's BLAS multiplies small matrices only, on threads that are the solver's own
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    _keep_freed_memory()
    from febkit.feb import read
    from febkit.model.source import InputError

    if not path.is_file():
        raise InputError(f"{path}: there is no such file")
    m = read(path)
    plot_path, log_path = Path(plot or path.with_suffix(".xplt")), Path(log or path.with_suffix(".log"))
    from febkit.files import stamp
    from febkit.solving import solve

    said: list[str] = []
    earlier = stamp(plot_path)
    result = solve(
        m, plot_path, log_path, threads, linear, factor, accuracy, float(stabilise), memory, not silent,
        warn=said.append, data_anywhere=data_anywhere,
    )  # fmt: skip
    now = stamp(plot_path)
    kept = plot_path.is_file() and now == earlier
    if not silent:
        _report(result, said, verbose)
        _say_written(plot_path, log_path, len(result.times), kept, earlier is not None)
    if not result.converged:
        print(f"febkit: {path}: {result.reason}", file=sys.stderr)
        sys.exit(130 if result.interrupted else 1)


def _keep_freed_memory() -> None:
    """Have glibc keep up to 256 MB that were freed, where the C library is glibc.

    Stresses and tangents of every iteration take arrays of the same sizes; given back to the system each time, a
    third of a solve's processor time went into the kernel's clearing of pages (``mallopt``, glibc manual).
    """
    if sys.platform != "linux":
        return
    import ctypes

    with suppress(AttributeError, OSError):
        mallopt = ctypes.CDLL(None).mallopt
        trim, map_above = -1, -3
        mallopt(trim, 256 << 20)
        mallopt(map_above, 32 << 20)


def _say_written(plot: Path, log: Path, states: int, kept: bool, earlier: bool) -> None:
    """Where the results are, and what became of earlier ones."""
    if kept:
        print(f"wrote {log}; {plot} is still that of an earlier run: this one ended before its first solved state")
    elif plot.is_file():
        over = ", over an earlier one" if earlier else ""
        print(f"wrote {plot} ({states} states, {plot.stat().st_size / 1e6:.1f} MB{over}) and {log}")
    else:
        print(f"wrote {log}; no state was saved" if not plot.exists() else f"wrote {log}")


def _report(result: object, said: list[str], verbose: bool) -> None:
    import numpy as np
    from rich.console import Console

    from febkit.solver.result import Result

    assert isinstance(result, Result)
    out, t, s = Console(highlight=False), result.totals, result.state
    for w in said:
        out.print(f"[yellow]warning[/] {w}")
    word = "solved" if result.converged else "stopped"
    out.print(
        f"[bold]{word}[/] to t = {s.time:g} in {t.seconds['total']:.2f} s: {t.steps} steps, {t.iterations} iterations, "
        f"{t.reforms} factorisations ({t.linear_solver}), {t.retries} retries"
    )
    if t.compiled:
        from febkit.solver import cache

        kernels = "1 kernel" if t.compiled == 1 else f"{t.compiled} kernels"
        once = ", once on this machine" if cache.keeps() else ""
        out.print(f"  compiling {kernels} took {t.seconds['compiling']:.2f} s more{once}")
    if t.guarded:
        out.print(f"  {t.guarded} steps by guarded Newton steps, where the retries of the file were spent")
    out.print(f"  largest displacement {np.linalg.norm(s.u, axis=1).max():.6g}")
    if s.p is not None:
        out.print(f"  fluid pressure {s.p.min():.6g} to {s.p.max():.6g}")
    if verbose:
        for name, seconds in t.seconds.items():
            out.print(f"  {name}: {seconds:.2f} s")
