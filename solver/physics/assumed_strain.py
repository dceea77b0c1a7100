"""Shells of assumed natural and enhanced assumed strains: Green-Lagrange strains in natural components.

E_c = 1/2 sum_ab A_ab (x_a . x_b - X_a . X_b) with A of the products of shape functions' derivatives along r, s, t;
those of the transverse shears are interpolated from the middles of the edges, that of the thickness from the corners.
Enhanced: E + G alpha, 7 parameters alpha an element, which the element's own balance int G^T S dV = 0 gives.
Vu-Quoc and Tan, Comput Methods Appl Mech Engrg 192 (2003) 975; Betsch and Stein, Commun Numer Meth Engng 11 (1995)
899 (thickness); FEBio User Manual, "ShellDomain", elastic-shell-ans and elastic-shell-eas.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..group import NegativeJacobian
from ..points import VOIGT, Points
from ..record import variable_record
from . import register
from .base import Floats, Work
from .standard import Standard, StandardWork

if TYPE_CHECKING:
    from ..group import Chunk, Group
    from ..state import State
    from ..tangent import Target, Workspace

PAIRS = VOIGT  # rr ss tt rs st rt
EDGES = np.array([[0.0, -1, 0], [1, 0, 0], [0, 1, 0], [-1, 0, 0]])  # middles of edges, t = 0
CORNERS = np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
ROUNDS, ENOUGH = 30, 1e-12  # of the elements' own Newton steps; their size relative to 1 that is none


def products(d: Floats) -> Floats:
    """A (p, 6, n, n) of gradients d (p, n, 3): shears count twice, as engineering strains do."""
    out = [np.einsum("pa,pb->pab", d[..., i], d[..., j]) for i, j in PAIRS]
    return np.stack([q if k < 3 else q + np.swapaxes(q, 1, 2) for k, q in enumerate(out)], axis=1)


def assumed(element: Any) -> Floats:
    """A (g, 6, n, n) at the points of a four-node shell, with the interpolated components."""
    A = products(element.dN)
    r, s = element.points[:, 0, None, None], element.points[:, 1, None, None]
    edge, corner = products(element.gradient(EDGES)), products(element.gradient(CORNERS))
    A[:, 5] = 0.5 * ((1 - s) * edge[0, 5] + (1 + s) * edge[2, 5])
    A[:, 4] = 0.5 * ((1 - r) * edge[3, 4] + (1 + r) * edge[1, 4])
    A[:, 2] = sum((1 + a * r) * (1 + b * s) * q for (a, b, _), q in zip(CORNERS, corner[:, 2])) / 4.0
    return A


def pushed(h: Floats) -> Floats:
    """T (..., 6, 6): components c = (i, j) of h_i . s . h_j of a symmetric tensor s (xx yy zz xy yz xz)."""
    T = np.empty((*h.shape[:-2], 6, 6))
    for c, (i, j) in enumerate(PAIRS):
        for v, (p, q) in enumerate(VOIGT):
            T[..., c, v] = h[..., i, p] * h[..., j, q]
            if p != q:
                T[..., c, v] += h[..., i, q] * h[..., j, p]
    return T


class AssumedWork(StandardWork):
    """alpha (m, 7 | 0); S (m, g, 6) and C (m, g, 6, 6): natural components of stress and material tangent."""

    memory: ClassVar[tuple[str, ...]] = ("s", "alpha", "S", "C")

    def __init__(self, group: Group, physics: AssumedStrain) -> None:
        super().__init__(group, physics)
        m, g = group.m, group.g
        self.A = assumed(group.element)
        self.G = self._modes() if physics.enhanced else np.zeros((m, g, 6, 0))
        self.alpha = np.zeros((m, self.G.shape[-1]))
        self.S, self.C = np.zeros((m, g, 6)), np.zeros((m, g, 6, 6))

    def _modes(self) -> Floats:
        """Enhancing strains (m, g, 6, 7): r, s, t, r t, s t of rr, ss, tt, tt, tt and r, s of rs at the middle.

        They are turned to the base at a point, times the ratio of the volumes at the middle and there.
        """
        g = self.group
        X = np.asarray(np.linalg.inv(g.iJ0), float)  # dX / dr at the points
        middle = np.einsum("ak,eai->eik", g.element.gradient(np.zeros((1, 3)))[0], self._nodes(X))
        P = np.einsum("egik,eli->egkl", X, np.linalg.inv(middle))
        ratio = np.linalg.det(middle)[:, None] / np.linalg.det(X)
        r, s, t = g.element.points.T
        modes = [(0, 0, r), (1, 1, s), (2, 2, t), (2, 2, r * t), (2, 2, s * t), (0, 1, r), (0, 1, s)]
        out = np.zeros((g.m, g.g, 6, 7))
        for n, (k, l, size) in enumerate(modes):
            for c, (i, j) in enumerate(PAIRS):
                strain = 0.5 * (P[..., i, k] * P[..., j, l] + P[..., i, l] * P[..., j, k])
                out[..., c, n] = strain * size * ratio * (1.0 if i == j else 2.0)
        return out

    def _nodes(self, X: Floats) -> Floats:
        """Nodes (m, n, 3) of the reference, up to a translation, from dX/dr at the points."""
        g = self.group
        fit = np.linalg.pinv(g.element.dN.transpose(0, 2, 1).reshape(-1, g.n))  # (n, 3 g)
        return np.asarray(np.einsum("aq,eqi->eai", fit, X.transpose(0, 1, 3, 2).reshape(g.m, -1, 3)))

    # ---- stress -----------------------------------------------------------------------------------
    def update(self, c: Chunk, state: State, drive: list[Any]) -> None:
        g, e = self.group, slice(c.lo, c.hi)
        X, x = state.X[g.conn[e]], state.x[g.conn[e]]
        square = np.einsum("eai,ebi->eab", x, x) - np.einsum("eai,ebi->eab", X, X)
        E = 0.5 * (square.reshape(len(x), -1) @ self.A.reshape(g.g * 6, -1).T).reshape(len(x), g.g, 6)
        self._balance(c, E, state)
        # as FEBio writes it: with the deformation gradient of the displacements
        base = g.F[e] @ np.linalg.inv(g.iJ0[e])
        self.s[e] = (pushed(base) @ self.S[e][..., None])[..., 0] / g.J[e][..., None]

    def _balance(self, c: Chunk, E: Floats, state: State) -> None:
        """Stresses under the strains E (e, g, 6), with the enhancing ones that leave no work of their own."""
        e = slice(c.lo, c.hi)
        w, G = self.group.wJ0[e][..., None], self.G[e]
        for _ in range(ROUNDS):
            self._respond(c, E + (G @ self.alpha[e][:, None, :, None])[..., 0], state)
            if not G.shape[-1]:
                return
            f = (np.swapaxes(G, 2, 3) @ (w * self.S[e])[..., None]).sum(axis=1)
            K = (np.swapaxes(G, 2, 3) @ (w[..., None] * self.C[e]) @ G).sum(axis=1)
            step = np.linalg.solve(K, f)[..., 0]
            self.alpha[e] -= step
            if np.abs(step).max() <= ENOUGH:
                return

    def _respond(self, c: Chunk, E: Floats, state: State) -> None:
        """S and C at natural strains E: of F with F^T F = 1 + 2 E."""
        g, e = self.group, slice(c.lo, c.hi)
        base = g.iJ0[e]  # base[k] = d r_k / dX
        tensor = 0.5 * E[..., [0, 3, 5, 3, 1, 4, 5, 4, 2]].reshape(*E.shape[:2], 3, 3) * (1.0 + np.eye(3))
        B = np.eye(3) + 2.0 * np.swapaxes(base, 2, 3) @ tensor @ base
        least = np.linalg.eigvalsh(B)[..., 0].min(axis=1)
        if not (least > 0.0).all():
            raise NegativeJacobian(int(g.block.ids[e][int(np.argmin(least > 0.0))]), g.block.name)
        F = np.ascontiguousarray(np.swapaxes(np.linalg.cholesky(B), 2, 3))  # as kernels of materials have it elsewhere
        J = np.linalg.det(F)
        n = J.size
        own = c.points
        pts = Points(F.reshape(n, 3, 3), J.reshape(n), own.X, own.e, state.time, state.dt, own.Q)
        s, C = np.zeros((n, 6)), np.zeros((n, 6, 6))
        g.block.solid.stress(pts, s, C)
        T = pushed(base @ np.linalg.inv(F))
        J = J[..., None]
        self.S[e] = J * (T @ s.reshape(*E.shape, 1))[..., 0]
        self.C[e] = J[..., None] * (T @ C.reshape(*E.shape, 6) @ np.swapaxes(T, 2, 3))

    # ---- residual and tangent ---------------------------------------------------------------------
    def _pull(self, lo: int, hi: int) -> Floats:
        """sum w S A (e, n, n)."""
        g, e = self.group, slice(lo, hi)
        w = (g.wJ0[e][..., None] * self.S[e]).reshape(hi - lo, -1)
        return (w @ self.A.reshape(g.g * 6, -1)).reshape(hi - lo, g.n, g.n)

    def residual(self, lo: int, hi: int, state: State, R: Floats, steady: bool) -> None:
        g = self.group
        np.add.at(state.layout.u(R), g.conn[lo:hi], -self._pull(lo, hi) @ state.x[g.conn[lo:hi]])

    def tangent(self, c: Chunk, state: State, target: Target, work: Workspace, steady: bool) -> None:
        g = self.group
        for lo, hi, _, _ in g.pieces(c):
            e, m, n = slice(lo, hi), hi - lo, g.n
            x = state.x[g.conn[e]]
            B = (self.A.reshape(1, -1, n) @ x).reshape(m, g.g * 6, n, 3)
            B = np.ascontiguousarray(np.swapaxes(B, 2, 3)).reshape(m, g.g, 6, 3 * n)
            D = g.wJ0[e][..., None, None] * self.C[e]
            K = (np.swapaxes(B, 2, 3) @ D @ B).sum(axis=1)
            if self.G.shape[-1]:
                mixed = (np.swapaxes(B, 2, 3) @ D @ self.G[e]).sum(axis=1)
                own = (np.swapaxes(self.G[e], 2, 3) @ D @ self.G[e]).sum(axis=1)
                K -= mixed @ np.linalg.solve(own, np.swapaxes(mixed, 1, 2))
            geometric = self._pull(lo, hi)
            for i in range(3):
                K[:, i * n : (i + 1) * n, i * n : (i + 1) * n] += geometric
            target.add(g, lo, hi, np.ascontiguousarray(K))


@variable_record
class AssumedStrain(Standard):
    """``enhanced``: by seven parameters an element."""

    enhanced: bool = False
    name: ClassVar[str] = "assumed strain"
    work: ClassVar[type[Work]] = AssumedWork


register(AssumedStrain, "assumed strain")
