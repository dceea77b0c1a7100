"""Which linear solver a scene gets."""

from __future__ import annotations

from .base import LinearError, LinearSolver

DENSE_LIMIT = 150  # equations below which loading MKL costs more than all dense solves of a run


def choose(name: str, equations: int, threads: int, single: bool = False) -> LinearSolver:
    """``auto``: dense LU up to 150 equations, else MKL PARDISO, else SuperLU. Others force one.

    ``single``: PARDISO may keep its factor in single precision (the caller corrects by GMRES).
    """
    from .pardiso import Pardiso, library
    from .superlu import SuperLU

    if name == "auto":
        name = "dense" if equations <= DENSE_LIMIT else "pardiso" if library() is not None else "superlu"
    if name == "dense":
        from .dense import Dense

        return Dense()
    if name == "pardiso":
        return Pardiso(threads, single)
    if name == "superlu":
        return SuperLU()
    raise LinearError(f"unknown linear solver {name!r}: use auto, pardiso, superlu or dense")
