"""Tetrahedra whose strains are averaged over the elements around each node, steadied by the elements' own.

f_a = sum_i V_i P_i . g_ia + sum_e V_e P_e . grad N_a over nodes i and elements e: V_i and F_i are a quarter of the
volumes, and volume means of the deformation gradients, of the elements around node i, g_ia the mean of grad N_a. P_i
is of the stress (1 - alpha) s, P_e of alpha s; where ``isochoric``, of s - alpha dev s and alpha dev s.
Gee, Dohrmann, Key and Wall, Int J Numer Meth Engng 78 (2009) 429; Puso and Solberg, ibid. 67 (2006) 841; FEBio User
Manual, "UT4".
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ..kernels import solid as kernels
from ..matrices import det
from ..points import Points
from . import register
from .base import Floats, Work
from .standard import Standard, StandardWork

if TYPE_CHECKING:
    from ..action import Ints, Matrices
    from ..group import Chunk, Group
    from ..state import State
    from ..tangent import Target, Workspace

I = np.eye(3)
ONE = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
FOUR = np.diag([1.0, 1.0, 1.0, 0.5, 0.5, 0.5])  # of symmetric tensors, the identity
PLACE = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2]])


def dev(s: Floats) -> Floats:
    """The deviator of stresses (..., 6)."""
    return s - s[..., :3].mean(axis=-1)[..., None] * ONE


def dev_moduli(s: Floats, C: Floats, symmetric: bool) -> Floats:
    """Spatial elasticity (n, 6, 6) of the deviator of a stress s with elasticity C.

    C - 1 (1 : C) / 3 - 2 / 3 1 s + 2 p I, p the mean stress; ``symmetric``: the symmetric part of it, as FEBio has it.
    """
    p = s[:, :3].mean(axis=1)[:, None, None]
    out = (np.einsum("i,nj->nij", ONE, C[:, :3].sum(axis=1)) + 2.0 * np.einsum("i,nj->nij", ONE, s)) / 3.0
    if symmetric:
        out = 0.5 * (out + np.swapaxes(out, 1, 2))
    return np.asarray(C - out + 2.0 * p * FOUR)


class NodalWork(StandardWork):
    """``nodes`` (N,) of the block; ``volume``, ``F``, ``J``, ``sn``: of these, stress the whole one; ``patches``: nodes
    (k,) of the block with as many neighbours, these (k, n) and their mean gradients (k, n, 3)."""

    held: ClassVar[Mapping[str, str]] = {"s": "stress", "sn": "nodal stress"}
    collects: ClassVar[bool] = True

    def __init__(self, group: Group, physics: NodalTets) -> None:
        super().__init__(group, physics)
        self.alpha, self.isochoric = physics.alpha, physics.isochoric
        g = group
        self.nodes, at = np.unique(g.conn.astype(np.int64), return_inverse=True)
        self.at = at.reshape(g.conn.shape)
        self.quarter = 0.25 * g.wJ0.sum(axis=1)
        self.volume = np.bincount(self.at.ravel(), np.repeat(self.quarter, 4))
        self.grad = np.ascontiguousarray(np.einsum("ak,eki->eai", g.dN[0], g.iJ0[:, 0]))
        n = len(self.nodes)
        self.F, self.J, self.sn = np.tile(I, (n, 1, 1)), np.ones(n), np.zeros((n, 6))
        element = np.zeros(n, np.int64)
        element[self.at] = np.arange(g.m)[:, None]
        self.patches = self._patches()
        self.points = Points(self.F, self.J, self._positions(), element)

    def _positions(self) -> Floats:
        """Nodes in the reference (N, 3), from the points of elements of constant gradients."""
        g = self.group
        natural = g.element.natural - g.element.points[0]
        jacobian = np.linalg.inv(g.iJ0[:, 0])  # dX/dr
        X = g.Xg.reshape(g.m, g.g, 3)[:, 0, None] + np.einsum("ak,eik->eai", natural, jacobian)
        out = np.zeros((len(self.nodes), 3))
        out[self.at] = X
        return out

    def _patches(self) -> list[tuple[Ints, Ints, Floats]]:
        """Mean gradients of the shape functions of a node's neighbours, itself among them, node by node."""
        from scipy.sparse import coo_array

        n = len(self.nodes)
        w = (self.quarter[:, None] / self.volume[self.at])[:, :, None]
        row, column = np.broadcast_arrays(self.at[:, :, None], self.at[:, None, :])
        mean = [
            coo_array(((w * self.grad[:, None, :, i]).ravel(), (row.ravel(), column.ravel())), (n, n)).tocsr()
            for i in range(3)
        ]
        size, out = np.diff(mean[0].indptr), []
        for k in np.unique(size):
            rows = np.flatnonzero(size == k)
            places = mean[0].indptr[rows][:, None] + np.arange(k)
            around = mean[0].indices[places].astype(np.int64)
            out.append((rows, around, np.stack([q.data[places] for q in mean], axis=-1)))
        return out

    def symmetric(self, steady: bool) -> bool:
        return super().symmetric(steady) and not self.isochoric

    def cliques(self) -> list[Ints]:
        return [self.nodes[around] for _, around, _ in self.patches]

    # ---- stress -----------------------------------------------------------------------------------
    def collect(self, state: State) -> None:
        g = self.group
        self.points.t, self.points.dt = state.time, state.dt
        w = self.quarter[:, None] / self.volume[self.at]
        self.F[:] = 0.0
        np.add.at(self.F, self.at, w[:, :, None, None] * g.F[:, 0, None])
        self.J[:] = det(self.F)
        self.sn[:] = 0.0
        g.block.solid.stress(self.points, self.sn, None)

    def _nodal(self) -> Floats:
        """The share of the nodes in their stress (N, 6)."""
        return self.sn - self.alpha * (dev(self.sn) if self.isochoric else self.sn)

    def _own(self, s: Floats) -> Floats:
        """The share of the elements in their stress (..., 6)."""
        return self.alpha * (dev(s) if self.isochoric else s)

    def residual(self, lo: int, hi: int, state: State, R: Floats, steady: bool) -> None:
        g, Ru = self.group, state.layout.u(R)
        own = np.zeros_like(self.s)
        own[lo:hi] = self._own(self.s[lo:hi])
        kernels.internal_force(lo, hi, g.conn, g.dN, g.iJ0, g.wJ0, g.F, g.J, own, Ru)
        # a node's force is shared out by its elements: V_e / 4 P_i . grad N_a of each
        P = self.J[:, None, None] * self._nodal()[:, PLACE] @ np.swapaxes(np.linalg.inv(self.F), 1, 2)
        e = slice(lo, hi)
        mean = P[self.at[e]].sum(axis=1)
        np.add.at(Ru, g.conn[e], -np.einsum("e,eij,eaj->eai", self.quarter[e], mean, self.grad[e]))

    # ---- tangent ----------------------------------------------------------------------------------
    def tangent(self, c: Chunk, state: State, target: Target, work: Workspace, steady: bool) -> None:
        """Of the elements' own stress."""
        q = (c.hi - c.lo) * self.group.g
        s, C = work.zeros("s", q, 6), work.zeros("C", q, 6, 6)
        c.points.t, c.points.dt = state.time, state.dt
        self.moduli(c, s, C)
        if self.isochoric:
            C = dev_moduli(s, C, target.pat.symmetric)
        s, C = self._own(s), np.ascontiguousarray(self.alpha * C)
        for lo, hi, _, p in self.group.pieces(c):
            K = work.take("K", hi - lo, 12, 12)
            g = self.group
            kernels.stiffness(lo, hi, *g.geometry, s[p].reshape(-1, g.g, 6), C[p].reshape(-1, g.g, 6, 6), K)
            target.add(g, lo, hi, K)

    def couplings(self, state: State, symmetric: bool) -> Matrices:
        """Of the stresses at the nodes: V_i (grad_a . c . grad_b + grad_a . s . grad_b), gradients of the present."""
        s, C = np.zeros((len(self.nodes), 6)), np.zeros((len(self.nodes), 6, 6))
        self.group.block.solid.stress(self.points, s, C)
        own = dev_moduli(s, C, symmetric) if self.isochoric else C
        C, s = C - self.alpha * own, self._nodal()
        Fi = np.linalg.inv(self.F)
        out: Matrices = []
        for rows, around, grad in self.patches:
            now = np.einsum("nbj,njk->nbk", grad, Fi[rows])
            w = self.volume[rows] * self.J[rows]
            K = np.einsum("n,naj,nijkl,nbl->niakb", w, now, _four(C[rows]), now, optimize=True)
            geometric = np.einsum("n,naj,njl,nbl->nab", w, now, s[rows][:, PLACE], now, optimize=True)
            K[:, [0, 1, 2], :, [0, 1, 2]] += geometric
            n = around.shape[1]
            nodes = np.tile(self.nodes[around], (1, 3))
            out.append((K.reshape(len(rows), 3 * n, 3 * n), nodes, np.repeat(state.layout.displacement, n)))
        return out


def _four(C: Floats) -> Floats:
    """Elasticity (n, 6, 6) with four indices."""
    return C[:, PLACE[:, :, None, None], PLACE[None, None, :, :]]


@dataclass(eq=False)
class NodalTets(Standard):
    """``alpha``: weight of the elements' own stress, or, where ``isochoric``, of its deviator."""

    alpha: float = 0.05
    isochoric: bool = False
    name: ClassVar[str] = "ut4"
    work: ClassVar[type[Work]] = NodalWork


register(NodalTets, "ut4")
