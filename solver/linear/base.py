"""What a linear solver is: analyse a pattern once, factorise values, solve right sides."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from ..record import variable_record

Floats = NDArray[np.float64]


class LinearError(RuntimeError):
    """The factorisation or a solve failed (singular matrix, out of memory)."""


class Stalled(LinearError):
    """An iterative solve did not converge; a smaller time step may."""


@variable_record
class Matrix:
    """Compressed rows, 0-based int32. ``symmetric``: upper triangle only, diagonal always stored.

    ``kept``: what solvers found of the pattern, by kind, for those that come after; None where none will.
    """

    indptr: NDArray[np.int32]
    indices: NDArray[np.int32]
    data: Floats
    symmetric: bool
    kept: dict[Any, list[Any]] | None = None

    @property
    def n(self) -> int:
        return len(self.indptr) - 1

    def take(self, kind: Any) -> Any:
        """What a solver of this kind left, which is the taker's from now on; None where there is nothing."""
        left = self.kept.get(kind) if self.kept else None
        return left.pop() if left else None

    def give(self, kind: Any, found: Any) -> None:
        """Leave what was found of the pattern."""
        if self.kept is not None:
            self.kept.setdefault(kind, []).append(found)


@variable_record
class Unknowns:
    """What the rows of a tangent stand for.

    X (node, 3); node (row,); component (row,) of the displacement, or -1 for a fluid pressure; storage: sparse matrix
    over the pressure rows, their mass over the aggregate modulus at the present state.
    """

    X: Floats
    node: NDArray[np.int64]
    component: NDArray[np.int64]
    storage: Callable[[], Any]


class LinearSolver(Protocol):
    """``name`` goes to the log; ``stats`` holds factor entries, bytes and the like."""

    name: str
    stats: dict[str, float]

    def factor(self, A: Matrix) -> None: ...

    def solve(self, b: Floats) -> Floats: ...

    def close(self) -> None: ...


class Precise(LinearSolver, Protocol):
    """A solver whose factors may be of single precision."""

    single: bool


@runtime_checkable
class Direct(LinearSolver, Protocol):
    """A solver that knows before it factorises how many bytes that will take."""

    def memory(self, A: Matrix) -> float: ...
