"""Numbers that must be finite. Only where some are not is it sought which, and said in words."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from math import isfinite
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .kernels.vectors import total
from .values import Value

if TYPE_CHECKING:
    from .group import Group
    from .points import Points
    from .problem import Block, Problem
    from .state import State
    from .system import System

Floats = NDArray[np.float64]
RATES = ("velocity", "acceleration")
PLAIN = {float, int, bool, str, type(None), np.ndarray}  # of the fields of records; values are records themselves


class NotFinite(RuntimeError):
    """A number that is not finite where there must be none; the message says which, in words for the user.

    ``given``: it is a parameter of the model, so that no smaller step would help.
    """

    def __init__(self, message: str, given: bool = False) -> None:
        self.given = given
        super().__init__(message)


def whole(a: NDArray[np.floating]) -> bool:
    """Are all numbers finite? A finite sum has finite terms only; one that is not may have overflowed."""
    added = total(a.ravel()) if a.dtype == np.float64 else np.add.reduce(a, axis=None)
    return isfinite(added) or bool(np.isfinite(a).all())


def check_parameters(block: Block, pts: Points, steady: bool = False) -> None:
    """Raise NotFinite for the first parameter of a block's laws that is not finite at some of its points.

    ``steady``: look at those alone that do not vary in time.
    """
    for law in (block.solid, block.physics):
        for name, value in _values(law):
            if steady and not value.steady:
                continue
            at = np.asarray(value(pts.t, pts.X, pts.e), dtype=float)
            if not np.isfinite(at).all():
                i = int(np.flatnonzero(~np.isfinite(at))[0])
                e = block.ids[pts.e[i]] if len(at) > 1 else block.ids[0]
                raise NotFinite(f"element {e} of part {block.name!r}: its parameter {name} is {at[i]:g}", value.steady)


def node(problem: Problem, row: int) -> str:
    """How messages name a row of the nodal arrays."""
    n = len(problem.X)
    if row >= n:
        return f"the {'rotation' if (row - n) % 2 else 'centre'} of rigid body {problem.bodies[(row - n) // 2].name!r}"
    return f"node {row + 1 if problem.node_ids is None else problem.node_ids[row]}"


def check_state(problem: Problem, state: State, groups: list[Group]) -> None:
    """Raise NotFinite where a state could not be saved: it holds a number that is not finite."""
    for g in groups:
        _check_points(g)
    if not whole(state.d):
        row, column = (int(i) for i in np.argwhere(~np.isfinite(state.d))[0])
        raise NotFinite(f"the {state.layout.label(column)} of {node(problem, row)} is not finite")
    for name in RATES:
        a = getattr(state, name)
        if not whole(a):
            bad = np.flatnonzero(~np.isfinite(a).all(axis=1))
            raise NotFinite(f"the {name} of {node(problem, int(bad[0]))} is not finite")


def blame(system: System, what: str) -> NotFinite:
    """Why ``what`` ("residual" or "tangent") of a system holds a number that is not finite."""
    s = system.state
    try:
        for g in system.groups:
            pts = g.points()
            pts.t, pts.dt = s.time, s.dt
            check_parameters(g.block, pts)
        for g in system.groups:
            _check_points(g)
            if what == "tangent":
                _check_tangent(g, s)
        for kind, acting in (("load", system.loads), ("body load", system.body_loads), ("contact", system.contacts)):
            for k, load in enumerate(acting):
                R = np.zeros_like(s.d)
                load.residual(s, system.carriers, R) if kind == "body load" else load.residual(s, R)
                if not np.isfinite(R).all():
                    raise NotFinite(f"the forces of {kind} {k + 1} ({type(load).__name__}) are not finite")
    except ArithmeticError:  # a law that cannot go on where it is asked for its tangent
        pass
    except NotFinite as e:
        return NotFinite(f"the {what} holds a number that is not finite: {e}", e.given)
    return NotFinite(f"the {what} holds a number that is not finite")


def _check_points(g: Group) -> None:
    held = [("deformation gradient", g.F), *((what, getattr(g.physics, n)) for n, what in g.physics.held.items())]
    for what, a in held:
        if a.size and not whole(a):
            raise NotFinite(f"element {_label(g, a)}: the {what} is not finite")


def _check_tangent(g: Group, state: State) -> None:
    """Raise NotFinite for the first element whose law has a tangent that is not finite."""
    pts = g.points()
    pts.t, pts.dt = state.time, state.dt
    for what, a in g.physics.tangents(pts):
        if not whole(a):
            raise NotFinite(f"element {_label(g, a)}: the tangent of its {what} is not finite")


def _label(g: Group, a: Floats) -> str:
    """The first element with a number in ``a`` (element or point, ...) that is not finite, and its part."""
    bad = np.flatnonzero(~np.isfinite(a.reshape(g.m, -1)).all(axis=1))
    return f"{g.block.ids[bad[0]]} of part {g.block.name!r}"


def _values(record: Any, prefix: str = "") -> Iterator[tuple[str, Any]]:
    """The values of a record and of those below it, with FEBio's names."""
    for f in fields(record):
        name = f.name.removesuffix("_")
        v = getattr(record, f.name)
        for item in v if isinstance(v, (tuple, list)) else (v,):
            if type(item) in PLAIN:  # to ask for a protocol is slow
                continue
            if isinstance(item, Value):
                yield prefix + name, item
            elif is_dataclass(item) and not isinstance(item, type):
                yield from _values(item, f"{prefix}{name}.")
