"""Load controllers by feedback."""

from __future__ import annotations

import numpy as np

from febkit.solver.feedback import Pid

from .base import Floats, View, register


def pid(view: View, name: str = "") -> Floats | None:
    """Measurement, error and output of the PID controller in brackets, or of the first."""
    found = [a for a in view.run.problem.common.loads if isinstance(a, Pid) and name in ("", a.name)]
    return np.array([found[0].measured, found[0].error, found[0].value]) if found else None


register("pid controller", pid, more=True)
