"""Joints of two rigid bodies, held by penalty and augmented Lagrangian.

F = L + eps c, M = U + ups xi on body a, with c the gap at the joint's origin and xi the misalignment; after a solve
L and U take these values until gap and angle are within tolerance. FEBio user manual, "Rigid connectors".
"""

from __future__ import annotations

from dataclasses import field
from math import cos, pi, sin
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ..record import variable_record
from . import jets, rotation
from .connectors import Connector, Floats, Memory, Number, number
from .jets import Frame, Jet

if TYPE_CHECKING:
    from ..system import System


def axes(first: Floats, second: Floats) -> Floats:
    """Orthonormal axes (rows): the first, the second made normal to it, their product."""
    e = first / np.linalg.norm(first)
    g = np.cross(e, second)
    g = g / np.linalg.norm(g)
    return np.stack([e, np.cross(g, e), g])


def _change(old: Floats, new: Floats) -> float:
    """Relative change of a multiplier's norm."""
    n0, n1 = float(np.linalg.norm(old)), float(np.linalg.norm(new))
    return abs((n1 - n0) / n1) if n1 > 1e-10 else 0.0


@variable_record
class RigidJoint(Connector):
    """A ball joint: FEBio's "rigid joint", whose multipliers end by their change alone."""

    joint: Floats = field(default_factory=lambda: np.zeros(3))
    penalty: float = 0.0
    tolerance: float = 0.01
    laugon: int = 1

    def points(self) -> tuple[Floats, Floats]:
        return self.joint, self.joint

    def penalties(self) -> tuple[float, float]:
        return self.penalty, 0.0

    def _gap(self, a: Frame, b: Frame) -> Jet:
        return b.centre() + b.arm(self.joint) - a.centre() - a.arm(self.joint)

    def pull(self, a: Frame, b: Frame, t: float, m: Memory) -> tuple[Jet, Jet]:
        return jets.constant(m.force) + self._gap(a, b).times(m.penalties[0]), jets.zero()

    def augment(self, system: System, done: int, m: Memory) -> bool:
        if self.laugon == 0:
            return True
        a, b = Frame(system, self.a, 0), Frame(system, self.b, 6)
        a.alpha = b.alpha = 1.0
        new = m.force + m.penalties[0] * self._gap(a, b).v
        if _change(m.force, new) < self.tolerance:
            return True
        m.force[:] = new
        return False


@variable_record
class GenericJoint(Connector):
    """Up to six conditions: v . g + d_i = 0 of the gap g = a - b along a's axes v, and va . vb = cos(pi/2 + d_i).

    ``given``: d_i, None where it is free: displacements along x, y, z of the reference, rotations about them (va and
    vb the axes that follow, of a and of b). FEBio's "generic rigid joint", by penalty and augmented Lagrangian.
    """

    joint: Floats = field(default_factory=lambda: np.zeros(3))
    given: tuple[Number | None, ...] = (None,) * 6
    penalty: float = 1.0
    tolerance: float = 0.0
    laugon: int = 0

    def points(self) -> tuple[Floats, Floats]:
        return self.joint, self.joint

    def penalties(self) -> tuple[float, float]:
        return self.penalty, self.penalty

    def _conditions(self, a: Frame, b: Frame, t: float) -> tuple[Jet, list[tuple[int, Jet, Jet, Jet]]]:
        """The gap, and of each condition its number, the two vectors multiplied, and its value."""
        a.alpha = b.alpha = 1.0
        g = a.centre() + a.arm(self.joint) - b.centre() - b.arm(self.joint)
        one, out = np.eye(3), []
        for i, d in enumerate(self.given):
            if d is None:
                continue
            v, w = a.vector(one[i if i < 3 else (i + 1) % 3]), g if i < 3 else b.vector(one[(i + 2) % 3])
            rest = number(d, t) if i < 3 else -cos(0.5 * pi + number(d, t))
            c = jets.dot(v, w)
            out.append((i, v, w, c.more(rest)))
        return g, out

    def wrench(self, a: Frame, b: Frame, t: float, m: Memory) -> tuple[Jet, Jet, Jet]:
        F, Ma, Mb = jets.zero(), jets.zero(), jets.zero()
        g, conditions = self._conditions(a, b, t)
        multipliers = np.append(m.force, m.moment)
        for i, v, w, c in conditions:
            L = c.times(m.penalties[0]).more(multipliers[i])
            if i < 3:
                f = -v.scaled(L)
                F, Ma = F + f, Ma + jets.cross(a.arm(self.joint) - g, f)
                Mb = Mb + jets.cross(b.arm(self.joint), f)
            else:
                M = -jets.cross(v, w).scaled(L)
                Ma, Mb = Ma + M, Mb + M
        return F, Ma, Mb

    def augment(self, system: System, done: int, m: Memory) -> bool:
        """Renew the multipliers, as FEBio does each time; have they settled, where there is a ``tolerance``?"""
        if self.laugon == 0:
            return True
        settled = True
        a, b = Frame(system, self.a, 0), Frame(system, self.b, 6)
        for i, _, _, c in self._conditions(a, b, system.state.time)[1]:
            own, k = (m.force, i) if i < 3 else (m.moment, i - 3)
            new = own[k] + m.penalties[0] * float(c.v[0])
            if self.tolerance and abs(abs(new) - abs(own[k])) > self.tolerance * abs(new):
                settled = False
            own[k] = new
        return settled


