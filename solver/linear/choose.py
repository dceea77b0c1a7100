"""Which linear solver a scene gets."""

from __future__ import annotations

from .base import LinearError, LinearSolver, Unknowns

DENSE_LIMIT = 250  # equations below which loading MKL costs more than all dense solves of a run
PARALLEL = 3000  # equations below which threads cost a factorisation more than they save, most of all on a busy machine


def choose(
    name: str, equations: int, threads: int, single: bool = False, unknowns: Unknowns | None = None,
    mixed: bool = False, pivoting: bool = False,
) -> LinearSolver:  # fmt: skip
    """``auto``: dense LU up to 250 equations, else MKL PARDISO, else SuperLU. Others force one.

    ``single``: PARDISO may keep its factor in single precision (the caller corrects by GMRES).
    ``mixed``: there are pressures or penalties; ``pivoting``: LDL^T pivots from the start.
    ``unknowns``: what "iterative" builds its blocks from.
    """
    if name == "iterative" and unknowns is not None:
        from .iterative import Iterative

        return Iterative(unknowns)
    if name == "dense" or (name == "auto" and equations <= DENSE_LIMIT):
        from .dense import Dense

        return Dense()
    from .pardiso import Pardiso, library

    if name == "pardiso" or (name == "auto" and library() is not None):
        return Pardiso(threads if equations >= PARALLEL else 1, single, mixed, pivoting)
    if name in ("auto", "superlu"):
        from .superlu import SuperLU

        return SuperLU()
    raise LinearError(f"unknown linear solver {name!r}: use auto, pardiso, superlu, dense or iterative")
