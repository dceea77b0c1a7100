"""What joins two rigid bodies: a force F at a point of each and a moment M, on body a; opposite ones on body b.

FEBio user manual, "Rigid connectors"; Hou et al. and Ateshian's joints by penalty and augmented Lagrangian.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ..action import Action
from ..record import variable_record
from ..values import Value, as_value
from . import jets
from .jets import Frame, Jet

if TYPE_CHECKING:
    from ..state import State
    from ..system import System

Floats = NDArray[np.float64]
Number = Value | float
ORIGIN = np.zeros((1, 3))


def number(v: Number, t: float) -> float:
    """A parameter at time t."""
    return float(as_value(v)(t, ORIGIN)[0])


@dataclass(slots=True, eq=False)
class Memory:
    """What a connector keeps: multipliers of force and moment, and penalties that may have grown."""

    force: Floats
    moment: Floats
    penalties: Floats


@variable_record
class Connector:
    """``a``, ``b``: indices of the bodies. The point of action is ``at_a``, ``at_b`` of the reference."""

    a: int
    b: int
    symmetric: ClassVar[bool] = False
    numbered: ClassVar[bool] = True  # among the connectors of a file; a load between bodies is not

    def points(self) -> tuple[Floats, Floats]:
        """Points of action on a and b (the reference)."""
        raise NotImplementedError

    def pull(self, a: Frame, b: Frame, t: float, m: Memory) -> tuple[Jet, Jet]:
        """Force and moment on a."""
        raise NotImplementedError

    def wrench(self, a: Frame, b: Frame, t: float, m: Memory) -> tuple[Jet, Jet, Jet]:
        """Force on a, and the moments of it on a and, reversed, on b, about their centres."""
        F, M = self.pull(a, b, t, m)
        pa, pb = self.points()
        return F, jets.cross(a.arm(pa), F) + M, jets.cross(b.arm(pb), F) + M

    def penalties(self) -> tuple[float, float]:
        return 0.0, 0.0

    def augment(self, system: System, done: int, m: Memory) -> bool:
        """Renew the multipliers; True where they need no more of it."""
        return True


@variable_record
class Between(Connector):
    """A connector between insertion points."""

    insertion_a: Floats = field(default_factory=lambda: np.zeros(3))
    insertion_b: Floats = field(default_factory=lambda: np.zeros(3))

    def points(self) -> tuple[Floats, Floats]:
        return self.insertion_a, self.insertion_b

    def distance(self, a: Frame, b: Frame) -> Jet:
        """From the point on a to that on b."""
        return b.centre() + b.arm(self.insertion_b) - a.centre() - a.arm(self.insertion_a)


@variable_record
class Spring(Between):
    """F = k (1 - L0 / L) c along the distance c; L0 = 0 stands for the distance at the start."""

    k: Number = 1.0
    free_length: float = 0.0

    def pull(self, a: Frame, b: Frame, t: float, m: Memory) -> tuple[Jet, Jet]:
        c = self.distance(a, b)
        rest = self.free_length or float(np.linalg.norm(self.insertion_b - self.insertion_a))
        return (c - jets.direction(c).times(rest)).times(number(self.k, t)), jets.zero()


@variable_record
class Damper(Between):
    """F = c (v_b - v_a)."""

    c: Number = 1.0

    def pull(self, a: Frame, b: Frame, t: float, m: Memory) -> tuple[Jet, Jet]:
        v = b.velocity(self.insertion_b) - a.velocity(self.insertion_a)
        return v.times(number(self.c, t)), jets.zero()


@variable_record
class ContractileForce(Between):
    """A force f0 along the distance."""

    f0: Number = 0.0

    def pull(self, a: Frame, b: Frame, t: float, m: Memory) -> tuple[Jet, Jet]:
        return jets.direction(self.distance(a, b)).times(number(self.f0, t)), jets.zero()


@variable_record
class AxialForce(ContractileForce):
    """FEBio's "rigid_axial_force"."""

    numbered = False


