"""A constitutive law with parameters that may vary in time and space, over batches of points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import MISSING, field, fields
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from .points import Points
from .record import variable_record
from .values import Value, as_value

Floats = NDArray[np.float64]
Number = Value | float


class PoreCollapse(ArithmeticError):
    """The pores of element ``element`` of a block are closed: J fell to the solid volume fraction."""

    def __init__(self, element: int, J: float, phi_r: float) -> None:
        self.element, self.J, self.phi_r = element, J, phi_r
        super().__init__(f"pores closed: relative volume {J:.4g} at solid volume fraction {phi_r:.4g}")


@variable_record
class Law:
    """Subclasses are dataclasses whose fields are FEBio's tags.

    ``parameters`` names numbers that may vary in time and space, ``vectors`` those that hold several numbers (tag ->
    how many), ``options`` plain integers (flags and enumerations), ``needed`` what is no
    number and must be given.
    """

    parameters: ClassVar[tuple[str, ...]] = ()
    vectors: ClassVar[dict[str, int]] = {}
    options: ClassVar[tuple[str, ...]] = ()
    needed: ClassVar[tuple[str, ...]] = ()
    mat_axis: Any = field(default=None, kw_only=True)  # local axes: pts -> (1|n, 3, 3), columns
    _par: Floats | None = field(default=None, init=False, repr=False)

    def __post_init__(self) -> None:
        for name in self.parameters:
            v = getattr(self, name)
            if name in self.vectors:
                if len(v) != self.vectors[name]:
                    raise ValueError(f"{name} must be {self.vectors[name]} numbers, not {len(v)}")
                setattr(self, name, tuple(as_value(x) for x in v))
            else:
                setattr(self, name, as_value(v))

    @classmethod
    def defaults(cls) -> dict[str, Any]:
        """Parameters and options with the numbers taken where the file gives none."""
        by_name: dict[str, Any] = {f.name: f.default for f in fields(cls)}
        return {n: by_name[n] for n in cls.parameters + cls.options if by_name[n] is not MISSING}

    def _values(self) -> Sequence[Value]:
        out: list[Value] = []
        for name in self.parameters:
            v = getattr(self, name)
            out += v if name in self.vectors else [v]
        return out

    def par(self, pts: Points) -> Floats:
        """Parameters at the points: (1, k) where uniform, else (n, k), vectors laid out in a row."""
        if self._par is not None:
            return self._par
        values = self._values()
        columns = [v(pts.t, pts.X, pts.e) for v in values]
        out = np.empty((max((len(c) for c in columns), default=1), len(columns)))
        for i, c in enumerate(columns):
            out[:, i] = c
        if all(v.constant for v in values):
            self._par = out
        return out

    def axes(self, pts: Points) -> Floats:
        """Local material axes (1|n, 3, 3) as columns: those handed down times the law's own."""
        own = None if self.mat_axis is None else np.asarray(self.mat_axis(pts))
        Q = own if pts.Q is None else pts.Q if own is None else pts.Q @ own
        return np.eye(3)[None] if Q is None else np.ascontiguousarray(Q)

