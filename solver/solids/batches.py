"""Many states of the same points in one batch."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..matrices import det
from ..points import Points
from .base import Floats


def states(pts: Points, F: Floats, J: Floats | None = None) -> Points:
    """Each of n points under b deformation gradients ``F`` (n, b, 3, 3), as n b points in that order; no history."""
    n, b = F.shape[:2]

    def times(x: Any) -> Any:
        return x if x is None or b == 1 or (len(x) == 1 and n > 1) else np.repeat(x, b, axis=0)

    F = np.ascontiguousarray(F.reshape(-1, 3, 3))
    return Points(
        F=F,
        J=det(F) if J is None else np.ascontiguousarray(J.reshape(-1)),
        X=times(pts.X),
        e=times(pts.e),
        t=pts.t,
        dt=pts.dt,
        Q=times(pts.Q),
        extra={k: times(v) if isinstance(v, np.ndarray) and len(v) == n else v for k, v in pts.extra.items()},
    )