@variable_record
class Cable(AxialForce):
    """A piece of a "rigid_cable"; the arms of its moments are those of the reference, as FEBio has them."""

    def wrench(self, a: Frame, b: Frame, t: float, m: Memory) -> tuple[Jet, Jet, Jet]:
        F, _ = self.pull(a, b, t, m)
        arms = self.insertion_a - a.body.centre, self.insertion_b - b.body.centre
        return F, jets.cross(jets.constant(arms[0]), F), jets.cross(jets.constant(arms[1]), F)


@variable_record
class AngularDamper(Between):
    """M = c (w_b - w_a)."""

    c: Number = 1.0

    def pull(self, a: Frame, b: Frame, t: float, m: Memory) -> tuple[Jet, Jet]:
        return jets.zero(), (b.spin() - a.spin()).times(number(self.c, t))


class Connectors(Action):
    """The connectors of a run at work, on the bodies' rows."""

    def __init__(self, records: list[Connector], state: State) -> None:
        self.records = {id(c): k for k, c in enumerate(records)}
        # multipliers of force and moment; a step that fails gives them back
        state.extra["multipliers"] = np.zeros((len(records), 6))
        self.penalties = np.array([c.penalties() for c in records]).reshape(-1, 2)
        self._at, self._known = b"", list[Jet]()  # a state, and the forces found there

    @property
    def symmetric(self) -> bool:
        return False

    @property
    def augments(self) -> bool:
        return True

    def take(self, active: list[Connector], system: System) -> None:
        """The connectors of one analysis step, and its system."""
        self.active, self.system, self._at = active, system, b""
        self.rows = np.array([self._rows(c) for c in active]).reshape(-1, 4)

    def _memory(self, c: Connector) -> Memory:
        k = self.records[id(c)]
        L = self.system.state.extra["multipliers"][k]
        return Memory(L[:3], L[3:], self.penalties[k])

    def _forces(self) -> list[Jet]:
        """Forces and moments (12,) on both bodies of each that is active; residual and tangent of an iteration ask for
        them at one state."""
        at = self._state()
        if at != self._at:
            self._at, self._known = at, [self._force(c) for c in self.active]
        return self._known

    def _force(self, c: Connector) -> Jet:
        a, b = Frame(self.system, c.a, 0), Frame(self.system, c.b, 6)
        F, Ma, Mb = (q.rows for q in c.wrench(a, b, self.system.state.time, self._memory(c)))
        return Jet(np.concatenate([F, Ma, -F, -Mb]))

    def _state(self) -> bytes:
        """All that forces depend on."""
        s, bodies, e = self.system.state, self.system.bodies, self.system.state.extra
        assert bodies is not None
        first = int(bodies.rows[0])
        nodal = (a[first:].tobytes() for a in (s.d, s.d_old, s.velocity, s.velocity_old))
        kept = (a.tobytes() for a in (e["q"], e["q_old"], e["multipliers"], self.penalties))
        return b"".join([*nodal, *kept, struct.pack("dd", s.time, s.dt)])

    def _rows(self, c: Connector) -> NDArray[np.int64]:
        assert self.system.bodies is not None
        ra, rb = (int(self.system.bodies.rows[i]) for i in (c.a, c.b))
        return np.array([ra, ra + 1, rb, rb + 1])

    def cliques(self) -> list[NDArray[np.int64]]:
        return [self.rows] if self.active else []

    def residual(self, state: State, R: Floats) -> None:
        if self.active:
            forces = np.array([q.v for q in self._forces()])
            np.add.at(state.layout.u(R), self.rows.reshape(-1), forces.reshape(-1, 3))

    def stiffness(self, state: State, groups: Any = None) -> list[tuple[Floats, Any, Any]]:
        if not self.active:
            return []
        K = -np.array([q.d for q in self._forces()])
        return [(K, self.rows.repeat(3, axis=1), np.tile(state.layout.displacement, 4))]

    def augment(self, done: int, state: State) -> bool:
        return all([c.augment(self.system, done, self._memory(c)) for c in self.active])  # noqa: C419 (all of them)

    def snapshot(self) -> Floats:
        """Penalties. FEBio keeps what ``auto_penalty`` made of them in a try that failed, so that its answer depends on
        how often steps were cut; here a failed try leaves nothing behind."""
        return self.penalties.copy()

    def restore(self, saved: Floats) -> None:
        self.penalties[...] = saved
