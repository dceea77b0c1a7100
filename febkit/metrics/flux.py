"""Fluid flux at nodes and its integral over the surface of a cell (study eqs 17-18)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .kinematics import Group, State

if TYPE_CHECKING:
    from febkit.solver.elements.base import Element

    from .materials import Permeability

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class Facets:
    """Facets of one type on the surfaces of the cells; ``slots`` (n, f) index the surface nodes."""

    element: Element
    slots: Ints
    owner: Ints  # (f,) cell


@dataclass(frozen=True, slots=True, eq=False)
class CellSurface:
    """Outer facets of every cell, outward.

    A surface node belongs to one cell: ``node`` (s,) its index in the mesh, ``cell`` (s,) its cell.
    """

    facets: tuple[Facets, ...]
    node: Ints
    cell: Ints
    cells: int
    total_nodes: int

    def slots(self, owner: Ints, nodes: Ints) -> Ints:
        """Slot of each node (n, e) of cells ``owner`` (e,), -1 where it is not on that cell's surface."""
        key = owner[None] * self.total_nodes + nodes
        mine = self.cell * self.total_nodes + self.node
        at = np.searchsorted(mine, key)
        at[at == len(mine)] = 0
        return np.where(mine[at] == key, at, -1)


def surface(groups: list[Group], cells: int) -> CellSurface:
    """Facets that belong to exactly one element of their cell."""
    total = len(groups[0].X)
    by_type: dict[str, list[tuple[Ints, Ints]]] = {}
    for g in groups:
        for kind, local in g.element.facets:
            by_type.setdefault(kind, []).append((g.nodes[list(local)], g.owner))
    outer = {}
    for kind, lists in by_type.items():
        nodes = np.concatenate([n for n, _ in lists], axis=1)
        owner = np.concatenate([o for _, o in lists])
        key = np.vstack([owner, np.sort(nodes, axis=0)])
        _, first, count = np.unique(key, axis=1, return_index=True, return_counts=True)
        keep = np.sort(first[count == 1])
        outer[kind] = (nodes[:, keep], owner[keep])
    keys = np.unique(np.concatenate([(o[None] * total + n).ravel() for n, o in outer.values()]))
    bare = CellSurface((), keys % total, keys // total, cells, total)
    return CellSurface(
        tuple(Facets(facet_of(k), bare.slots(o, n), o) for k, (n, o) in outer.items()),
        bare.node,
        bare.cell,
        cells,
        total,
    )


def facet_of(kind: str) -> Element:
    """Facet element with a rule that integrates a linear flux exactly (2x2 points on quadrilaterals)."""
    from febkit.solver import elements

    return elements.get(kind, {"quad4": "G4", "tri3": "G3"}.get(kind))


class NodalMean:
    """Mean, at each surface node, of the values its elements extrapolate to it."""

    def __init__(self, on: CellSurface, owners: list[Ints], nodes: list[Ints]) -> None:
        self.slots = [on.slots(o, n) for o, n in zip(owners, nodes)]
        self.size = len(on.node)
        count = sum(np.bincount(s[s >= 0], minlength=self.size) for s in self.slots)
        self.count = np.maximum(count, 1)

    def __call__(self, values: list[Floats]) -> Floats:
        """(3, s) of element-node values (3, n, e), one array for each group."""
        total = np.zeros((3, self.size))
        for slot, v in zip(self.slots, values):
            on = slot >= 0
            for i in range(3):
                total[i] += np.bincount(slot[on], v[i][on], minlength=self.size)
        return total / self.count


def gradient(group: Group, state: State, nodal: Floats) -> Floats:
    """(3, ..., g, e) gradient by current coordinates, at the points, of element-node values (..., n, e)."""
    if state.G is None:
        raise ValueError("the state was made without gradients")
    natural = np.matmul(group.dN, nodal)
    natural = natural.reshape(*natural.shape[:-2], -1, 3, natural.shape[-1])
    return np.stack([sum(natural[..., r, :] * state.G[r, i] for r in range(3)) for i in range(3)])


def darcy(group: Group, state: State, p: Floats, k: Permeability, t: float) -> Floats:
    """(3, g, e) fluid flux -K grad p at the points, grad in the deformed configuration, p (n, e) at elements' nodes."""
    grad = gradient(group, state, p)
    K = k(state.F, state.J, t)
    if K.shape[0] == 1:
        return np.asarray(-K[0] * grad)
    full = ((0, 3, 5), (3, 1, 4), (5, 4, 2))
    return np.stack([-sum(K[full[i][j]] * grad[j] for j in range(3)) for i in range(3)])


def outflow(on: CellSurface, x: Floats, q: Floats) -> Floats:
    """(cell,) integral of q.n over each cell's deformed surface.

    ``x``, ``q`` (3, s) positions and fluxes of the surface nodes; units length^2 times that of q.
    """
    out = np.zeros(on.cells)
    for f in on.facets:
        dN = f.element.dN
        tangent = np.einsum("gnr,inf->irgf", dN, x[:, f.slots])
        normal = np.cross(tangent[:, 0], tangent[:, 1], axis=0)
        flux = np.matmul(f.element.N, q[:, f.slots])
        rate = np.einsum("igf,igf,g->f", flux, normal, f.element.weights)
        out += np.bincount(f.owner, rate, minlength=on.cells)
    return out
