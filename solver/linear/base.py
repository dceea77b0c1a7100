"""What a linear solver is: analyse a pattern once, factorise values, solve right sides."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class LinearError(RuntimeError):
    """The factorisation or a solve failed (singular matrix, out of memory)."""


@dataclass(slots=True)
class Matrix:
    """Compressed rows, 0-based int32. ``symmetric``: upper triangle only, diagonal always stored."""

    indptr: NDArray[np.int32]
    indices: NDArray[np.int32]
    data: Floats
    symmetric: bool

    @property
    def n(self) -> int:
        return len(self.indptr) - 1


class LinearSolver(Protocol):
    """``name`` goes to the log; ``stats`` holds factor entries, bytes and the like."""

    name: str
    stats: dict[str, float]

    def factor(self, A: Matrix) -> None: ...

    def solve(self, b: Floats) -> Floats: ...

    def close(self) -> None: ...
