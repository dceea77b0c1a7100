"""<element_data>: means over the integration points of elements; 0 where an element has no such thing, as in FEBio.

Principal values are those of the points, largest first, then averaged; effective values (von Mises) and principal
directions are those of the mean tensors.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from febkit.model.sets import element_ids
from febkit.output import plot
from febkit.output.plot.base import Part, full, kept, voigt
from febkit.output.plot.stresses import UPPER

from . import Column, Floats, Ints, places, species

if TYPE_CHECKING:
    from febkit.model import LogEntry
    from febkit.output.plot import View

VOIGT = {"x": 0, "y": 1, "z": 2, "xy": 3, "yz": 4, "xz": 5}
DOUBLE = {"xx": 0, "yy": 1, "zz": 2, "xy": 3, "yz": 4, "xz": 5}
PAIRS = tuple(DOUBLE)
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
    "devsed": ("deviatoric strain energy density", 0),
    "porosity": ("porosity", 0),
    **{f"Kp{c}": ("permeability", k) for c, k in DOUBLE.items()},
    **{f"es{c}": ("solid stress", k) for c, k in DOUBLE.items()},
    **{f"c{PAIRS[i]}{PAIRS[j]}": ("elasticity", k) for k, (i, j) in enumerate(UPPER)},
    "cF": ("fixed charge density", 0),
    "psi": ("electric potential", 0),
    "crc": ("receptor-ligand concentration", 0),
    **{f"Ie{c}": ("current density", k) for k, c in enumerate("xyz")},
    "D": ("damage", 0),
    "wf": ("fatigue bond fraction", 0),
    "ops": ("octahedral plastic strain", 0),
    "discrete element stretch": ("discrete element stretch", 0),
    "discrete element elongation": ("discrete element elongation", 0),
    "discrete element force": ("discrete element signed force", 0),
    **{f"Fde.{c}": ("discrete element force", k) for k, c in enumerate("xyz")},
}
# item with a number -> plot variable of that solid of a mixture, component
NUMBERED: dict[str, tuple[str, int]] = {
    "damage_": ("damage", 0),
    **{f"mixture_stress.{c}": ("mixture stress", k) for c, k in DOUBLE.items()},
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
        return partial(_wy if name == "wy" else _component, *COMPONENTS[name])
    if len(name) == 2 and name[0] in PRINCIPAL and name[1] in "123":
        return partial(_principal, TENSORS[name[0]], int(name[1]) - 1)
    if name in EFFECTIVE:
        return partial(_effective, EFFECTIVE[name])
    if name.startswith("="):
        return formula(name[1:])
    return _numbered(name) or OTHERS.get(name) or species.datum(name)


def formula(text: str) -> Callable[[Part], Floats | None] | None:
    """A formula of element data; None where it has a name that is none of them."""
    from febkit.model.math import compile

    f = compile(text, None, {})
    data = {name: datum(name) for name in f.names}
    if any(d is None for d in data.values()):
        return None

    def values(part: Part) -> Floats:
        m = len(part.mesh.element_ids)
        given = {n: d(part) for n, d in data.items() if d is not None}
        at = {n: np.zeros(m) if v is None else v for n, v in given.items()}
        return np.broadcast_to(np.asarray(f.at(at), float), (m,))

    return values


def _numbered(name: str) -> Callable[[Part], Floats | None] | None:
    """Data of a solid of a mixture: damage_1 of the first, mixture_stress[0].xx of the first."""
    found = re.fullmatch(r"(damage_)([1-8])|(mixture_stress)\[([0-2])\](\.\w+)", name)
    if found is None or (found[3] and f"{found[3]}{found[5]}" not in NUMBERED):
        return None
    variable, k = NUMBERED[found[1] or f"{found[3]}{found[5]}"]
    which = f"solid[{int(found[2]) - 1 if found[2] else int(found[4])}]"

    def values(part: Part) -> Floats | None:
        give = plot.find(variable)
        v = kept(part, (variable, which), lambda: None if give is None else give(part, which))
        return None if v is None else v.reshape(len(v), -1)[:, k]

    return values


def means(part: Part, variable: str) -> Floats | None:
    """A plot variable's means over the elements of a part (m, ...), evaluated once a state."""
    give = plot.find(variable)
    return kept(part, ("means", variable), lambda: None if give is None else give(part))