@variable_record
class Joint(Connector):
    """The common part. ``axes`` (3, 3) rows of the reference; tolerances of 0 are not tested."""

    origin: Floats = field(default_factory=lambda: np.zeros(3))
    axes: Floats = field(default_factory=lambda: np.eye(3))
    tolerance: float = 0.0
    gaptol: float = 0.0
    angtol: float = 0.0
    force_penalty: float = 1.0
    moment_penalty: float = 1.0
    force_damping: float = 0.0
    moment_damping: float = 0.0
    minaug: int = 0
    maxaug: int = 10
    auto_penalty: bool = False
    laugon: int = 1
    AXES: ClassVar[tuple[str, str]] = ("", "")  # FEBio's tags of the first two axes

    def points(self) -> tuple[Floats, Floats]:
        return self.origin, self.origin

    def penalties(self) -> tuple[float, float]:
        return self.force_penalty, self.moment_penalty

    # ---- what each joint says ---------------------------------------------------------------------
    def gap(self, a: Frame, d: Jet, t: float) -> Jet:
        """The part of the distance d of the two origins that must vanish."""
        return d

    def misalignment(self, a: Frame, b: Frame, t: float) -> Jet:
        """A rotation vector, to first order, that must vanish."""
        raise NotImplementedError

    def force(self, a: Frame, t: float) -> Jet:
        """Force applied by the joint."""
        return jets.zero()

    def moment(self, a: Frame, t: float) -> Jet:
        return jets.zero()

    def damped(self, a: Frame, v: Jet) -> Jet:
        """The part of a relative velocity that is damped."""
        return v

    def damped_spin(self, a: Frame, w: Jet) -> Jet:
        return w

    # ---- helpers ----------------------------------------------------------------------------------
    def _distance(self, a: Frame, b: Frame) -> Jet:
        return b.centre() + b.arm(self.origin) - a.centre() - a.arm(self.origin)

    def _crossed(self, a: Frame, b: Frame, some: tuple[int, ...]) -> Jet:
        """Half the sum of e_a x e_b."""
        out = jets.zero()
        for k in some:
            out = out + jets.cross(a.vector(self.axes[k]), b.vector(self.axes[k]))
        return out.times(0.5)

    def _turned(self, a: Frame, b: Frame, angle: float) -> Jet:
        """From b's rotation relative to a to that by ``angle`` about the first axis."""
        n = jets.direction(a.vector(self.axes[0]))
        target = Jet(np.vstack([sin(0.5 * angle) * n.rows, np.zeros(1 + jets.UNKNOWNS)]))
        target.rows[3, 0] = cos(0.5 * angle)
        return jets.rotation_vector(jets.product(target, jets.product(a.turn(), jets.conjugate(b.turn()))))

    # ---- at work ----------------------------------------------------------------------------------
    def pull(self, a: Frame, b: Frame, t: float, m: Memory) -> tuple[Jet, Jet]:
        c, xi = self.gap(a, self._distance(a, b), t), self.misalignment(a, b, t)
        F = jets.constant(m.force) + c.times(m.penalties[0]) + self.force(a, t)
        M = jets.constant(m.moment) + xi.times(m.penalties[1]) + self.moment(a, t)
        if self.force_damping > 0:
            F = F + self.damped(a, b.velocity(self.origin) - a.velocity(self.origin)).times(self.force_damping)
        if self.moment_damping > 0:
            M = M + self.damped_spin(a, b.spin() - a.spin()).times(self.moment_damping)
        return F, M

    def _angle(self, xi: Floats) -> float:
        return float(np.linalg.norm(xi))

    def augment(self, system: System, done: int, m: Memory) -> bool:
        if self.laugon == 0:
            return True
        a, b, t = Frame(system, self.a, 0), Frame(system, self.b, 6), system.state.time
        c = self.gap(a, self._distance(a, b), t).v
        xi = self.misalignment(a, b, t).v
        force, moment = m.force + m.penalties[0] * c, m.moment + m.penalties[1] * xi
        gap, angle = float(np.linalg.norm(c)), self._angle(xi)
        change = max(_change(m.force, force), _change(m.moment, moment))
        good = not (self.tolerance and change >= self.tolerance)
        good = good and not (self.gaptol and gap >= self.gaptol) and not (self.angtol and angle >= self.angtol)
        good = done >= self.maxaug or (good and done >= self.minaug)
        if not good:
            m.force[:], m.moment[:] = force, moment
        if self.auto_penalty:
            for k, (value, most) in enumerate(((gap, self.gaptol), (angle, self.angtol))):
                if most and value > most:
                    m.penalties[k] *= max(value / most, 100.0)
        return good


