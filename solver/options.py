"""How a run goes about a problem, as the command line or a program asks for it: one record, checked once."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from numbers import Integral, Real

LINEAR = ("auto", "pardiso", "superlu", "dense", "iterative")
FACTOR = ("auto", "fresh", "reuse")
ACCURACY = 0.1  # the largest relative error of a step, or increment of an iteration, that can be asked for


@dataclass(kw_only=True, eq=False)
class Options:
    """threads 0: all processors this process may use; linear: auto, pardiso, superlu, dense or
    iterative (:mod:`.linear.iterative`).

    memory: GB that a factorisation may take before "auto" turns to iterative; 0, what the machine has left.
    factor: "fresh" renews the factorisation where FEBio does; "reuse" lets time steps lean on earlier ones as long as
    these serve; "auto" does so in large transient biphasic runs with automatic steps and states saved at must points
    (so that no saved time depends on iteration counts), and lets factorisations serve later tangents of other large
    models as far as iterations stay what they are (:mod:`.route`).
    accuracy: relative error per step of second-order steps of their own size (:mod:`.second_order`), for transient
    runs with a fluid; 0, the file's steps.
    tolerance: relative increment of every field at which iterations may end, where the file's is larger; 0, the file's.
    quasi: Broyden's updates where the file has full Newton: fewer factorisations, the same answer to its tolerances.
    stabilise: tau of the pressure projection (:mod:`.kernels.projection`); 0, FEBio's elements; 1 is enough.
    Raises ValueError for what is none of these.
    """

    threads: int = 0
    linear: str = "auto"
    factor: str = "auto"
    stabilise: float = 0.0
    accuracy: float = 0.0
    tolerance: float = 0.0
    quasi: bool = False
    memory: float = 0.0

    def __post_init__(self) -> None:
        if not isinstance(self.threads, Integral) or self.threads < 0:
            raise ValueError(f"threads = {self.threads!r}: give a whole number, 0 for all processors")
        for name, values in (("linear", LINEAR), ("factor", FACTOR)):
            given = getattr(self, name)
            if given not in values:
                raise ValueError(f"{name} = {given!r} is none of {', '.join(values)}")
        for name, most in (("accuracy", ACCURACY), ("tolerance", ACCURACY), ("stabilise", inf), ("memory", inf)):
            given = getattr(self, name)
            if not isinstance(given, Real) or not 0.0 <= given <= most or given == inf:
                limit = f" to {most:g}" if most < inf else " or more"
                raise ValueError(f"{name} = {given!r}: give a number of 0{limit}")
