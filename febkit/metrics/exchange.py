"""Outflow of fluid through the surface of each cell: by nodal fluxes, or by the pressure equation around it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from . import behind, flux, shape
from . import groups as grouping
from .kinematics import Group
from .selection import Selection
from .sources import NodalFlux, PointFlux, PointSupply, Sources
from .storage import Storage

if TYPE_CHECKING:
    import xarray as xr

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
METHODS = ("nodal", "consistent")
SIDES = ("both", "cell")


def make(
    ds: xr.Dataset, pick: Selection, on: flux.CellSurface, sources: Sources, method: str, sides: str
) -> Nodal | Consistent | None:
    """The outflow of the cells ``pick`` by one of :data:`METHODS`, None where a source is missing."""
    if method not in METHODS:
        raise ValueError(f'exchange must be "nodal" or "consistent", not {method!r}')
    if sides not in SIDES:
        raise ValueError(f'sides must be "both" or "cell", not {sides!r}')
    if method == "consistent":
        return Consistent.make(ds, pick, on, sources)
    return Nodal.make(ds, pick, on, sources, sides)


@dataclass(slots=True, eq=False)
class Nodal:
    """Integral of q.n over the surface, q interpolated between its nodes; ``groups`` touch the surface.

    Source: Sibole et al. 2013, eqs 17-18.
    """

    on: flux.CellSurface
    groups: list[Group]
    laws: list[NodalFlux]
    mean: flux.NodalMean
    formula = "rho * integral of q.n over the cell's deformed surface (eqs 17-18), outward > 0"

    @classmethod
    def make(
        cls, ds: xr.Dataset, pick: Selection, on: flux.CellSurface, sources: Sources, sides: str
    ) -> Nodal | None:
        rows, owner = touching(ds, pick, on)
        if sides == "cell":
            rows, owner = _cut(rows, owner, _inside(ds, pick, rows, owner))
        groups = grouping.make(ds, rows, owner, sources.parts or None)
        laws = [sources.nodal_flux(g) for g in groups]
        if any(law is None for law in laws):
            return None
        mean = flux.NodalMean(on, [g.owner for g in groups], [g.nodes for g in groups])
        return cls(on, groups, [law for law in laws if law is not None], mean)

    def outflow(self, u: Floats, t: int) -> Floats:
        """(cell,) volume that leaves in a unit of time, for displacements ``u`` (N, 3)."""
        q = self.mean([law(g.at(u, gradient=True), t) for g, law in zip(self.groups, self.laws)])
        x = self.groups[0].X[self.on.node] + u[self.on.node]
        return flux.outflow(self.on, x.T, q)

    def about(self) -> dict[str, str]:
        return {"exchange": "nodal", "source": "Sibole et al. 2013, eqs 17-18"}


@dataclass(slots=True, eq=False)
class Consistent:
    """The flux that the discrete pressure equation balances, from the elements outside of each surface.

    int_outside phi (div v - s) - w . grad phi dv, phi the sum of the shape functions of the surface's nodes, div v the
    rate of volume, s the solvent supply, w = -K grad p at the integration points, all where the step ends. The
    equation of a node is that its elements' int N (div v - s) - w . grad N dv is zero. Summed over the cell's nodes,
    whose N add up to 1 inside, the elements inside are left with dV/dt less the supply, and those outside with its
    opposite: this outflow is -dV/dt (plus supply) of the cell to the precision of the solve on any mesh, though it
    takes nothing from inside.

    Source: Hughes, Engel, Mazzei, Larson, "The continuous Galerkin method is locally conservative", J Comput Phys 163
    (2000), 467-488.
    """

    on: flux.CellSurface
    groups: list[Group]
    laws: list[PointFlux]
    supply: list[PointSupply | None]
    phi: list[Floats]  # (n, e) of the elements' nodes
    storage: Storage
    seen: NDArray[np.bool_]  # (cell,) there is something porous outside
    formula = (
        "rho * integral of phi (div v - s) - w . grad phi over the elements outside the cell that touch it, phi the "
        "sum of its surface's shape functions, w = -K grad p, s the solvent supply (consistent flux), outward > 0"
    )

    @classmethod
    def make(
        cls, ds: xr.Dataset, pick: Selection, on: flux.CellSurface, sources: Sources
    ) -> Consistent | None:
        rows, owner = touching(ds, pick, on)
        rows, owner = _cut(rows, owner, ~_inside(ds, pick, rows, owner))
        groups = grouping.make(ds, rows, owner, sources.parts or None)
        laws = [sources.point_flux(g) for g in groups]
        if any(law is None for law in laws):
            return None
        porous = [(g, law) for g, law in zip(groups, laws) if law is not None and law is not sources.dry]
        groups = [g for g, _ in porous]
        sealed, seen = _sealed(on, groups)
        if sealed:
            sources.notes.add("mass_exchange_rate", f"{sealed} facets with nothing porous beyond count as sealed")
        phi = [np.asarray(on.slots(g.owner, g.nodes) >= 0, dtype=float) for g in groups]
        storage = Storage.make(ds, sources)
        if storage is None:
            return None
        return cls(on, groups, [w for _, w in porous], [sources.supply(g) for g in groups], phi, storage, seen)

    def outflow(self, u: Floats, t: int) -> Floats:
        """(cell,) volume that leaves in a unit of time, displacements ``u`` (N, 3); NaN where nothing is outside."""
        out = np.where(self.seen, 0.0, np.nan)
        rate = self.storage.at(u, t)
        for g, w, supply, phi in zip(self.groups, self.laws, self.supply, self.phi):
            s = g.at(u, gradient=True)
            made = rate(g, s) if supply is None else rate(g, s) - supply(s, t)
            flow = g.at_points(phi) * made - (w(s, t) * flux.gradient(g, s, phi)).sum(axis=0)
            out += shape.sums(g.owner, (flow * s.dv).sum(axis=0), self.on.cells)
        return out

    def about(self) -> dict[str, str]:
        source = "Hughes, Engel, Mazzei, Larson, J Comput Phys 163 (2000), 467-488"
        return {"exchange": "consistent", "source": source, "storage": self.storage.said()}


def touching(ds: xr.Dataset, pick: Selection, on: flux.CellSurface) -> tuple[Ints, Ints]:
    """Rows of the solids with a node on a cell's surface, and the cell. One between two cells comes for each.

    Membranes are left out: what leaves them at their front is what leaves the cell, their own volume apart.
    """
    conn = np.where(behind.solid_elements(ds)[:, None], np.asarray(ds["connectivity"].values), -1)
    order = np.argsort(on.node, kind="stable")
    nodes, cell = on.node[order], on.cell[order]
    start, stop = (np.searchsorted(nodes, conn, side=s) for s in ("left", "right"))
    e, a = np.nonzero(stop > start)
    count = (stop - start)[e, a]
    at = np.repeat(start[e, a], count) + np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    pairs = np.unique(np.stack([np.repeat(e, count), cell[at]], axis=1), axis=0)
    return pairs[:, 0], pairs[:, 1]


def _inside(ds: xr.Dataset, pick: Selection, rows: Ints, owner: Ints) -> NDArray[np.bool_]:
    """Which of the pairs are an element and its own cell."""
    cell = np.full(ds.sizes["element"], -1)
    cell[pick.rows] = pick.owner
    return np.asarray(cell[rows] == owner)


def _cut(rows: Ints, owner: Ints, keep: NDArray[np.bool_]) -> tuple[Ints, Ints]:
    return rows[keep], owner[keep]


def _sealed(on: flux.CellSurface, groups: list[Group]) -> tuple[int, NDArray[np.bool_]]:
    """How many facets of the cells no element of ``groups`` lies on, and which cells (cell,) have others."""
    seen, sealed = np.zeros(on.cells, dtype=bool), 0
    for f in on.facets:
        mine = np.vstack([f.owner, np.sort(on.node[f.slots], axis=0)])
        beyond = [
            np.vstack([g.owner, np.sort(g.nodes[list(local)], axis=0)])
            for g in groups
            for kind, local in g.element.facets
            if kind == f.element.name
        ]
        key, inverse = np.unique(np.hstack([mine, *beyond]), axis=1, return_inverse=True)
        inverse = inverse.ravel()
        met = np.zeros(key.shape[1], dtype=bool)
        met[inverse[mine.shape[1] :]] = True
        open_ = met[inverse[: mine.shape[1]]]
        sealed += int((~open_).sum())
        seen[f.owner[open_]] = True
    return sealed, seen
