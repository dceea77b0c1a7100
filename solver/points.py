"""What a material sees: a batch of integration points, and where it puts its answer."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
FEW = 256  # points of which something is remembered
VOIGT = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))  # components of symmetric tensors, in order


@dataclass(slots=True, eq=False)
class Points:
    """``n`` integration points of one block at one instant. Voigt order xx yy zz xy yz xz throughout.

    F (n, 3, 3) deformation gradient; J (n,) its determinant; X (n, 3) reference positions;
    e (n,) element index within the block; Q (1|n, 3, 3) local material axes as columns, or None for the
    global axes; old/new (n, h) history at the last converged and at the present state (h = what the
    material asks for); t, dt time and step size (dt = 0 outside a time step).
    """

    F: Floats
    J: Floats
    X: Floats
    e: NDArray[np.int64]
    t: float = 0.0
    dt: float = 0.0
    Q: Floats | None = None
    old: Floats | None = None
    new: Floats | None = None
    extra: dict[str, Floats] = field(default_factory=dict)
    known: dict[tuple[int, ...], tuple[tuple[object, ...], Floats]] = field(default_factory=dict)

    @property
    def n(self) -> int:
        return len(self.J)

    def once(self, of: tuple[object, ...], make: Callable[[], Floats]) -> Floats:
        """What ``make`` gives for the places of the points and these objects, made once for all states of few points
        (or where it is one for all): a fiber's direction takes as long as the stress along it."""
        key = tuple(map(id, of))
        found = self.known.get(key)
        if found is not None:
            return found[1]
        made = make()
        if self.n <= FEW or len(made) == 1:
            self.known[key] = of, made  # the objects as well, so that their ids stay theirs
        return made

    def but(self, **other: Any) -> Points:
        """The same points, but for these fields."""
        rest = self.t, self.dt, self.Q, self.old, self.new, self.extra, self.known
        out = Points(self.F, self.J, self.X, self.e, *rest)
        for name, value in other.items():
            setattr(out, name, value)
        return out

    def some(self, rows: NDArray[np.int64]) -> Points:
        """Some of the points, without a history."""
        Q = self.Q if self.Q is None or len(self.Q) == 1 else self.Q[rows]
        return Points(self.F[rows], self.J[rows], self.X[rows], self.e[rows], self.t, self.dt, Q)

    def under(self, F: Floats, J: Floats) -> Points:
        """The same points under another deformation gradient, without a history."""
        return Points(F, J, self.X, self.e, self.t, self.dt, self.Q, extra=self.extra, known=self.known)

    @classmethod
    def at(cls, F: Floats, **kw: object) -> Points:
        """Points at rest in space, for a test or a material driver: only ``F`` matters."""
        F = np.ascontiguousarray(F, dtype=float).reshape(-1, 3, 3)
        n = len(F)
        return cls(F=F, J=np.linalg.det(F), X=np.zeros((n, 3)), e=np.arange(n), **kw)  # type: ignore[arg-type]
