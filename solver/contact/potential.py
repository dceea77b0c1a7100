"""Surfaces that keep their distance by a potential between all their points."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..kernels import potential as kernels
from ..values import as_value
from . import register
from .base import Contact, Floats, Ints, Matrices, Progress, Side, matrices

if TYPE_CHECKING:
    from ..group import Group
    from ..state import State


@dataclass(eq=False)
class Potential(Contact):
    """A force k / r^p - c2 per area and area pushes points apart that are nearer than R_in, c1 (r - R_out)^2 to R_out.

    c1 and c2 make it smooth at R_in. Facets act on each other if they share no node and have two points nearer than
    ``R_out`` whose line has a cosine of ``w_tol`` at least with the primary's normal and whose distance at rest squared
    is ``R0_min`` at least (so FEBio). Kamensky et al., Comput Methods Appl Mech Engrg 330 (2018) 522; FEBio User
    Manual, "Contact potential".
    """

    kc: Any = 0.0  # a Value
    p: float = 4.0
    R_in: float = 1.0
    R_out: float = 2.0
    R0_min: float = 0.0
    w_tol: float = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        self.kc = as_value(self.kc)

    @property
    def passes(self) -> list[Side]:
        return self.sides

    def begin(self, state: State, groups: list[Group]) -> None:
        self.open(state)
        for s in self.sides:
            s.frames(state.X)
        self._rest = [s.points.copy() for s in self.sides]
        self._starts = [np.searchsorted(s.facet, np.arange(len(s.conn) + 1)) for s in self.sides]
        self.update(state, Progress())

    def law(self, state: State) -> Floats:
        """What the kernels take: k, p, R_in, R_out, c1, c2."""
        k, p, near, far = float(self.kc(state.time, state.X[:1])[0]), self.p, self.R_in, self.R_out
        c1 = 0.5 * p * k / ((far - near) * near ** (p + 1.0))
        return np.array([k, p, near, far, c1, k / near**p - c1 * (near - far) ** 2])

    def update(self, state: State, progress: Progress) -> None:
        for s in self.sides:
            s.frames(state.x)
        self.first, self.second = self._pairs()
        self.t = [np.zeros((s.n, 3)) for s in self.sides]

    def _pairs(self) -> tuple[Ints, Ints]:
        """Facets that act on each other."""
        from scipy.spatial import cKDTree

        a, b = self.sides
        near = cKDTree(a.points).sparse_distance_matrix(cKDTree(b.points), self.R_out, output_type="ndarray")
        near = near[near["v"] < self.R_out]
        i, j = near["i"], near["j"]
        across = np.abs(((a.points[i] - b.points[j]) * a.normals[i]).sum(axis=1)) >= self.w_tol * near["v"]
        apart = ((self._rest[0][i] - self._rest[1][j]) ** 2).sum(axis=1) >= self.R0_min
        i, j = i[across & apart], j[across & apart]
        first, second = np.divmod(np.unique(a.facet[i] * len(b.conn) + b.facet[j]), len(b.conn))
        p, q = a.conn[first][:, :, None], b.conn[second][:, None, :]
        strange = ~((p == q) & (p >= 0)).any(axis=(1, 2))
        return first[strange], second[strange]

    def residual(self, state: State, R: Floats) -> None:
        (a, b), areas = self.sides, self._areas()
        self.t = [np.zeros((s.n, 3)) for s in self.sides]
        kernels.tractions(
            self.law(state), self.first, self.second, a.points, areas[0], self._starts[0], b.points, areas[1],
            self._starts[1], *self.t,
        )  # fmt: skip
        Ru = state.layout.u(R)
        for s, w, t in zip(self.sides, areas, self.t, strict=True):
            np.add.at(Ru, np.maximum(s.conn[s.facet], 0), s.N[:, :, None] * (w[:, None] * t)[:, None, :])

    def _areas(self) -> list[Floats]:
        return [s.detJ * s.surface.weight for s in self.sides]

    def stiffness(self, state: State, groups: Any = None) -> Matrices:
        (a, b), (wa, wb), (starta, startb) = self.sides, self._areas(), self._starts
        out, law = [], self.law(state)
        na, nb = a.count[self.first], b.count[self.second]
        for code in np.unique(na * 10 + nb):
            n, m = int(code) // 10, int(code) % 10
            rows = np.flatnonzero((na == n) & (nb == m))
            nodes = np.hstack([a.conn[self.first[rows], :n], b.conn[self.second[rows], :m]])
            K, unknowns, columns = matrices(state, nodes)
            kernels.stiffness(
                law, rows, self.first, self.second, a.points, wa, starta, a.N, n, b.points, wb, startb, b.N, m, K
            )
            out.append((K, unknowns, columns))
        return out

    def values(self, s: Side, what: str, state: State) -> Floats | None:
        t = self.t[self.sides.index(s)]
        if what == "traction":
            return t
        return np.asarray(np.linalg.norm(t, axis=1)) if what == "pressure" else None

    def cliques(self) -> list[Ints]:
        a, b = self.sides
        both = np.hstack([a.conn[self.first], b.conn[self.second]])
        return [both] if len(both) else []


register(Potential, "contact potential")
