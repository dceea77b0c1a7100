"""Springs and dashpots over a surface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from . import register
from .base import Floats, Matrices, Number, Patch, SurfaceLoad, scalar

if TYPE_CHECKING:
    from ..state import State

_CROSS = np.zeros((3, 3, 3))  # of vectors: (a x b)_i = CROSS_ijk a_j b_k
_CROSS[0, 1, 2] = _CROSS[1, 2, 0] = _CROSS[2, 0, 1] = 1.0
_CROSS[0, 2, 1] = _CROSS[1, 0, 2] = _CROSS[2, 1, 0] = -1.0


@dataclass(eq=False)
class _Robin(SurfaceLoad):
    """q = spring_eps u + dashpot_eps v resists the displacement u and its rate over the step, per present area.

    Where FEBio 4.11 takes the rate since its last iteration, so that its dashpot vanishes, it is that of the step.
    """

    spring_eps: Number = 0.0
    dashpot_eps: Number = 0.0
    parameters = ("spring_eps", "dashpot_eps")

    @property
    def symmetric(self) -> bool:
        return False

    @property
    def tangent(self) -> bool:
        return True

    def density(self, q: Floats, u: Floats, A: Floats) -> tuple[Floats, Floats, Floats]:
        """Force per natural area (f, g, 3) for q, u and area vectors A (f, g, 3), its derivatives by q and by A."""
        raise NotImplementedError

    def _at(self, state: State, p: Patch) -> tuple[Floats, ...]:
        """q and u, the tangents and the area vector (f, g, 3) of a patch, and dq/du (f, g)."""
        shape = (len(p.conn), p.element.npoints)
        k, c = (scalar(v, state.time, p) for v in (self.spring_eps, self.dashpot_eps))
        k, c = (np.broadcast_to(v, (shape[0] * shape[1],)).reshape(shape) for v in (k, c))
        d, old = self.displacements(state, p)
        u = np.einsum("ga,fai->fgi", p.element.N, d)
        rate = c / state.dt if state.dt > 0 else 0.0 * c
        q = k[..., None] * u + rate[..., None] * (u - np.einsum("ga,fai->fgi", p.element.N, old))
        t = np.einsum("gar,fai->rfgi", p.element.dN, state.x[p.conn])
        return q, u, t[0], t[1], np.cross(t[0], t[1]), k + rate

    def displacements(self, state: State, p: Patch) -> tuple[Floats, Floats]:
        """Of the facets' nodes (f, n, 3), now and at the last step."""
        return state.u[p.conn], state.u_old[p.conn]

    def residual(self, state: State, R: Floats) -> None:
        for p in self.surface:
            q, u, _, _, A, _ = self._at(state, p)
            f = self.density(q, u, A)[0]
            self.add(state, p, np.einsum("g,ga,fgi->fai", p.element.weights, p.element.N, f), R)

    def stiffness(self, state: State, groups: Any = None) -> Matrices:
        out: Matrices = []
        for p in self.surface:
            K, nodes, columns = self.matrices(state, p)
            q, u, r, s, A, rate = self._at(state, p)
            _, by_q, by_A = self.density(q, u, A)
            N, dN, w = p.element.N, p.element.dN, p.element.weights
            turn = np.einsum("ijk,fgk,gb->fgijb", _CROSS, s, dN[:, :, 0])
            turn += np.einsum("ikj,fgk,gb->fgijb", _CROSS, r, dN[:, :, 1])
            D = np.einsum("fgij,fg,gb->fgijb", by_q, rate, N) + np.einsum("fgik,fgkjb->fgijb", by_A, turn)
            K -= np.einsum("g,ga,fgijb->fiajb", w, N, D).reshape(K.shape)
            out.append((K, nodes, columns))
        return out


@dataclass(eq=False)
class PressureRobin(_Robin):
    """A pressure q . n, n the normal, where the surface has moved along it (u . n > 0).

    FEBio user manual, "Robin boundary conditions".
    """

    def density(self, q: Floats, u: Floats, A: Floats) -> tuple[Floats, Floats, Floats]:
        a = np.linalg.norm(A, axis=-1)[..., None]
        n = A / a
        pushed = ((u * n).sum(axis=-1, keepdims=True) > 0) * -self.sign
        p = (q * n).sum(axis=-1, keepdims=True) * pushed
        nn, one = n[..., :, None] * n[..., None, :], np.eye(3)
        by_q = (a * pushed)[..., None] * nn
        by_A = pushed[..., None] * n[..., :, None] * q[..., None, :] + p[..., None] * (one - nn)
        return p * A, by_q, by_A


@dataclass(eq=False)
class TractionRobin(_Robin):
    """A traction -q."""

    def density(self, q: Floats, u: Floats, A: Floats) -> tuple[Floats, Floats, Floats]:
        a = np.linalg.norm(A, axis=-1)[..., None]
        by_A = -q[..., :, None] * (A / a)[..., None, :]
        return -q * a, np.broadcast_to(-a[..., None] * np.eye(3), by_A.shape), by_A


register(PressureRobin, "pressure Robin BC")
register(TractionRobin, "traction Robin BC")
