"""What small changes are of, for elements to say what they do to forces (:mod:`.kernels.variations`)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(slots=True, eq=False)
class Changes:
    """Of variations v in a group: D (v, node, column) of nodal values, in the group's columns; ``others``: the works of
    those whose laws or histories differ, and whether stresses and other laws do; which[v] their number or -1; dJ (v, m,
    g): of relative volumes at the last converged state."""

    D: Floats
    others: list[tuple[Any, bool, bool]]
    which: NDArray[np.int64]
    dJ: Floats
