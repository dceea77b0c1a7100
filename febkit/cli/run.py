"""``febkit run``: solve a model."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from febkit import process

from . import exits, printing, signals
from .febio_options import understood
from .numbers import NOT_NEGATIVE, Finite
from .paths import INPUT, Output

if TYPE_CHECKING:
    from febkit.solver.result import Result
    from febkit.solver.run import Run

VTK = (".pvd", ".vtu")
# endings of other kinds of file than a plotfile: nobody who gives one of them wants an .xplt of that name
OTHERS = (".vtk", ".plt", ".nc", ".feb", ".log", ".csv", ".txt", ".xml", ".h5", ".vtm", ".vtp", ".png", ".pdf")


class FebioCommand(click.Command):
    """Takes FEBio's options too, where they mean something or change nothing."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        said: list[str] = []
        args = understood(args, said.append)
        if not {"-silent", "--silent"} & set(args):
            for line in said:
                printing.warn(line)
        return super().parse_args(ctx, args)


def _often(ctx: click.Context, option: click.Parameter, text: str) -> str:
    """What means nothing is a usage error."""
    if text:
        from febkit.checkpoint import Every

        try:
            Every.of(text)
        except ValueError as e:
            raise click.BadParameter(str(e)) from None
    return text


@click.command("run", cls=FebioCommand, short_help="Solve a .feb model.")
@click.argument("model", required=False)
@click.option("-i", "input_", help="The model (FEBio's spelling).")
@click.option("-o", "log", type=Output(), help="Log file (default: beside the model).")
@click.option("-p", "plot", type=Output(),
              help="Plotfile (default: beside the model); as .pvd or .vtu also for ParaView.")
@click.option("-s", "optimise", type=INPUT, help="Fit the model as this optimisation file asks (FEBio's spelling).")
@click.option("-silent", "--silent", is_flag=True, help="Print nothing but errors.")
@click.option("-t", "--threads", type=click.IntRange(0), default=0, show_default="all processors",
              help="Threads to use.")
@click.option("--linear", default="auto", show_default=True,
              type=click.Choice(["auto", "pardiso", "superlu", "dense", "iterative"]),
              help="Linear solver; auto takes iterative (needs pyamg) where a factorisation does not fit in memory.")
@click.option("--memory", type=NOT_NEGATIVE, default=0.0, show_default="what is left", metavar="GB",
              help="What a factorisation may take before auto turns to iterative.")
@click.option("--factor", default="auto", show_default=True, type=click.Choice(["auto", "fresh", "reuse"]),
              help="Lean on factorisations of earlier steps, or renew them where FEBio does.")
@click.option("--accuracy", type=Finite(0.0, 0.1), default=0.0, show_default="the file's steps",
              help="Steps of second order and of their own size, of this relative error each (transient, with fluids).")
@click.option("--tolerance", type=Finite(0.0, 0.1), default=0.0, show_default="the file's dtol, ptol, ctol",
              help="Relative increment of every field at which iterations may end, where the file's is larger.")
@click.option("--stabilise", is_flag=True, help="Steady the pressure where steps are too small for the mesh.")
@click.option("--data-anywhere", is_flag=True,
              help="Let the model write data files outside the folder of the log.")
@click.option("--checkpoint", default="", metavar="every=10min", callback=_often,
              help="Write a checkpoint beside the plotfile so often (s, min, h, steps); \",keep\": one at the end too.")
@click.option("--resume", is_flag=True, help="Go on from the checkpoint of a run that was stopped.")
@click.option("--changed", is_flag=True, help="With --resume: though the model was edited (other loads, later steps).")
@click.option("--from", "start", default="", metavar="OTHER.xplt[@TIME]",
              help="Start from the last state of another result, or from the one at that time.")
