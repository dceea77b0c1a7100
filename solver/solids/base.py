"""What a solid material is: a record of values with a stress and a tangent over a batch of points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, fields
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ..points import Points
from ..values import Value, as_value

Floats = NDArray[np.float64]


@dataclass(eq=False)
class Solid:
    """A solid. Subclasses are dataclasses whose :class:`Value` fields are its parameters.

    ``stress(pts, s, c)`` *adds* the Cauchy stress to ``s`` (n, 6) and, unless ``c`` is None, the spatial
    elasticity tensor c (per current volume: J^-1 push-forward of 2 dS/dC) to ``c`` (n, 6, 6).
    """

    parameters: ClassVar[tuple[str, ...]] = ()
    history: ClassVar[int] = 0  # doubles per integration point, the node's own (children not counted)
    symmetric: ClassVar[bool] = True  # the tangent has major symmetry
    uncoupled: ClassVar[bool] = False
    _par: Floats | None = field(default=None, init=False, repr=False)
    offset: int = field(default=0, init=False, repr=False)  # first history column, set by the block

    def __post_init__(self) -> None:
        for name in self.parameters:
            setattr(self, name, as_value(getattr(self, name)))

    @property
    def children(self) -> Sequence[Solid]:
        """Solids below this one in the material tree."""
        out: list[Solid] = []
        for f in fields(self):
            v = getattr(self, f.name)
            if isinstance(v, Solid):
                out.append(v)
            elif isinstance(v, (tuple, list)):
                out += [x for x in v if isinstance(x, Solid)]
        return out

    def par(self, pts: Points) -> Floats:
        """Parameters at the points: (1, k) where uniform, else (n, k), in the order of ``parameters``."""
        if self._par is not None:
            return self._par
        values: list[Value] = [getattr(self, p) for p in self.parameters]
        cols = [v(pts.t, pts.X, pts.e) for v in values]
        m = max((len(c) for c in cols), default=1)
        out = np.empty((m, len(cols)))
        for i, c in enumerate(cols):
            out[:, i] = c
        if all(v.constant for v in values):
            self._par = out
        return out

    def density(self, pts: Points) -> Floats:
        """Referential mass density (1|n,)."""
        v: Any = getattr(self, "rho", None)
        return np.zeros(1) if v is None else as_value(v)(pts.t, pts.X, pts.e)

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        raise NotImplementedError

    def energy(self, pts: Points) -> Floats:
        """Strain energy per reference volume (n,)."""
        raise NotImplementedError(f"{type(self).__name__} gives no strain energy")
