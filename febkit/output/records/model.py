"""<model_data>: values of the whole model."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from . import Column, Floats, Ints

if TYPE_CHECKING:
    from febkit.model import LogEntry
    from febkit.output.plot import View

NORM = "solution_norm"


def rows(view: View, entry: LogEntry) -> tuple[Ints, Ints]:
    return np.zeros(1, np.int64), np.zeros(1, np.int64)


def column(view: View, name: str, entry: LogEntry) -> Column | None:
    return (lambda: _norm(view)) if name == NORM else None


def _norm(view: View) -> Floats:
    """Norm of what was solved for (1,): the free unknowns since the step began."""
    system = view.run.system
    if system is None:
        return np.zeros(1)
    free = system.eqs.numbered & (system.eqs.kind == 0)
    return np.array([np.linalg.norm(view.state.d[free])])
