"""Consistent mass: M_ab = sum_g rho_0 N_a N_b w J_0, the same for the three displacement components."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .group import Group
from .kernels.mass import add_product

Floats = NDArray[np.float64]


def elements(group: Group) -> Floats:
    """Element mass matrices (m, n, n) of one group."""
    rho = np.broadcast_to(group.block.solid.density(group.points()), (group.m * group.g,))
    w = group.wJ0 * rho.reshape(group.m, group.g)
    return np.ascontiguousarray(np.einsum("eg,ga,gb->eab", w, group.N, group.N, optimize=True))


class Mass:
    """The mass of all groups, element by element: ``parts`` are groups and their matrices (m, n, n)."""

    def __init__(self, groups: list[Group]) -> None:
        self.parts = [(g, elements(g)) for g in groups]

    def __matmul__(self, a: Floats) -> Floats:
        """Applied to nodal vectors (node, 3)."""
        out, a = np.zeros(a.shape), np.ascontiguousarray(a)
        for g, M in self.parts:
            add_product(g.conn, M, a, out)
        return out

    def diagonal(self, nodes: int) -> Floats:
        """M_aa (node,)."""
        out = np.zeros(nodes)
        for g, M in self.parts:
            np.add.at(out, g.conn, np.einsum("eaa->ea", M))
        return out

    def solve(self, f: Floats, free: NDArray[np.bool_], tolerance: float = 1e-14) -> Floats:
        """a (node, 3), zero where not ``free``, with M a = f elsewhere: conjugate gradients scaled by the diagonal."""
        d = self.diagonal(len(f))
        inside = free & (d > 0)[:, None]
        scale = np.where(inside, 1.0 / np.where(d > 0, d, 1.0)[:, None], 0.0)
        a, r = np.zeros(f.shape), np.where(inside, f, 0.0)
        p = z = scale * r
        first = now = float((r * z).sum())
        for _ in range(10 * f.size):
            if now <= tolerance**2 * first:
                break
            q = np.where(inside, self @ p, 0.0)
            step = now / float((p * q).sum())
            a += step * p
            r -= step * q
            z = scale * r
            before, now = now, float((r * z).sum())
            p = z + now / before * p
        return a
