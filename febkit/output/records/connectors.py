"""<rigid_connector_data>: rigid connectors' forces and motion, and constraints' volumes, numbered in the file's order.

Forces and moments act on the first body; the second's motion is relative to the first, along the joint's axes where it
has any. Helical axes are seen from the second body.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from febkit.output.plot.rigid import Body
from febkit.solver.loads.enclosed_volume import EnclosedVolume
from febkit.solver.rigid import rotation
from febkit.solver.rigid.jets import Frame

from . import Column, Floats, Ints, places
from .bodies import Axis, axis, helical

if TYPE_CHECKING:
    from febkit.model import Component, LogEntry
    from febkit.output.plot import View
    from febkit.solver.state import State


def listed(view: View) -> list[Component]:
    """What FEBio numbers: connectors and constraints as they stand in the file."""
    steps = [view.model.common, *view.model.steps]
    found = [c for s in steps for c in (*s.rigid, *s.constraints) if c.tag in ("rigid_connector", "constraint")]
    return sorted(found, key=lambda c: c.where.line or 0)


def rows(view: View, entry: LogEntry) -> tuple[Ints, Ints]:
    ids = np.arange(1, len(listed(view)) + 1)
    return places(entry, ids, None)


def column(view: View, name: str, entry: LogEntry) -> Column | None:
    if name in VOLUMES:
        return partial(_volumes, view, VOLUMES[name])
    value = datum(name)
    if value is None:
        return None

    def values() -> Floats:
        problem = view.run.problem
        records = iter([c for s in (problem.common, *problem.steps) for c in s.connectors if c.numbered])
        every = [next(records) if c.tag == "rigid_connector" else None for c in listed(view)]
        return np.array([0.0 if c is None else value(Joint(view, c)) for c in every])

    return values


def _volumes(view: View, value: Callable[[EnclosedVolume, State], float]) -> Floats:
    """A datum of each constraint "volume", zero for all else."""
    problem = view.run.problem
    loads = iter([q for s in (problem.common, *problem.steps) for q in s.loads if isinstance(q, EnclosedVolume)])
    every = [next(loads) if (c.tag, c.type) == ("constraint", "volume") else None for c in listed(view)]
    return np.array([0.0 if q is None else value(q, view.state) for q in every])


class Joint:
    """A connector in a state."""

    def __init__(self, view: View, record: Any) -> None:
        self.view, self.record = view, record
        self.a, self.b = Body(view, record.a), Body(view, record.b)

    def pull(self) -> tuple[Floats, Floats]:
        """Force and moment on the first body; zero where the connector does not act."""
        system = self.view.run.system
        all_of_them = self.view.run.bodies.connectors if self.view.run.bodies is not None else None
        if system is None or all_of_them is None or self.record not in getattr(all_of_them, "active", ()):
            return np.zeros(3), np.zeros(3)
        frames = Frame(system, self.record.a, 0), Frame(system, self.record.b, 6)
        F, M = self.record.pull(*frames, self.view.state.time, all_of_them._memory(self.record))
        return np.asarray(F.v), np.asarray(M.v)

    def axes(self) -> Floats:
        """Axes of the joint (rows), which turn with the first body; the global ones of what has none."""
        own = getattr(self.record, "axes", None)
        return np.eye(3) if own is None else np.asarray(own) @ self.a.turn.T

    def translation(self) -> Floats:
        """From the first body's point to the second's; the distance alone of springs."""
        if type(self.record).__name__ == "AngularDamper":
            return np.zeros(3)
        pa, pb = self.record.points()
        arms = [b.turn @ (p - b.record.centre) for b, p in ((self.a, pa), (self.b, pb))]
        d = self.b.position + arms[1] - self.a.position - arms[0]
        if type(self.record).__name__ == "Spring":
            return np.array([np.linalg.norm(d), 0.0, 0.0])
        return np.asarray(self.axes() @ d)

    def rotation(self) -> Floats:
        """Rotation vector of the second body relative to the first."""
        q = rotation.product(self.b.quaternion, rotation.conjugate(self.a.quaternion))
        return self.axes() @ rotation.vector(rotation.unit(q))

    def _seen(self, w: Floats, v: Floats) -> Axis:
        """A helical axis of the relative motion as the second body sees it."""
        r = 0.5 * (self.b.position + self.b.old_position - self.a.position - self.a.old_position)
        n, s, along = helical(w, v, r)
        return self.b.turn.T @ n, s - self.b.position, along

    def instantaneous(self) -> Axis:
        a, b = self.a, self.b
        return self._seen(
            0.5 * (b.spin + b.old_spin - a.spin - a.old_spin),
            0.5 * (b.velocity + b.old_velocity - a.velocity - a.old_velocity),
        )

    def finite(self) -> Axis:
        """By the motion of the last step (FEBio 4.11 subtracts quaternions, which is no rotation)."""
        turns = [rotation.product(q.quaternion, rotation.conjugate(q.old_quaternion)) for q in (self.a, self.b)]
        w = rotation.vector(rotation.unit(rotation.product(turns[1], rotation.conjugate(turns[0]))))
        a, b = self.a, self.b
        return self._seen(w, b.position - b.old_position - a.position + a.old_position)


def datum(name: str) -> Callable[[Joint], float] | None:
    """What gives a datum of a connector."""
    k = "xyz".find(name[-1:])
    if k >= 0 and name[:-1] in VECTORS:
        vector = VECTORS[name[:-1]]
        return lambda j: float(vector(j)[k])
    return axis(name, {"rcIHA": Joint.instantaneous, "rcFHA": Joint.finite})


VECTORS: dict[str, Callable[[Joint], Floats]] = {
    "RCF": lambda j: j.pull()[0],
    "RCM": lambda j: j.pull()[1],
    "RC": Joint.translation,
    "RCth": Joint.rotation,
}
VOLUMES: dict[str, Callable[[EnclosedVolume, State], float]] = {
    "constrained volume": EnclosedVolume.volume,
    "volume pressure": EnclosedVolume.pressure,
}
