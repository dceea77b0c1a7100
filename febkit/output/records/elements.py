"""<element_data>: means over the integration points of elements; 0 where an element has no such thing, as in FEBio.

Principal values are those of the points, largest first, then averaged; effective values (von Mises) and principal
directions are those of the mean tensors.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from febkit.model.sets import element_ids
from febkit.output import plot
from febkit.output.plot.base import Part, full, kept, voigt

from . import Column, Floats, Ints, places

if TYPE_CHECKING:
    from febkit.model import LogEntry
    from febkit.output.plot import View

VOIGT = {"x": 0, "y": 1, "z": 2, "xy": 3, "yz": 4, "xz": 5}
DOUBLE = {"xx": 0, "yy": 1, "zz": 2, "xy": 3, "yz": 4, "xz": 5}
NINE = {a + b: 3 * i + j for i, a in enumerate("xyz") for j, b in enumerate("xyz")}
# symmetric tensors by the letter of their items; those with principal values; those with effective ones
TENSORS = {
    "E": "Lagrange strain", "e": "infinitesimal strain", "U": "right stretch", "V": "left stretch",
    "H": "right Hencky", "h": "left Hencky", "s": "stress", "S": "PK2 stress",
}  # fmt: skip
PRINCIPAL = "EUVHhs"
EFFECTIVE = {
    "effective strain": "", "effective stress": "stress", "effective right stretch": "right stretch",
    "effective left stretch": "left stretch", "effective right Hencky": "right Hencky",
    "effective left Hencky": "left Hencky",
}  # fmt: skip
# item -> plot variable, component of its means
COMPONENTS: dict[str, tuple[str, int]] = {
    **{f"{t}{c}": (v, k) for t, v in TENSORS.items() for c, k in VOIGT.items()},
    **{f"F{c}": ("deformation gradient", k) for c, k in NINE.items()},
    **{f"P{c}": ("PK1 stress", k) for c, k in NINE.items()},
    **{f"w{c}": ("fluid flux", k) for k, c in enumerate("xyz")},
    "J": ("relative volume", 0),
    "p": ("fluid pressure", 0),
    "sed": ("strain energy density", 0),
    "devsed": ("deviatoric strain energy density", 0),
    "porosity": ("porosity", 0),
}


def rows(view: View, entry: LogEntry) -> tuple[Ints, Ints]:
    ids = np.concatenate([np.zeros(0, np.int64), *(p.mesh.element_ids for p in view.parts)])
    return places(entry, ids, element_ids(view.model.mesh, entry.set, entry.where) if entry.set else None)


def column(view: View, name: str, entry: LogEntry) -> Column | None:
    of_part = datum(name)
    return None if of_part is None else partial(over, view, of_part)


def over(view: View, of_part: Callable[[Part], Floats | None]) -> Floats:
    """Values of all elements, part after part."""
    values = [(len(p.mesh.element_ids), of_part(p)) for p in view.parts]
    return np.concatenate([np.zeros(m) if v is None else v for m, v in values])


def datum(name: str) -> Callable[[Part], Floats | None] | None:
    """What gives a datum of a part's elements (m,)."""
    if name in COMPONENTS:
        variable, k = COMPONENTS[name]
        return partial(_component, variable, k)
    if len(name) == 2 and name[0] in PRINCIPAL and name[1] in "123":
        return partial(_principal, TENSORS[name[0]], int(name[1]) - 1)
    if name in EFFECTIVE:
        return partial(_effective, EFFECTIVE[name])
    return OTHERS.get(name)


def means(part: Part, variable: str) -> Floats | None:
    """A plot variable's means over the elements of a part (m, ...), evaluated once a state."""
    give = plot.find(variable)
    return kept(part, ("means", variable), lambda: None if give is None else give(part))


def _component(variable: str, k: int, part: Part) -> Floats | None:
    v = means(part, variable)
    return None if v is None else v.reshape(len(v), -1)[:, k]


def _principal(variable: str, k: int, part: Part) -> Floats | None:
    """Means of principal values, largest first."""

    def values() -> Floats | None:
        v = points(variable)(part) if part.group is not None else None
        return None if v is None else np.linalg.eigvalsh(full(v))[..., ::-1].mean(axis=1)

    w = kept(part, ("principal", variable), values)
    return None if w is None else w[:, k]


def points(variable: str) -> Callable[[Part], Floats | None]:
    """What gives a plot variable at integration points, before it is averaged."""
    return plot.find(variable).points  # type: ignore[union-attr, no-any-return]


def _effective(variable: str, part: Part) -> Floats | None:
    """von Mises value of the mean tensor; FEBio's effective strain is that of (B - I) / 2."""
    v = means(part, variable) if variable else _spatial(part)
    if v is None:
        return None
    x, y, z, xy, yz, xz = v.T
    square = x * x + y * y + z * z - x * y - y * z - x * z + 3.0 * (xy * xy + yz * yz + xz * xz)
    return np.asarray(np.sqrt(np.maximum(square, 0.0)))


def _spatial(part: Part) -> Floats | None:
    """Means of (B - I) / 2."""
    if part.group is None:
        return None
    from febkit.output.plot.kinematics import left

    return np.asarray(voigt(0.5 * (left(part) - np.eye(3))).mean(axis=1))


def _position(k: int, part: Part) -> Floats | None:
    """Mean position of the points."""
    from febkit.output.plot.motion import position

    return None if part.group is None else position(part)[..., k].mean(axis=1)


OTHERS: dict[str, Callable[[Part], Floats | None]] = {c: partial(_position, k) for k, c in enumerate("xyz")}
