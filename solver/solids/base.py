"""What a solid material is: a record of values with a stress and a tangent over a batch of points.

Names. A dataclass field of a record is FEBio's tag, with ``_`` added where Python keeps the word for
itself (``lambda_``); see :func:`.registry.field_name`. ``parameters`` are numbers that may vary in time
and space (:class:`..values.Value`), ``options`` are plain integers (flags and enumerations) and
``properties`` are child records or direction fields.

Axes. ``pts.Q`` holds the axes handed down from above. A record with its own ``mat_axis`` multiplies it
in: Q = Q_above Q_own (:meth:`Solid.inner`), and hands the product to its children and fibers.

Nested deformation. A material that loads a child with another deformation gradient (growth, prestrain,
generations) hands it a copy of the points made by :func:`deformed`; history columns are shared, as each
node of the tree owns its own columns.

History. ``history`` is the number of columns a node owns; ``offset`` its first column, set by
:func:`.history.layout`. ``pts.old`` is the state at the last converged time and is never written;
every evaluation writes the columns of ``pts.new`` anew from ``pts.old``, ``F``, ``t`` and ``dt``. The loop
makes ``old`` from ``new`` when a step has converged. ``initial(n)`` gives the state before the first
step. Corrections that augmentations make of a prestrain stand in ``new``, which therefore starts as a copy of ``old``.
A material whose memory grows with time enlarges ``history`` in ``room``, which the loop calls
through :func:`.history.begin` before each step.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import field, fields
from functools import lru_cache
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from ..law import Law
from ..matrices import det
from ..points import Points
from ..record import variable_record
from ..values import Value, as_value

Floats = NDArray[np.float64]
Number = Value | float

NO_TANGENT = np.empty((0, 6, 6))


@variable_record
class Property:
    """A child of a material: its registry table, and whether there may be several or none."""

    table: str
    many: bool = False
    optional: bool = False
    default: str | None = None  # type taken where the file names none


@variable_record
class Solid(Law):
    """A solid. Subclasses are dataclasses whose :class:`Value` fields are its parameters.

    ``stress(pts, s, c)`` *adds* the Cauchy stress to ``s`` (n, 6) and, unless ``c`` is None, the spatial
    elasticity tensor c (per current volume: J^-1 push-forward of 2 dS/dC) to ``c`` (n, 6, 6).
    """

    properties: ClassVar[dict[str, Property]] = {}
    constants: ClassVar[tuple[str, ...]] = ()  # fields the file gives under Globals (R, T)
    history: int = field(default=0, init=False, repr=False)  # columns of the node's own, children not counted
    symmetric: ClassVar[bool] = True  # the tangent has major symmetry
    consistent: ClassVar[bool] = True  # the tangent is the derivative of the stress, history at the step's start held
    uncoupled: ClassVar[bool] = False
    density_: Number = field(default=1.0, kw_only=True)  # per reference volume; the root's counts
    offset: int = field(default=0, init=False, repr=False)

    @property
    def children(self) -> Sequence[Solid]:
        """Records below this one in the material tree."""
        out: list[Solid] = []
        for name in _names(type(self)):  # type: ignore[arg-type]
            v = getattr(self, name)
            if isinstance(v, Solid):
                out.append(v)
            elif isinstance(v, (tuple, list)):
                out += [x for x in v if isinstance(x, Solid)]
        return out

    def walk(self) -> Iterator[Solid]:
        """This record and all below it."""
        yield self
        for child in self.children:
            yield from child.walk()

    def _values(self) -> Sequence[Value]:
        """Scalar parameters, in their order; those of several numbers are had by :meth:`vector`."""
        return [getattr(self, p) for p in self.parameters if p not in self.vectors]

    def vector(self, name: str, pts: Points) -> Floats:
        """A parameter of several numbers as (1|n, k)."""
        cols = np.broadcast_arrays(*(v(pts.t, pts.X, pts.e) for v in getattr(self, name)))
        return np.stack(cols, axis=-1)

    def density(self, pts: Points) -> Floats:
        """Referential mass density (1|n,)."""
        return as_value(self.density_)(pts.t, pts.X, pts.e)

    def inner(self, pts: Points) -> Points:
        """The points as seen with this record's own axes multiplied in."""
        if self.mat_axis is None:
            return pts
        if getattr(self.mat_axis, "steady", False):
            return pts.but(Q=pts.once((self.mat_axis, pts.Q), lambda: self._axes(pts)))
        return pts.but(Q=self._axes(pts))

    def _axes(self, pts: Points) -> Floats:
        own = np.asarray(self.mat_axis(pts))
        return np.ascontiguousarray(own if pts.Q is None else pts.Q @ own)

    def initial(self, n: int) -> Floats:
        """History of ``n`` points before the first step (n, history)."""
        return np.zeros((n, self.history))

    def room(self, pts: Points) -> None:
        """Enlarge ``history`` where the coming step needs it (``pts.old`` has the columns so far)."""

    def take_room(self, columns: int) -> None:
        """Have as large a ``history`` as an earlier state had."""
        raise ValueError(f"the memory of {type(self).__name__} has {self.history} columns, not {columns}")

    def broken(self, pts: Points) -> Floats | float:
        """Fraction of bonds broken (damage) at the state last evaluated, from ``pts.new``."""
        return 0.0

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        raise NotImplementedError

    def energy(self, pts: Points) -> Floats:
        """Strain energy per reference volume (n,); writes no history."""
        raise NotImplementedError(f"{type(self).__name__} gives no strain energy")


@lru_cache(maxsize=None)
def _names(cls: type[Solid]) -> tuple[str, ...]:
    return tuple(f.name for f in fields(cls))


def wanted(c: Floats | None) -> Floats:
    """The tangent as kernels take it: without rows where none is wanted."""
    return NO_TANGENT if c is None else c


def deformed(pts: Points, F: Floats) -> Points:
    """The same points under another deformation gradient ``F`` (n, 3, 3)."""
    F = np.ascontiguousarray(F)
    return pts.but(F=F, J=det(F))


def unwritten(pts: Points) -> Points:
    """The points without ``new``: what asks for an energy must not move the state."""
    return pts if pts.new is None else pts.but(new=None)


def evaluate(solid: Solid, pts: Points, tangent: bool = True) -> tuple[Floats, Floats | None]:
    """Stress (n, 6) and, where wanted, tangent (n, 6, 6) of ``solid`` alone."""
    s = np.zeros((pts.n, 6))
    c = np.zeros((pts.n, 6, 6)) if tangent else None
    solid.stress(pts, s, c)
    return s, c
