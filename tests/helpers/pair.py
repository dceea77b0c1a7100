"""Two blocks, one on the other, whose meshes do not match: scenes for tests of contact."""

from __future__ import annotations

from typing import Any

import numpy as np

from febkit.solver.contact.surface import Facets
from febkit.solver.group import Group
from febkit.solver.permeabilities.const_iso import ConstIso
from febkit.solver.physics import default
from febkit.solver.physics.biphasic import Biphasic
from febkit.solver.problem import Block, Fixed, Prescribed, Problem, Progress, Step
from febkit.solver.run import run
from febkit.solver.solids.isotropic_elastic import IsotropicElastic
from febkit.solver.state import State
from febkit.solver.values import Constant
from helpers import scenes
from helpers.scenes import UX, UY, UZ

E, V = 2.0, 0.3


def _faces(X: Any, conn: Any, z: float, up: bool) -> Any:
    """Faces of hexahedra on a plane z, outward."""
    local = [4, 5, 6, 7] if up else [0, 3, 2, 1]
    faces = conn[:, local]
    return faces[np.abs(X[faces][:, :, 2] - z).max(axis=1) < 1e-9]


class Pair:
    """A lower block of 2 x 2 and an upper one of ``n`` x ``n`` elements a side, of unit height; they touch at z = 1.

    With n = 4 every facet of the upper block lies in one of the lower block, so that rules of both integrate exactly.
    ``inset``: the upper block is narrower by this much at each side.
    """

    def __init__(
        self, n: int = 3, gap: float = 0.0, skew: float = 0.0, inset: float = 0.0, biphasic: bool = False,
        physics: Any = None,
    ) -> None:  # fmt: skip
        low, below = scenes.grid((2, 2, 2))
        high, above = scenes.grid((n, n, 2))
        if skew:
            inside = ((low[:, :2] > 1e-9) & (low[:, :2] < 1 - 1e-9)).all(axis=1)
            low = low + skew * inside[:, None] * np.array([1.0, -0.7, 0.0])
        high[:, :2] = inset + (1 - 2 * inset) * high[:, :2]
        self.bottom, self.top = below, above + len(low)
        self.n = len(low)
        self.X = np.vstack([low, high + np.array([0.0, 0.0, 1.0 + gap])])
        self.lower = _faces(low, below, 1.0, True)
        self.upper = _faces(high, above, 0.0, False) + len(low)
        solid = IsotropicElastic(E, V)
        physics = physics or (Biphasic(ConstIso(0.5)) if biphasic else default())
        self.blocks = [
            Block(name, "hex8", c, np.arange(1, len(c) + 1), solid, physics)
            for name, c in (("low", below), ("high", self.top))
        ]

    def facets(self, conn: Any, block: int) -> Facets:
        """A side with the elements behind its facets."""
        elements = self.blocks[block].conn
        owner = [[block, int(np.flatnonzero(np.isin(elements, f).sum(axis=1) == 4)[0])] for f in conn]
        return Facets({"quad4": conn}, {"quad4": np.array(owner)})

    @property
    def sides(self) -> dict[str, Facets]:
        return {"primary": self.facets(self.upper, 1), "secondary": self.facets(self.lower, 0)}

    def at(self, z: float) -> Any:
        return np.flatnonzero(np.abs(self.X[:, 2] - z) < 1e-9)

    def problem(self, contact: Any, top: float, **newton: Any) -> Problem:
        """The upper block pressed down by ``top``; planes of symmetry at x = 0 and y = 0, free sides beyond."""
        conditions: list[Any] = [Fixed(c, np.flatnonzero(self.X[:, c] < 1e-9)) for c in (UX, UY)]
        conditions += [Fixed(UZ, self.at(0.0)), Prescribed(UZ, self.at(self.X[:, 2].max()), Constant(top))]
        step = Step(dt=1.0, count=1, newton=scenes.tight(**newton), conditions=conditions, contacts=[contact])
        return Problem(self.X, self.blocks, [step])


def affine(X: Any, u: Any) -> tuple[Any, float]:
    """Gradient of u (n, 3) by least squares, and the largest departure from an affine field."""
    A = np.hstack([X, np.ones((len(X), 1))])
    fit, *_ = np.linalg.lstsq(A, u, rcond=None)
    return fit[:3].T, float(np.abs(A @ fit - u).max())


def solve(problem: Problem) -> Any:
    result = run(problem)
    assert result.converged, result.reason
    return result


def started(pair: Pair, contact: Any) -> State:
    """A state with the contact activated at rest."""
    problem = pair.problem(contact, 0.0)
    state = State.at_rest(problem)
    state.dt = 0.5
    contact.begin(state, [Group(b, pair.X) for b in pair.blocks])
    return state


def forces(contact: Any, state: State, d: Any, steps: int = 1) -> Any:
    """Contact forces (node, 3) at displacements d, the first iteration being over."""
    state.d[:, : d.shape[1]] = d
    contact.update(state, Progress(steps))
    R = np.zeros_like(state.d)
    contact.residual(state, R)
    return R


def stiffness(contact: Any, state: State) -> Any:
    """The contact's tangent (3 n, 3 n) over all displacements, dense."""
    K = np.zeros((state.d.size, state.d.size))
    for k, nodes, columns in contact.stiffness(state):
        rows = nodes * state.d.shape[1] + columns
        for e in range(len(k)):
            np.add.at(K, (rows[e][:, None], rows[e][None]), k[e])
    return K


def difference(contact: Any, state: State, d: Any, h: float = 1e-6) -> Any:
    """Minus the derivative of the forces by central differences, column by column."""
    out = np.zeros((d.size, d.size))
    for j in range(d.size):
        step = np.zeros(d.size)
        step[j] = h
        plus, minus = (forces(contact, state, d + sign * step.reshape(d.shape)) for sign in (1, -1))
        out[:, j] = -(plus - minus).ravel() / (2 * h)
    forces(contact, state, d)
    return out