@variable_record
class Revolute(Joint):
    """Turns about the first axis: freely, under a moment, or as prescribed."""

    prescribed_rotation: bool = False
    rotation: Number = 0.0
    applied_moment: Number = 0.0
    AXES: ClassVar[tuple[str, str]] = ("rotation_axis", "transverse_axis")

    def misalignment(self, a: Frame, b: Frame, t: float) -> Jet:
        if self.prescribed_rotation:
            return self._turned(a, b, number(self.rotation, t))
        return self._crossed(a, b, (0,))

    def moment(self, a: Frame, t: float) -> Jet:
        return a.vector(self.axes[0]).times(number(self.applied_moment, t))

    def damped_spin(self, a: Frame, w: Jet) -> Jet:
        return w if self.prescribed_rotation else w - jets.along(a.vector(self.axes[0]), w)


@variable_record
class Prismatic(Joint):
    """Slides along the first axis: freely, under a force, or as prescribed."""

    prescribed_translation: bool = False
    translation: Number = 0.0
    applied_force: Number = 0.0
    AXES: ClassVar[tuple[str, str]] = ("translation_axis", "transverse_axis")

    def gap(self, a: Frame, d: Jet, t: float) -> Jet:
        e = a.vector(self.axes[0])
        if self.prescribed_translation:
            return d - e.times(number(self.translation, t))
        return d - jets.along(e, d)

    def misalignment(self, a: Frame, b: Frame, t: float) -> Jet:
        return self._crossed(a, b, (0, 1, 2))

    def force(self, a: Frame, t: float) -> Jet:
        return a.vector(self.axes[0]).times(number(self.applied_force, t))

    def damped(self, a: Frame, v: Jet) -> Jet:
        return v if self.prescribed_translation else v - jets.along(a.vector(self.axes[0]), v)


@variable_record
class Cylindrical(Prismatic):
    """Slides along and turns about the first axis."""

    prescribed_rotation: bool = False
    rotation: Number = 0.0
    applied_moment: Number = 0.0
    AXES: ClassVar[tuple[str, str]] = ("joint_axis", "transverse_axis")

    misalignment = Revolute.misalignment  # type: ignore[assignment]
    moment = Revolute.moment  # type: ignore[assignment]


@variable_record
class Planar(Joint):
    """Slides in the plane normal to the first axis, and turns about it."""

    prescribed_rotation: bool = False
    rotation: Number = 0.0
    prescribed_translation_1: bool = False
    translation_1: Number = 0.0
    prescribed_translation_2: bool = False
    translation_2: Number = 0.0
    AXES: ClassVar[tuple[str, str]] = ("rotation_axis", "translation_axis_1")

    misalignment = Revolute.misalignment  # type: ignore[assignment]

    def gap(self, a: Frame, d: Jet, t: float) -> Jet:
        e = [a.vector(q) for q in self.axes]
        one, two = self.prescribed_translation_1, self.prescribed_translation_2
        if not (one or two):
            return jets.along(e[0], d)
        if not one:
            d = d - jets.along(e[1], d)
        if not two:
            d = d - jets.along(e[2], d)
        if one:
            d = d - e[1].times(number(self.translation_1, t))
        if two:
            d = d - e[2].times(number(self.translation_2, t))
        return d


@variable_record
class Lock(Joint):
    """No relative motion."""

    AXES: ClassVar[tuple[str, str]] = ("first_axis", "second_axis")

    def misalignment(self, a: Frame, b: Frame, t: float) -> Jet:
        return self._crossed(a, b, (0, 1, 2))


@variable_record
class Spherical(Joint):
    """Turns freely, under a moment, or by a prescribed rotation vector."""

    prescribed_rotation: bool = False
    rotations: tuple[Number, Number, Number] = (0.0, 0.0, 0.0)
    moments: tuple[Number, Number, Number] = (0.0, 0.0, 0.0)

    def misalignment(self, a: Frame, b: Frame, t: float) -> Jet:
        if not self.prescribed_rotation:
            return jets.zero()
        target = jets.constant(rotation.of_vector(np.array([number(v, t) for v in self.rotations])))
        return jets.rotation_vector(jets.product(target, jets.product(a.turn(), jets.conjugate(b.turn()))))

    def moment(self, a: Frame, t: float) -> Jet:
        if self.prescribed_rotation:
            return jets.zero()
        return jets.constant(np.array([number(v, t) for v in self.moments]))

    def _angle(self, xi: Floats) -> float:
        """FEBio does not look at the angle of this joint."""
        return 0.0