@click.option("-v", "--verbose", is_flag=True, help="Print every warning and where the time went.")
def command(
    model: str | None, input_: str | None, log: Path | None, plot: Path | None, optimise: Path | None, silent: bool,
    threads: int, linear: str, memory: float, factor: str, accuracy: float, tolerance: float, stabilise: bool,
    data_anywhere: bool, checkpoint: str, resume: bool, changed: bool, start: str, verbose: bool,
) -> None:
    """Solve MODEL and write its plotfile (.xplt) and log beside it.

    Earlier results there are replaced as soon as a solved state stands in the new ones, and kept where none comes.

    FEBio's own options are accepted where they mean something here; of the others it is said why not.
    Exit code 0: solved; 1: did not converge (states written so far stay readable); 2: bad input, or a
    feature that febkit does not solve; 130: interrupted.
    """
    path = _model(model, input_)
    if changed and not resume:
        raise click.UsageError("--changed means something with --resume alone")
    if log is not None and log.suffix.lower() in (".xplt", *VTK):
        raise exits.Refused(f"{log}: -o names the log; a plotfile is named by -p {log}")
    plot_path, log_path = _plotfile(plot, path), log or path.with_suffix(".log")
    if optimise is not None:
        from .fit import fitted, report

        report(fitted(optimise, path, log, threads or 1, silent), silent=silent)
        return
    process.one_blas_thread()
    process.keep_freed_memory()
    said: list[str] = []
    with process.nothing_collected():
        from febkit.feb import read

        m = read(path)
        from febkit.files import stamp
        from febkit.solver.run import Listener
        from febkit.solving import solve

        class Settled(Listener):
            def start(self, run: Run) -> None:
                process.settled()

        earlier = stamp(plot_path)
        result = solve(
            m, plot_path, log_path, threads=threads, linear=linear, factor=factor, accuracy=accuracy,
            tolerance=tolerance, stabilise=float(stabilise), memory=memory, progress=not silent, warn=said.append,
            data_anywhere=data_anywhere, checkpoint=checkpoint, resume=resume, changed=changed, start=start,
            listeners=[Settled()],
        )  # fmt: skip
    now = stamp(plot_path)
    kept = plot_path.is_file() and now == earlier
    if not silent:
        _report(result, said, verbose)
        _say_written(plot_path, log_path, len(result.times), kept, earlier is not None and not resume)
    if plot is not None and plot.suffix.lower() in VTK and not kept:
        _for_paraview(plot_path, plot, silent)
    if not result.converged:
        printing.fail(f"{path}: {result.reason}")
        raise click.exceptions.Exit(signals.exit_code() if result.interrupted else exits.NO)


def _model(model: str | None, input_: str | None) -> Path:
    """The model's path; as FEBio does, .feb is added to a name without an ending."""
    if model and input_:
        raise click.UsageError(f"two models, {input_} and {model}: solve one at a time")
    name = model or input_
    if not name:
        raise click.UsageError("which model? febkit run MODEL.feb")
    path = Path(name)
    ended = Path(f"{name}.feb")
    if not path.suffix and not path.is_file() and (ended.is_file() or not path.exists()):
        path = ended
    return INPUT.convert(path, None, None)


def _plotfile(plot: Path | None, model: Path) -> Path:
    """Where the plotfile goes: beside what ParaView is to read, where that is asked for."""
    if plot is None:
        return model.with_suffix(".xplt")
    ending = plot.suffix.lower()
    if ending in OTHERS:
        raise exits.Refused(f"-p {plot}: plotfiles are .xplt, or .pvd and .vtu for ParaView; febkit convert "
                                   "makes other kinds of them")
    return plot.with_suffix(".xplt") if ending in VTK else plot


def _for_paraview(plot: Path, target: Path, silent: bool) -> None:
    if not plot.exists():
        return
    from febkit.results.export import export

    written = export(plot, target, overwrite=True)
    if not silent:
        printing.say(f"wrote {target} ({len(written)} files)")


def _say_written(plot: Path, log: Path, states: int, kept: bool, earlier: bool) -> None:
    """Where the results are, and what became of earlier ones."""
    if kept:
        printing.say(f"wrote {log}; {plot} is still that of an earlier run: this one ended before its first solved "
                     "state")
    elif plot.is_file():
        over = ", over an earlier one" if earlier else ""
        printing.say(f"wrote {plot} ({_count(states, 'state')}, {_size(plot)}{over}) and {log}")
    else:
        printing.say(f"wrote {log}; no state was saved" if not plot.exists() else f"wrote {log}")


def _report(result: Result, said: list[str], verbose: bool) -> None:
    import numpy as np

    t, s = result.totals, result.state
    for w in said:
        printing.warn(w)
    ended = "solved to" if result.converged else "stopped at"
    printing.say(
        f" t = {s.time:g} in {t.seconds['total']:.2f} s: {_count(t.steps, 'step')}, "
        f"{_count(t.iterations, 'iteration')}, {_count(t.reforms, 'factorisation')} ({t.linear_solver or 'none'}), "
        f"{_count(t.retries, 'retry', 'retries')}", bold=ended,
    )  # fmt: skip
    if t.compiled:
        from febkit.solver import cache

        once = ", once on this machine" if cache.keeps() else ""
        printing.say(f"  compiling {_count(t.compiled, 'kernel')} took {t.seconds['compiling']:.2f} s more{once}")
    if t.guarded:
        printing.say(f"  {t.guarded} steps by guarded Newton steps, where the retries of the file were spent")
    printing.say(f"  largest displacement {np.linalg.norm(s.u, axis=1).max():.6g}")
    if s.p is not None:
        printing.say(f"  fluid pressure {s.p.min():.6g} to {s.p.max():.6g}")
    if verbose:
        for name, seconds in t.seconds.items():
            printing.say(f"  {name}: {seconds:.2f} s")


def _size(path: Path) -> str:
    size = path.stat().st_size if path.exists() else 0
    return f"{size / 1e6:.1f} MB" if size >= 1e6 else f"{size / 1e3:.0f} kB"


def _count(n: int, noun: str, more: str = "") -> str:
    return f"{n} {noun if n == 1 else more or noun + 's'}"
