"""The log of a run, in FEBio's layout, so that tools which read FEBio's logs read ours."""

from __future__ import annotations

from os import PathLike
from time import perf_counter

from febkit._version import __version__
from febkit.files import Mark, Output
from febkit.model import Model
from febkit.solver.newton import Counts, Iteration
from febkit.solver.result import Result
from febkit.solver.run import Listener, Run

OFTEN = 0.1  # s between writes within a time step


class LogListener(Listener):
    """Writes convergence blocks, time steps and the summary; warnings as they come.

    An earlier log in its place stays until a solved state is saved, or the run ends. What the log calls converged
    was saved before: it must be the last of the listeners that write.
    """

    what = "log"

    def __init__(self, model: Model, path: str | PathLike[str], mark: Mark | None = None) -> None:
        self.model = model
        self.output = Output(path, mark=mark)
        self._text = [f"febkit {__version__}\n\n" if mark is None else "\n"]
        self._began = self._ended = False
        self._flushed = perf_counter()

    def write(self, text: str) -> None:
        self._text.append(text)

    def marks(self) -> list[Mark | None]:
        """How far the file stands."""
        self._flush()
        return [self.output.mark()]

    def _flush_in_time(self) -> None:
        """Who follows the log is not kept waiting; short iterations share one write."""
        if perf_counter() - self._flushed > OFTEN:
            self._flush()

    def _flush(self) -> None:
        self._flushed = perf_counter()
        text, self._text = "".join(self._text), []
        self.output.write(text.encode(errors="surrogateescape"))

    def warn(self, message: str) -> None:
        self.write(f" *  WARNING\n * {message}\n\n")

    def compiling(self, run: Run, kernel: str) -> None:
        self.write(f"compiling {kernel}\n")

    def start(self, run: Run) -> None:
        if run.resumed is not None:
            self.write(f"\n======= going on from the checkpoint at time : {run.resumed.time:g} =======\n")
            return
        m = self.model
        elements = sum(g.m for g in run.groups)
        self.write(f"\tFILENAME   : {m.file}\n\tMODULE     : {m.module}\n\n")
        self.write(f"\tNr of nodes ............................... : {len(m.mesh.X)}\n")
        self.write(f"\tNr of elements ............................ : {elements}\n")
        self.write(f"\tNr of threads ............................. : {run.team.n}\n\n")
        for g in run.groups:
            law = type(g.block.solid).__name__
            self.write(f"\tpart {g.block.name}: {g.m} {g.block.element}, {law}, {g.block.physics.name}\n")
        self.write("\n")

    def begin_analysis(self, run: Run) -> None:
        s, system = run.step, run.system
        assert system is not None
        self._began = True
        self.write(f"\nstep {run.index + 1}{f' ({s.name})' if s.name else ''}: {s.analysis}\n")
        self.write(f"\tNr of equations ........................... : {len(system.eqs.rows)}\n")
        self.write(f"\tstiffness matrix .......................... : {'symmetric' if system.symmetric else 'unsymmetric'}\n")  # noqa: E501
        self.write(f"\tlinear solver ............................. : {run.totals.linear_solver}\n")
        if not self.output.replaces:
            self.output.place()

    def remeshed(self, run: Run) -> None:
        nodes, elements = len(run.problem.X), sum(g.m for g in run.groups)
        self.write(f"\n Mesh Statistics:\n \tNumber of nodes    : {nodes}\n \tNumber of elements : {elements}\n\n")

    def begin_step(self, run: Run, number: int, time: float) -> None:
        self.write(f"\n===== beginning time step {number} : {time:.8g} =====\n")
        self._flush_in_time()

    def iteration(self, run: Run, it: Iteration) -> None:
        norms = [f"\t   {k:<17s}{n.initial:15e} {n.now:15e} {n.required:15e} \n" for k, n in it.norms.items()]
        self.write(
            f" {it.number}\n Nonlinear solution status: time= {it.time:g}\n"
            f"\tstiffness updates             = {it.updates}\n"
            f"\tright hand side evaluations   = {it.residuals}\n"
            f"\tstiffness matrix reformations = {it.reforms}\n"
            f"\tstep from line search         = {it.line:f}\n"
            f"\tconvergence norms :     INITIAL         CURRENT         REQUIRED\n{''.join(norms)}"
        )
        self._flush_in_time()

    def converged(self, run: Run, counts: Counts) -> None:
        arc = run.newton.arc
        if arc is not None:
            self.write(f"\tarc-length factor    : {arc.factor:g}\n")
        self.write(
            f"\nconvergence summary\n    number of iterations   : {counts.iterations}\n"
            f"    number of reformations : {counts.factorisations}\n"
            f"\n------- converged at time : {run.state.time:g}\n\n"
        )

    def save(self, run: Run, status: int) -> None:
        self._flush()
        if run.totals.steps:
            self.output.place()

    def failed(self, run: Run, reason: str, again: float | None) -> None:
        self.write(f" *  WARNING\n * {reason}\n\n------- failed to converge\n\n")
        if again is not None:
            self.write(f"Retrying time step.\n\nAUTO STEPPER: retry step, dt = {again:g}\n\n")
        self._flush()

    def end(self, run: Run, result: Result) -> None:
        t, w = result.totals, self.write
        w("\n N O N L I N E A R   I T E R A T I O N   S U M M A R Y\n\n")
        w(f"\tNumber of time steps completed .................... : {t.steps}\n")
        w(f"\tTotal number of equilibrium iterations ............ : {t.iterations}\n")
        w(f"\tTotal number of right hand evaluations ............ : {t.residuals}\n")
        w(f"\tTotal number of stiffness reformations ............ : {t.reforms}\n")
        w(f"\tTotal number of retries ........................... : {t.retries}\n")
        if t.lost:
            w(f"\tIterations in failed tries (none in FEBio's totals) . : {t.lost}\n")
        if t.guarded:
            w(f"\tSteps by guarded Newton steps, beyond these ....... : {t.guarded}\n")
        w("\n")
        for name, value in t.factor.items():
            w(f"\tlinear solver {name.replace('_', ' ')}: {value:g}\n")
        w("\n T I M I N G S\n\n")
        for name, seconds in t.seconds.items():
            w(f"\t{name}: {seconds:.3f} s\n")
        if result.converged:
            w("\n N O R M A L   T E R M I N A T I O N\n\n")
        else:
            self._error(result.reason)
        self._close()

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: object) -> None:
        """The end of a run that raised; one that had not begun leaves what was there."""
        if self._ended:
            return
        if not self._began:
            self.output.discard()
            return
        self._error(f"the run was stopped by {kind.__name__ if kind else 'its caller'}: {error}")
        try:
            self._close()
        except OSError:  # most likely the very error that stopped the run
            self.output.close()

    def _error(self, reason: str) -> None:
        self.write(f"\n *  ERROR\n * {reason}\n\n E R R O R   T E R M I N A T I O N\n\n")

    def _close(self) -> None:
        self._ended = True
        self._flush()
        self.output.close()
