"""Forces and flows at nodes."""

from __future__ import annotations

from dataclasses import field
from typing import TYPE_CHECKING, Any

import numpy as np

from ..action import Action
from ..fields import PRESSURE
from ..record import variable_record
from ..values import as_value
from . import register
from .base import Floats, Ints, Number, Vector, as_vector, vector

if TYPE_CHECKING:
    from ..fields import Layout
    from ..group import Group
    from ..state import State


@variable_record
class NodalLoad(Action):
    """A load at nodes; ``X`` (n, 3) their reference positions. A value's map has one number per node.

    ``relative`` adds the load to the force that acted on the nodes as the load began.
    """

    nodes: Ints
    X: Floats
    relative: bool = field(default=False, kw_only=True)
    _start: Floats | None = field(default=None, init=False, repr=False)
    _distinct: bool | None = field(default=None, init=False, repr=False)  # no node is listed twice

    def columns(self, layout: Layout) -> Ints:
        """Columns of the nodal arrays the load is in."""
        return layout.displacement

    def begin(self, state: State, groups: list[Group]) -> None:
        self._start = None

    def begin_step(self, state: State) -> None:
        """As the load begins, take the forces that hold the nodes: the internal force."""
        if self._start is None:
            held = np.zeros((len(self.nodes), state.layout.width))
            held[:, state.layout.displacement] = state.reaction[self.nodes]
            self._start = held[:, self.columns(state.layout)]

    def snapshot(self) -> Any:
        return self._start

    def restore(self, saved: Any) -> None:
        self._start = saved

    def values(self, state: State) -> Floats:
        """The load (1|n, columns)."""
        raise NotImplementedError

    def residual(self, state: State, R: Floats) -> None:
        columns = self.columns(state.layout)
        f = np.broadcast_to(self.values(state), (len(self.nodes), len(columns)))
        if self.relative and self._start is not None:
            f = f + self._start
        if self._distinct is None:
            self._distinct = len(set(self.nodes.tolist())) == len(self.nodes)
        at = self.nodes[:, None], columns
        if self._distinct:
            R[at] += f
        else:
            np.add.at(R, at, f)

    def _scalar(self, v: Any, t: float) -> Floats:
        return np.asarray(v(t, self.X, np.arange(len(self.nodes))))[:, None]

    def _vector(self, v: Any, t: float) -> Floats:
        return vector(v, t, self.X, np.arange(len(self.nodes)))


@variable_record
class NodalForce(NodalLoad):
    """A force vector. FEBio User Manual, "Nodal Force"."""

    value: Vector = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        self.value = as_vector(self.value)

    def values(self, state: State) -> Floats:
        return self._vector(self.value, state.time)


@variable_record
class NodalDofLoad(NodalLoad):
    """A load ``scale`` on one degree of freedom by FEBio's name: x, y, z, p (a volume of fluid) or c1 (moles).

    ``rate``: it is per time. FEBio 4.11 takes loads on c1 so, those on other concentrations as moles per step.
    """

    dof: str = "x"
    scale: Number = 0.0
    rate: bool = field(default=False, kw_only=True)

    def __post_init__(self) -> None:
        self.scale = as_value(self.scale)

    def columns(self, layout: Layout) -> Ints:
        return np.array([layout.column(self.dof)])

    def values(self, state: State) -> Floats:
        return self._scalar(self.scale, state.time) * (state.dt if self.rate else 1.0)


@variable_record
class NodalFluidFlux(NodalLoad):
    """A volume rate of fluid: dt * value. FEBio User Manual, "Nodal Fluid Flux"."""

    value: Number = 0.0

    def __post_init__(self) -> None:
        self.value = as_value(self.value)

    def columns(self, layout: Layout) -> Ints:
        return layout.columns(PRESSURE.name)

    def values(self, state: State) -> Floats:
        return state.dt * self._scalar(self.value, state.time)


@variable_record
class NodalTargetForce(NodalLoad):
    """From the force when the load began to ``force``: (1 - scale) start + scale force."""

    force: Vector = (0.0, 0.0, 0.0)
    scale: Number = 1.0

    def __post_init__(self) -> None:
        self.force, self.scale = as_vector(self.force), as_value(self.scale)

    def values(self, state: State) -> Floats:
        s = self._scalar(self.scale, state.time)
        start = 0.0 if self._start is None else self._start
        return s * self._vector(self.force, state.time) + (1.0 - s) * start


register(NodalForce, "nodal_force")
register(NodalDofLoad, "nodal_load")
register(NodalFluidFlux, "nodal fluidflux")
register(NodalTargetForce, "nodal_target_force")