def _component(variable: str, k: int, part: Part) -> Floats | None:
    v = means(part, variable)
    return None if v is None else v.reshape(len(v), -1)[:, k]


def _wy(variable: str, k: int, part: Part) -> Floats | None:
    """FEBio's one name for two: the fluid's flux along y, and the yielded bonds where no fluid is."""
    flux = _component(variable, k, part)
    return _bonds("yielded", part) if flux is None else flux


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


def _strain_energy(part: Part) -> Floats | None:
    """Mean strain energy density, of shells too."""
    from febkit.output.plot.energies import energy

    W = energy(part) if part.group is not None else None
    return None if W is None else W.mean(axis=1)


def _volume(part: Part) -> Floats | None:
    """Present volume."""
    return None if part.group is None else (part.g.wJ0 * part.g.J).sum(axis=1)


def _whole(k: int, part: Part) -> Floats | None:
    """F, times the prestrain where there is any."""

    def values() -> Floats:
        from febkit.output.plot.prestrain import gradient, prestrained

        found = prestrained(part)
        F = part.g.F if found is None else part.g.F @ part.shaped(gradient(*found))
        return np.asarray(F.mean(axis=1).reshape(-1, 9))

    return None if part.group is None else kept(part, "whole gradient", values)[:, k]


def _axis_stretch(part: Part) -> Floats | None:
    """|F e1|, e1 the first local axis."""
    from febkit.output.plot.fibers import axis_stretch

    v = axis_stretch(part) if part.group is not None else None
    return None if v is None else v.mean(axis=1)


def _fiber(k: int, part: Part) -> Floats | None:
    """Mean over the points of F a / |F a|."""
    from febkit.output.plot.fibers import direction

    v = direction(part) if part.group is not None else None
    return None if v is None else v[..., k].mean(axis=1)


def _bonds(which: str, part: Part) -> Floats | None:
    """A fraction of the bonds, summed over the solids of a mixture."""
    if part.group is None:
        return None
    from febkit.output.plot import bonds

    value, law, pts = getattr(bonds, which), part.g.block.solid, part.points()
    own = [value(q, law.inner(pts)) for q in (law.children if type(law).__name__ in bonds.MIXED else (law,))]
    found = [v for v in own if v is not None]
    return part.shaped(np.sum(found, axis=0)).mean(axis=1) if found else None


def _principal_direction(i: int, k: int, part: Part) -> Floats | None:
    """Principal directions of the mean stress, that of the largest first; their largest components are positive.

    FEBio's are in the order in which its iteration leaves them.
    """

    def values() -> Floats | None:
        s = means(part, "stress")
        if s is None:
            return None
        n = np.linalg.eigh(full(s))[1][:, :, ::-1]
        big = np.take_along_axis(n, np.abs(n).argmax(axis=1)[:, None], axis=1)
        return np.asarray(n * np.sign(big))

    n = kept(part, "principal directions", values)
    return None if n is None else n[:, k, i]


OTHERS: dict[str, Callable[[Part], Floats | None]] = {
    **{c: partial(_position, k) for k, c in enumerate("xyz")},
    **{f"Ft_{c}": partial(_whole, k) for c, k in NINE.items()},
    **{f"fiber_{c}": partial(_fiber, k) for k, c in enumerate("xyz")},
    **{f"s{i + 1}{c}": partial(_principal_direction, i, k) for i in range(3) for k, c in enumerate("xyz")},
    "V": _volume,
    "sed": _strain_energy,
    "fiber_stretch": _axis_stretch,
    "wi": partial(_bonds, "intact"),
}
