"""Named nodal fields, and the columns they have in nodal arrays (node, column): the one place that knows a column.

A :class:`Layout` lays the fields of a problem side by side. Everything else asks it: for the columns of a field or of
a degree of freedom by FEBio's name, for views of nodal arrays, for the equations of a field.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from .record import value_record

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@value_record
class Field:
    """A nodal field. ``components`` are its degrees of freedom by FEBio's names ("x", "p", "c1").

    ``option`` is FEBio's name of its tolerance ("dtol"), ``tolerance`` the number taken where none is given: of the
    norm of Newton's increments over that of the step's. ``within``: the field whose norm it counts in, where it has
    none of its own.
    """

    name: str
    components: tuple[str, ...]
    option: str
    tolerance: float
    within: str = ""

    @property
    def width(self) -> int:
        """Columns of the field."""
        return len(self.components)


DISPLACEMENT = Field("displacement", ("x", "y", "z"), "dtol", 1e-3)
PRESSURE = Field("fluid pressure", ("p",), "ptol", 1e-2)
ROTATION = Field("rotation", ("u", "v", "w"), "dtol", 1e-3, within="displacement")  # a vector, composed: .rotations


def concentration(solute: int) -> Field:
    """Effective concentration of a solute by its number in the model, from 1."""
    return Field(f"concentration {solute}", (f"c{solute}",), "ctol", 1e-2)


class Layout:
    """Fields side by side. ``width``: columns in all; ``displacement``, ``concentrations``: columns of these, maybe
    none; ``moves``: there is a displacement; ``turns``: there are rotations; ``mixed``: several fields have norms."""

    def __init__(self, fields: Iterable[Field]) -> None:
        self.fields = tuple(fields)
        self._slices: dict[str, slice] = {}
        self._columns: dict[str, int] = {}
        self.width = 0
        for f in self.fields:
            if f.name in self._slices:
                raise ValueError(f"the field {f.name!r} is there twice")
            self._slices[f.name] = slice(self.width, self.width + f.width)
            self._columns |= {c: self.width + k for k, c in enumerate(f.components)}
            self.width += f.width
        self.concentrations = self.columns(*(f.name for f in self.fields if f.option == "ctol"))
        self.moves = DISPLACEMENT.name in self
        self.turns = ROTATION.name in self
        self.mixed = len(self.normed) > 1
        self.displacement = self.columns(*([DISPLACEMENT.name] if self.moves else []))
        self._u = self._slices.get(DISPLACEMENT.name, slice(0, 0))  # asked for at every turn

    @classmethod
    def of(cls, *parts: Iterable[Field]) -> Layout:
        """The fields of several parts, each once, in the order of their first appearance."""
        return cls(dict.fromkeys(f for part in parts for f in part))

    def __contains__(self, name: str) -> bool:
        return name in self._slices

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Layout) and self.fields == other.fields

    def __hash__(self) -> int:
        return hash(self.fields)

    # ---- columns ----------------------------------------------------------------------------------
    def __getitem__(self, name: str) -> slice:
        """Columns of a field. Raises KeyError, naming the fields there are."""
        if name not in self._slices:
            raise KeyError(f"there is no field {name!r}; there are: {', '.join(self._slices) or 'none'}")
        return self._slices[name]

    def columns(self, *names: str) -> Ints:
        """Columns of fields, one after another."""
        return np.concatenate([np.zeros(0, np.int64), *(np.arange(self.width)[self[n]] for n in names)])

    def has(self, component: str) -> bool:
        """Is there a degree of freedom of this name?"""
        return component in self._columns

    def column(self, component: str) -> int:
        """Column of a degree of freedom by FEBio's name. Raises KeyError, naming those there are."""
        if component not in self._columns:
            known = ", ".join(self._columns)
            raise KeyError(f"there is no degree of freedom {component!r}; there are: {known}")
        return self._columns[component]

    def label(self, column: int) -> str:
        """How messages name a column: "x displacement", "fluid pressure"."""
        f = next(f for f in self.fields if self[f.name].start <= column < self[f.name].stop)
        return f.name if f.width == 1 else f"{f.components[column - self[f.name].start]} {f.name}"

    # ---- nodal arrays -----------------------------------------------------------------------------
    def view(self, nodal: Floats, name: str) -> Floats:
        """A field of a nodal array (node, column): (node, width)."""
        return nodal[:, self[name]]

    def scalar(self, nodal: Floats, name: str) -> Floats:
        """A field of one component: (node,)."""
        return nodal[:, self[name].start]

    def u(self, nodal: Floats) -> Floats:
        """The displacement's part of a nodal array (node, 3), or of forces on it; (node, 0) where there is none."""
        return nodal[:, self._u]

    # ---- equations --------------------------------------------------------------------------------
    @property
    def normed(self) -> tuple[Field, ...]:
        """The fields that have norms of their own."""
        return tuple(f for f in self.fields if f.within not in self)

    def equations(self, field: Field, column: Ints) -> Ints:
        """Those equations that count in a field's norm, from the column of each (:class:`.pattern.Equations`)."""
        own = [f.name for f in self.fields if field.name in (f.name, f.within)]
        return np.flatnonzero(np.isin(column, self.columns(*own)))

    def norms(self, nodal: Floats) -> Floats:
        """Norm of each field of a nodal array (field,)."""
        return np.array([np.linalg.norm(self.view(nodal, f.name)) for f in self.fields])
