"""What adaptors choose elements by: measures at the integration points, and criteria over them. FEBio User Manual,
"Mesh adaptor", criteria.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from .group import Group
    from .state import State
    from .system import System
    from .values import Value

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
SAME = 1e-12  # a range below which a measure counts as the same everywhere
Measure = Callable[["Group", "State"], "Floats | None"]  # values at the points (m, g); None: a group has none


def von_mises(group: Group, state: State) -> Floats | None:
    """sqrt(3/2 dev s : dev s)."""
    s = _stress(group)
    if s is None:
        return None
    d = s[..., :3] - s[..., [1, 2, 0]]
    return np.asarray(np.sqrt(0.5 * (d * d).sum(axis=-1) + 3.0 * (s[..., 3:] ** 2).sum(axis=-1)))


def largest_deviatoric(group: Group, state: State) -> Floats | None:
    """The largest principal value of dev s."""
    s = _stress(group)
    if s is None:
        return None
    principal = _principal(s)
    return np.asarray(principal[..., 2] - principal.mean(axis=-1))


def _principal(s: Floats) -> Floats:
    """Principal values (m, g, 3), ascending, of tensors (m, g, 6)."""
    return np.asarray(np.linalg.eigvalsh(s[..., [0, 3, 5, 3, 1, 4, 5, 4, 2]].reshape(*s.shape[:2], 3, 3)))


def _stress(group: Group) -> Floats | None:
    give = group.physics.outputs.get("stress")
    return None if give is None or not group.deforms else give(group.physics)


def stress_component(k: int) -> Measure:
    """Component k of the stress: xx yy zz xy yz xz."""

    def measure(group: Group, state: State) -> Floats | None:
        s = _stress(group)
        return None if s is None else s[..., k]

    return measure


def principal_stress(k: int) -> Measure:
    """Principal stress k, the largest first."""

    def measure(group: Group, state: State) -> Floats | None:
        s = _stress(group)
        return None if s is None else _principal(s)[..., 2 - k]

    return measure


def relative_volume(group: Group, state: State) -> Floats | None:
    """J."""
    return group.J if group.deforms else None


def damage(group: Group, state: State) -> Floats | None:
    """Damage of the first solid of a law that loses its bonds, where there is one."""
    from .solids.elastic_damage import ElasticDamage, UncoupledElasticDamage

    laws = [q for q in group.block.solid.walk() if isinstance(q, (ElasticDamage, UncoupledElasticDamage))]
    if not laws:
        return None
    return np.broadcast_to(laws[0].broken(group.points()), (group.m * group.g,)).reshape(group.m, group.g)


def variable(column: int) -> Measure:
    """An unknown, interpolated."""
    return lambda group, state: np.einsum("ga,ea->eg", group.N, state.d[group.conn, column])


def given(value: Value) -> Measure:
    """A number in space and time."""

    def measure(group: Group, state: State) -> Floats:
        pts = group.points()
        v = value(state.time, pts.X, pts.e)
        return np.broadcast_to(v, (group.m * group.g,)).reshape(group.m, group.g)

    return measure


def clipped(measure: Measure, least: float, most: float) -> Measure:
    """A measure cut to [least, most]."""

    def cut(group: Group, state: State) -> Floats | None:
        v = measure(group, state)
        return None if v is None else np.clip(v, least, most)

    return cut


MEASURES: dict[str, Measure] = {
    "von Mises stress": von_mises, "largest deviatoric stress": largest_deviatoric,
    "relative volume": relative_volume, "damage": damage,
}  # fmt: skip

# by names of log items, whose values are means over the points of elements
ITEMS: dict[str, Measure] = {
    **{name: stress_component(k) for k, name in enumerate(("sx", "sy", "sz", "sxy", "syz", "sxz"))},
    **{f"s{k + 1}": principal_stress(k) for k in range(3)}, "J": relative_volume,
}  # fmt: skip


@dataclass(eq=False)
class Range:
    """Elements whose mean of a measure lies in [least, most]; ``clamp``: all, their values cut to it."""

    measure: Measure
    least: float = -1e37
    most: float = 1e37
    clamp: bool = True

    def __call__(self, group: Group, system: System) -> tuple[NDArray[np.bool_], Floats]:
        """Which elements (m,) are selected, and their values."""
        points = self.measure(group, system.state)
        if points is None:
            return np.zeros(group.m, bool), np.zeros(group.m)
        v = np.asarray(sum(points.T)) / group.g  # one after another, as FEBio adds: a damage of 1 may be a limit
        if self.clamp:
            return np.ones(group.m, bool), np.clip(v, self.least, self.most)
        return (self.least <= v) & (v <= self.most), v


@dataclass(eq=False)
class RelativeError:
    """By how much a measure at the points of elements misses the one recovered at their nodes, over its range.

    max_g |v_g - sum_a N_a(g) v_a| / (max v - min v), v_a the mean of what is extrapolated to node a in its elements
    (FEBio User Manual, "relative error"). Given an ``error``, the value is error / that, 1 at most. ``elements``: the
    range is that over these, by block; None: over all.
    """

    measure: Measure
    error: float = 0.0
    elements: dict[str, Ints] | None = None

    def __call__(self, group: Group, system: System) -> tuple[NDArray[np.bool_], Floats]:
        """All elements, and their values; none where the measure is the same everywhere."""
        points = {id(g): self._points(g, system) for g in system.groups}
        least, most = self._range(system, points)
        if abs(most - least) < SAME:
            return np.zeros(group.m, bool), np.zeros(group.m)
        nodal = recovered(system, points)
        v = points[id(group)]
        smooth = np.einsum("ga,ea->eg", group.N, nodal[group.conn])
        worst = (np.abs(v - smooth) / (most - least)).max(axis=1)
        if self.error > 0:
            worst = np.where(worst > self.error, self.error / np.maximum(worst, self.error), 1.0)
        return np.ones(group.m, bool), np.where(worst > 0, worst, 1.0)

    def _points(self, group: Group, system: System) -> Floats:
        v = self.measure(group, system.state)
        return np.zeros((group.m, group.g)) if v is None else np.asarray(v)

    def _range(self, system: System, points: dict[int, Floats]) -> tuple[float, float]:
        """The least and the largest value."""
        own = self.elements
        rows = (points[id(g)] if own is None else points[id(g)][own.get(g.block.name, [])] for g in system.groups)
        every = np.concatenate([r.reshape(-1) for r in rows])
        return float(every.min(initial=np.inf)), float(every.max(initial=-np.inf))


def recovered(system: System, points: dict[int, Floats]) -> Floats:
    """Values at the nodes (node,): means over the elements of what is extrapolated from their points (m, g)."""
    total, count = np.zeros(len(system.state.X)), np.zeros(len(system.state.X))
    for g in system.groups:
        np.add.at(total, g.conn, np.einsum("ag,eg->ea", g.element.extrapolation, points[id(g)]))
        np.add.at(count, g.conn, 1.0)
    return total / np.maximum(count, 1.0)


@dataclass(eq=False)
class Listed:
    """Elements by their ids, with a value."""

    ids: Ints
    value: float = 1.0

    def __call__(self, group: Group, system: System) -> tuple[NDArray[np.bool_], Floats]:
        return np.isin(group.block.ids, self.ids), np.full(group.m, self.value)


@dataclass(eq=False)
class Overlap:
    """Elements behind facets of primary surfaces in contact where some point overlaps by more than ``gap``."""

    gap: float

    def __call__(self, group: Group, system: System) -> tuple[NDArray[np.bool_], Floats]:
        chosen, value = np.zeros(group.m, bool), np.zeros(group.m)
        for contact in system.contacts:
            side = contact.sides[0]
            gaps = contact.values(side, "gap", system.state)
            if gaps is None:
                continue
            most = np.full(len(side.conn), -np.inf)
            np.maximum.at(most, side.facet, gaps)
            for f in np.flatnonzero(most > self.gap):
                own = behind(group, side.conn[f, : side.count[f]])
                chosen |= own
                value[own] = most[f]
        return chosen, value


Criterion = Callable[["Group", "System"], "tuple[NDArray[np.bool_], Floats]"]


def selected(
    criterion: Criterion, elements: dict[str, Ints] | None, system: System
) -> tuple[NDArray[np.bool_], Floats]:
    """Which elements of all groups, one after another, are selected, and their values; ``elements``: among these."""
    found = []
    for group in system.groups:
        chosen, value = criterion(group, system)
        chosen = chosen & group.alive
        if elements is not None:
            own = np.zeros(group.m, bool)
            own[elements.get(group.block.name, np.zeros(0, np.int64))] = True
            chosen &= own
        found.append((chosen, value))
    chosen, value = (np.concatenate(a) for a in zip(*found))
    return chosen, value


def behind(group: Group, facet: Ints) -> NDArray[np.bool_]:
    """Elements (m,) that have all nodes of a facet."""
    return np.asarray((group.conn[:, :, None] == facet).any(axis=1).all(axis=1))
