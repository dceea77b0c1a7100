"""What a run hands back."""

from __future__ import annotations

from dataclasses import field

from .record import variable_record
from .state import State


@variable_record
class Totals:
    """Work done: time steps, Newton iterations, residuals, reformations, retries, seconds by part.

    Seconds of "compiling" are in no other part, and not in "total".
    """

    steps: int = 0
    iterations: int = 0
    residuals: int = 0
    reforms: int = 0
    retries: int = 0
    lost: int = 0  # iterations, of those above, in tries that failed
    guarded: int = 0  # steps solved by guarded Newton steps, beyond FEBio's retries
    compiled: int = 0  # kernels that no earlier run had left on disk
    seconds: dict[str, float] = field(default_factory=dict)
    linear_solver: str = ""
    factor: dict[str, float] = field(default_factory=dict)


@variable_record
class Result:
    """``converged``, or not and ``reason`` in a sentence; the final state, the times of saved states."""

    converged: bool
    reason: str
    state: State
    totals: Totals
    times: list[float]
    interrupted: bool = False
