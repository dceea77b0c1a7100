"""Flux with which a solute leaves where nothing else is said of it: carried by the fluid, with no gradient along n."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..fields import concentration
from ..kernels.surface import add_scalars, flow, flow_stiffness
from ..multiphasic.integrals import operators
from . import register
from .base import Floats, Ints, Matrices, Patch, SurfaceLoad

if TYPE_CHECKING:
    from ..group import Group
    from ..state import State


@dataclass(eq=False)
class SoluteNaturalFlux(SurfaceLoad):
    """dt int N ca w . da over facets, less dt int N grad c . n dv over the elements behind them.

    ca and w: means over the element of the actual concentration and the fluid flux; n: mean normal of the facet. As in
    FEBio 4.11 the tangent leaves out how they change: its iterations slow down with w.
    ``owner``: for each patch the block and element (f, 2) behind its facets. FEBio User Manual, "Solute Natural Flux".
    """

    solute: int = 1
    owner: tuple[Ints, ...] = ()

    @property
    def symmetric(self) -> bool:
        return False

    @property
    def tangent(self) -> bool:
        return True

    @property
    def field(self) -> str:
        """Name of the solute's nodal field."""
        return concentration(self.solute).name

    def begin(self, state: State, groups: list[Group]) -> None:
        self._groups = groups

    # ---- pieces -------------------------------------------------------------------------------------
    def _behind(self, owner: Ints) -> Iterator[tuple[Group, Ints, Ints]]:
        """Groups behind the facets of a patch, with the facets' rows and their elements."""
        for block in np.unique(owner[:, 0]):
            rows = np.flatnonzero(owner[:, 0] == block)
            yield self._groups[int(block)], rows, owner[rows, 1]

    def _fluxes(self, p: Patch, owner: Ints, x: Floats) -> tuple[Floats, Floats]:
        """Normal fluxes of the solute at the points of a patch (f g,), and mean normals of its facets (f, 3)."""
        t = np.einsum("gaj,fai->fgji", p.element.dN, x[p.conn])
        n = np.cross(t[:, :, 0], t[:, :, 1])
        q = np.empty(n.shape[:2])
        for g, rows, e in self._behind(owner):
            unit = n[rows] / np.linalg.norm(n[rows], axis=2, keepdims=True)
            q[rows] = np.einsum("fi,fgi->fg", g.physics.carried(e, self.field), unit)
        mean = n.sum(axis=1)
        return q.ravel(), mean / np.linalg.norm(mean, axis=1, keepdims=True)

    def _inside(self, g: Group, e: Ints, normal: Floats, c: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """Of elements e at their points: weights (k, g), gradients of N (k, g, 3, n), along the normal, and of c."""
        B = operators(0, len(e), g.N, g.dN, g.iJ0[e], g.F[e], g.J[e])[:, :, 1:]
        along = np.einsum("kgin,ki->kgn", B, normal)
        return g.wJ0[e] * g.J[e], B, along, np.einsum("kgin,kn->kgi", B, c[g.conn[e]])

    # ---- forces -------------------------------------------------------------------------------------
    def residual(self, state: State, R: Floats) -> None:
        x, c = self.positions(state), state.layout.scalar(state.d, self.field)
        rows_c = state.layout.scalar(R, self.field)
        for p, owner in zip(self.surface, self.owner, strict=True):
            q, normal = self._fluxes(p, owner, x)
            f = np.zeros(p.conn.shape)
            flow(x, state.velocity, *p.geometry, q, False, f)
            add_scalars(p.conn, state.dt * f, rows_c)
            for g, rows, e in self._behind(owner):
                w, _, _, gc = self._inside(g, e, normal[rows], c)
                inside = np.einsum("kg,gn,kgi,ki->kn", w, g.N, gc, normal[rows])
                np.add.at(rows_c, g.conn[e], -state.dt * inside)

    def stiffness(self, state: State, groups: Any = None) -> Matrices:
        x, c, out = self.positions(state), state.layout.scalar(state.d, self.field), []
        for p, owner in zip(self.surface, self.owner, strict=True):
            q, normal = self._fluxes(p, owner, x)
            K, nodes, columns = self.matrices(state, p, self.field)
            flow_stiffness(x, state.velocity, *p.geometry, q, False, True, state.dt, K)
            out.append((K, nodes, columns))
            for g, rows, e in self._behind(owner):
                out.append(self._element(state, g, e, normal[rows], c))
        return out

    def _element(self, state: State, g: Group, e: Ints, normal: Floats, c: Floats) -> tuple[Floats, Ints, Ints]:
        """Matrices of the elements e, component by component of the displacement and the concentration."""
        w, B, along, gc = self._inside(g, e, normal, c)
        n, dt = g.n, state.dt
        K = np.zeros((len(e), 4 * n, 4 * n))
        rows = K[:, 3 * n :]
        rows[:, :, 3 * n :] = dt * np.einsum("kg,gn,kgm->knm", w, g.N, along)
        moved = B * np.einsum("kgi,ki->kg", gc, normal)[:, :, None, None] - gc[..., None] * along[:, :, None]
        for i in range(3):
            rows[:, :, i * n : (i + 1) * n] = dt * np.einsum("kg,gn,kgm->knm", w, g.N, moved[:, :, i])
        own = np.concatenate([state.layout.displacement, state.layout.columns(self.field)])
        return K, np.tile(g.conn[e].astype(np.int64), (1, 4)), np.repeat(own, n)


register(SoluteNaturalFlux, "solute natural flux")
