"""Load curves from points, arrays, pandas series or functions of time."""

from __future__ import annotations

from collections.abc import Iterator, MutableMapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from febkit.feb.tree import number
from febkit.model import Component, InputError, LoadController

from .text import is_number

if TYPE_CHECKING:
    from .model import Model

INTERPOLATE = (
    "LINEAR", "STEP", "SMOOTH", "CUBIC SPLINE", "CONTROL POINTS", "APPROXIMATION", "SMOOTH STEP", "C2-SMOOTH",
)  # fmt: skip
EXTEND = ("CONSTANT", "EXTRAPOLATE", "REPEAT", "REPEAT OFFSET")


@dataclass(frozen=True, slots=True)
class Curve:
    """A load curve: ``points`` ((t, value), ...), how it goes between them and how on beyond."""

    points: tuple[tuple[float, float], ...]
    interpolate: str = "LINEAR"
    extend: str = "CONSTANT"

    @classmethod
    def of(cls, given: Any, interpolate: str = "LINEAR", extend: str = "CONSTANT") -> Curve:
        """A curve of pairs (t, value), an array (n, 2), a pair of arrays, a pandas Series over time, or a Curve."""
        if isinstance(given, Curve):
            return given
        if hasattr(given, "index") and hasattr(given, "to_numpy"):
            pairs = np.column_stack([np.asarray(given.index, dtype=float), given.to_numpy(dtype=float)])
        else:
            try:
                pairs = np.asarray(given, dtype=float)
            except (TypeError, ValueError):
                raise InputError("a load curve is a list of pairs (time, value)") from None
            if pairs.ndim == 2 and pairs.shape[1] != 2 and pairs.shape[0] == 2:
                pairs = pairs.T
        if pairs.ndim != 2 or pairs.shape[1] != 2 or not len(pairs):
            raise InputError(f"a load curve is a list of pairs (time, value), not numbers {pairs.shape}")
        if not np.isfinite(pairs).all() or (np.diff(pairs[:, 0]) < 0).any():
            raise InputError("times of a load curve must be finite and rise")
        for word, known in ((interpolate, INTERPOLATE), (extend, EXTEND)):
            if word.upper() not in known:
                raise InputError(f"{word!r}: choose from {', '.join(known)}")
        return cls(tuple((float(t), float(v)) for t, v in pairs), interpolate.upper(), extend.upper())

    def controller(self, number_: int, name: str | None = None) -> LoadController:
        """The record of this curve."""
        points = Component("points", children=tuple(
            Component("pt", text=f"{number(t)},{number(v)}") for t, v in self.points))  # fmt: skip
        parts = (Component("interpolate", text=self.interpolate), Component("extend", text=self.extend), points)
        spec = Component("load_controller", "loadcurve", name, number_, children=parts)
        return LoadController(number_, "loadcurve", spec, name, self.points)


class Curves(MutableMapping[int, Curve]):
    """The load curves of a model by id: ``m.curves[1] = [(0, 0), (1, 1)]``; :meth:`add` finds an id."""

    def __init__(self, model: Model) -> None:
        self._model = model

    def _records(self) -> dict[int, LoadController]:
        return {c.id: c for c in self._model.record.controllers}

    def __getitem__(self, number_: int) -> Curve:
        c = self._records()[number_]
        if c.type != "loadcurve":
            raise InputError(f'load controller {number_} is a "{c.type}", not a curve: see model.record.controllers')
        between = (c.spec.str("interpolate", "LINEAR") or "LINEAR").upper()
        beyond = (c.spec.str("extend", "CONSTANT") or "CONSTANT").upper()
        return Curve(tuple((float(t), float(v)) for t, v in c.points), between, beyond)

    def __setitem__(self, number_: int, given: Any) -> None:
        old = self._records().get(number_)
        new = Curve.of(given).controller(number_, None if old is None else old.name)
        others = self._model.record.controllers
        if old is None:
            self._model._put(controllers=(*others, new))
        else:
            self._model._put(controllers=tuple(new if c.id == number_ else c for c in others))

    def __delitem__(self, number_: int) -> None:
        if number_ not in self._records():
            raise KeyError(number_)
        self._model._put(controllers=tuple(c for c in self._model.record.controllers if c.id != number_))

    def __iter__(self) -> Iterator[int]:
        return iter(self._records())

    def __len__(self) -> int:
        return len(self._records())

    def add(self, given: Any, name: str | None = None, interpolate: str = "LINEAR", extend: str = "CONSTANT") -> int:
        """The id of a curve: of one that is the same, else of a new one."""
        curve = Curve.of(given, interpolate, extend)
        for k, c in self._records().items():
            if c.type == "loadcurve" and name in (None, c.name) and self[k] == curve:
                return k
        new = max(self._records(), default=0) + 1
        self._model._put(controllers=(*self._model.record.controllers, curve.controller(new, name)))
        return new

    def __repr__(self) -> str:
        return "\n".join(f"{k}: {len(c.points)} points" if c.type == "loadcurve" else f"{k}: {c.type}"
                         for k, c in self._records().items()) or "no load curves"  # fmt: skip


def scaled(c: Component, controller: int | None) -> Component:
    """A parameter that a load controller multiplies."""
    return c if controller is None else replace(c, attrs={**c.attrs, "lc": str(controller)})


def resolved(model: Model, curve: Any) -> int | None:
    """The id of a curve given as an id, points, or nothing."""
    if curve is None:
        return None
    if is_number(curve):
        if int(curve) not in model.curves:
            raise InputError(f"there is no load curve {curve}; there are {', '.join(map(str, model.curves)) or 'none'}")
        return int(curve)
    return model.curves.add(curve)
