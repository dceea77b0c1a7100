"""The log of a fit by an optimisation file, in the layout of FEBio's."""

from __future__ import annotations

from os import PathLike

import numpy as np
from numpy.typing import NDArray

from febkit._version import __version__
from febkit.files import Output

from .optimise import Optimise
from .problem import Problem, Trial
from .result import Fit
from .statistics import regression

Floats = NDArray[np.float64]


class OptimisationLog:
    """Writes trials as they come, then the best of them. An earlier log stays until the first trial is written."""

    def __init__(self, file: Optimise, path: str | PathLike[str]) -> None:
        self.file, self.output = file, Output(path)
        self.problem: Problem | None = None
        self._text = [f"febkit {__version__}\n\nP A R A M E T E R   O P T I M I Z A T I O N   M O D U L E\n\n",
                      f"\tFILENAME   : {file.where.file}\n\tMETHOD     : {file.method}\n"]  # fmt: skip
        self._text += [f"\tREMARK     : {r}\n" for r in file.remarks]

    def trial(self, t: Trial) -> None:
        self._text.append(f"\n----- Iteration: {t.number} -----\n")
        self._text += [f"{p.name:<15s} = {v:g}\n" for p, v in zip(self.file.parameters, t.values)]
        if t.failure:
            self._text.append(f" *  WARNING\n * {t.failure}\n")
        else:
            self._curve(t)
        self._flush()

    def _curve(self, t: Trial) -> None:
        assert self.problem is not None
        x, y = self.file.objective.x, self.file.objective.y
        (found,) = self.problem.predictions(t.z) or [y]
        if self.file.verbose:
            self._text.append("                        CURRENT        REQUIRED      DIFFERENCE\n")
            rows = zip(x, found, y, np.abs(found - y))
            self._text += [f"{a:15.10g} {b:15.10g} {c:15.10g} {d:15g}\n" for a, b, c, d in rows]
        self._text.append(f"objective value: {t.objective:g}\nregression coef: {regression(y, found):g}\n")

    def end(self, fit: Fit) -> None:
        (found,), (x, y) = fit.curves, (self.file.objective.x, self.file.objective.y)
        w = self._text.append
        w("\nP A R A M E T E R   O P T I M I Z A T I O N   R E S U L T S\n\n\tFunction values:\n")
        w("              X            F(X)\n" + "".join(f"{a:15g} {b:15g}\n" for a, b in zip(x, found)))
        w(f"\n\tTotal iterations ........ : {fit.runs:15d}\n\n")
        w(f"\tFinal objective value ... : {fit.objective:15g}\n\n")
        w(f"\tFinal regression coef ... : {regression(y, found):15g}\n\n\tOptimal parameters:\n\n")
        w("".join(f"\t\t{n:<15s} = {v:.16g}\n" for n, v in fit.values.items()))
        if fit.statistics is not None:
            w("\n\t95 % confidence intervals:\n\n")
            w("".join(f"\t\t{n:<15s} : {low:g} to {high:g}\n" for n, (low, high) in fit.intervals.items()))
            w("".join(f"\n\t{line}\n" for line in fit.identifiability))
        w(f"\n\tTotal elapsed time : {fit.seconds:g} sec\n\n")
        if fit.converged:
            w("\n N O R M A L   T E R M I N A T I O N\n\n")
        else:
            w(f"\n *  ERROR\n * {fit.reason}\n\n E R R O R   T E R M I N A T I O N\n\n")
        self._flush()

    def __enter__(self) -> OptimisationLog:
        return self

    def __exit__(self, *_: object) -> None:
        """The end of a fit that raised; one that had not begun leaves what was there."""
        self.output.close() if self.output.placed else self.output.discard()

    def _flush(self) -> None:
        text, self._text = "".join(self._text), []
        self.output.write(text.encode(errors="surrogateescape"))
        self.output.place()

