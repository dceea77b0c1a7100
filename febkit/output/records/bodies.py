"""<rigid_body_data>: rigid bodies by the number of their material; 0 for the other materials, as in FEBio."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from febkit.output.plot import rigid

from . import Column, Floats, Ints, places

if TYPE_CHECKING:
    from febkit.model import LogEntry
    from febkit.output.plot import View

TYPE = "rigid body"
# vectors of :class:`febkit.output.plot.rigid.Body` by the prefix of their items
VECTORS: dict[str, str] = {
    "": "position", "v": "velocity", "a": "acceleration", "th": "rotation", "om": "spin",
    "al": "angular_acceleration", "F": "force", "M": "moment",
}  # fmt: skip


def rows(view: View, entry: LogEntry) -> tuple[Ints, Ints]:
    materials = view.model.materials
    own = np.array([k for k, m in enumerate(materials, 1) if m.type == TYPE], np.int64)
    return places(entry, np.arange(1, len(materials) + 1), None if entry.items else own)


def column(view: View, name: str, entry: LogEntry) -> Column | None:
    value = datum(name)
    if value is None:
        return None

    def values() -> Floats:
        by_part = rigid.bodies(view)
        first: dict[str, Any] = {}
        for part in view.parts:
            if part.name in by_part:
                first.setdefault(part.material, by_part[part.name])
        for body in rigid.every(view):  # those of nodes alone have no part
            first.setdefault(body.record.name, body)
        every = [first.get(m.name or "") for m in view.model.materials]
        return np.array([0.0 if b is None else value(b) for b in every])

    return values


def datum(name: str) -> Callable[[rigid.Body], float] | None:
    """What gives a datum of a body."""
    if name and name[-1] in "xyz" and name[:-1] in VECTORS:
        vector, k = VECTORS[name[:-1]], "xyz".index(name[-1])
        return lambda b: float(getattr(b, vector)[k])
    if len(name) == 2 and name[0] == "q" and name[1] in "xyzw":
        return lambda b: float(b.quaternion["xyzw".index(name[1])])
    if len(name) == 3 and name[0] == "R" and set(name[1:]) <= set("123"):
        return lambda b: float(b.turn[int(name[1]) - 1, int(name[2]) - 1])
    if name[:5] == "Euler" and name[5:] in ("X", "Y", "Z"):
        return lambda b: float(rigid.euler(b)["XYZ".index(name[5:])])
    if name == "KE":
        return lambda b: float(b.kinetic_energy)
    return axis(name, {"IHA": instantaneous, "FHA": finite})


# ---- helical axes ---------------------------------------------------------------------------------------
Axis = tuple[Floats, Floats, float]  # rotation along the axis, a point on it, translation along it


def axis(name: str, kinds: dict[str, Callable[[Any], Axis]]) -> Callable[[Any], float] | None:
    """A datum of a helical axis by its name's ending: w[xyz] the rotation, wm its size in degrees, s[xyz] the point of
    the axis nearest to the origin, td the translation."""
    of, what = kinds.get(name[:-2]), name[-2:]
    if of is None:
        return None
    if what == "wm":
        return lambda b: float(np.degrees(np.linalg.norm(of(b)[0])))
    if what == "td":
        return lambda b: of(b)[2]
    if what[0] in "ws" and what[1] in "xyz":
        which, k = "ws".index(what[0]), "xyz".index(what[1])
        return lambda b: float(of(b)[:2][which][k])
    return None


def helical(w: Floats, v: Floats, r: Floats) -> Axis:
    """Of a rotation w and a translation v of what is at r."""
    size = float(w @ w)
    if size == 0.0:
        d = float(np.linalg.norm(v))
        return (v / d if d > 0 else w), np.zeros(3), d
    n = w / np.sqrt(size)
    along = float(v @ n)
    return w, np.cross(w, v - n * along + np.cross(r, w)) / size, along


def instantaneous(b: rigid.Body) -> Axis:
    """By the mean velocities of the last step."""
    return helical(
        0.5 * (b.spin + b.old_spin), 0.5 * (b.velocity + b.old_velocity), 0.5 * (b.position + b.old_position)
    )


def turned(b: rigid.Body) -> Floats:
    """Rotation vector of the last step."""
    from febkit.solver.rigid import rotation

    return rotation.vector(rotation.unit(rotation.product(b.quaternion, rotation.conjugate(b.old_quaternion))))


def finite(b: rigid.Body) -> Axis:
    """By the motion of the last step."""
    return helical(turned(b), b.position - b.old_position, 0.5 * (b.position + b.old_position))
