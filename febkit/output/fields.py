"""Plot variables of a run: FEBio's name -> values, per node, element or domain.

A nodal field returns (node[, comp]); a domain field one array per group, or None where a group has none.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from febkit.solver import physics
from febkit.solver.points import VOIGT

if TYPE_CHECKING:
    from febkit.solver.group import Group
    from febkit.solver.run import Run

Floats = NDArray[np.float64]
Nodal = Callable[["Run"], Floats]
Domain = Callable[["Group"], "Floats | None"]

def voigt(T: Floats) -> Floats:
    """Symmetric tensors (..., 3, 3) as (..., 6): xx yy zz xy yz xz."""
    return np.stack([T[..., i, j] for i, j in VOIGT], axis=-1)


def _mean(values: Floats) -> Floats:
    """Mean over integration points (element, point, ...), as FEBio writes element data."""
    return values.mean(axis=1)


# ---- integration points -----------------------------------------------------------------------------
def at_points(g: Group, name: str) -> Floats | None:
    """What the physics of a group offers under FEBio's name, at its points (m, g[, component]); None: nothing."""
    give = g.physics.outputs.get(name)
    return None if give is None else give(g.physics)


def point_strain(g: Group) -> Floats:
    """Green-Lagrange strain (m, g, 6), E = (F^T F - I) / 2."""
    C = np.einsum("egki,egkj->egij", g.F, g.F)
    return voigt(0.5 * (C - np.eye(3)))


def _stretch(g: Group, left: bool, function: Callable[[Floats], Floats]) -> Floats:
    F = g.F
    A = np.einsum("egik,egjk->egij", F, F) if left else np.einsum("egki,egkj->egij", F, F)
    w, v = np.linalg.eigh(A)
    return voigt(np.einsum("egik,egk,egjk->egij", v, function(np.sqrt(w)), v))


def _density(g: Group) -> Floats:
    rho = np.broadcast_to(g.block.solid.density(g.points()), (g.m * g.g,)).reshape(g.m, g.g)
    return rho / g.J


def _nodes(values: Floats, g: Group) -> Floats:
    """Integration point values to the element's nodes (m, n, ...)."""
    return np.einsum("ng,eg...->en...", g.element.extrapolation, values)


def _item(points: Callable[[Group], Floats | None]) -> Domain:
    def field(g: Group) -> Floats | None:
        v = points(g)
        return None if v is None else _mean(v)

    return field


def _gradient(g: Group) -> Floats:
    return g.F.reshape(g.m, g.g, 9)


def _pk1(g: Group) -> Floats | None:
    """First Piola-Kirchhoff stress J sigma F^-T (m, g, 9)."""
    stress = at_points(g, "stress")
    if stress is None:
        return None
    s = stress[..., [0, 3, 5, 3, 1, 4, 5, 4, 2]].reshape(g.m, g.g, 3, 3)
    P = g.J[..., None, None] * np.einsum("egik,egjk->egij", s, np.linalg.inv(g.F))
    return P.reshape(g.m, g.g, 9)


def _specific_energy(g: Group) -> Floats | None:
    """Strain energy per mass (m, g)."""
    W = at_points(g, "strain energy density")
    return None if W is None else W / (_density(g) * g.J)


def _at_nodes(values: Callable[[Group], Floats | None]) -> Domain:
    def field(g: Group) -> Floats | None:
        v = values(g)
        return None if v is None else _nodes(v, g)

    return field


def _shell(g: Group) -> bool:
    return g.block.element.startswith("shell_")


NODAL: dict[str, Nodal] = {
    "displacement": lambda r: r.state.u,
    "nodal velocity": lambda r: r.state.velocity,
    "nodal acceleration": lambda r: r.state.acceleration,
    "reaction forces": lambda r: r.state.reaction,
}

DOMAIN: dict[str, Domain] = {
    "Lagrange strain": _item(point_strain),
    "infinitesimal strain": _item(lambda g: voigt(0.5 * (g.F + np.swapaxes(g.F, -1, -2)) - np.eye(3))),
    "right stretch": _item(lambda g: _stretch(g, False, lambda x: x)),
    "left stretch": _item(lambda g: _stretch(g, True, lambda x: x)),
    "right Hencky": _item(lambda g: _stretch(g, False, np.log)),
    "left Hencky": _item(lambda g: _stretch(g, True, np.log)),
    "relative volume": _item(lambda g: g.J),
    "deformation gradient": _item(_gradient),
    "PK1 stress": _item(_pk1),
    "density": _item(_density),
    "specific strain energy": _item(_specific_energy),
    "nodal stress": _at_nodes(lambda g: None if _shell(g) else at_points(g, "stress")),
    "nodal strain": _at_nodes(lambda g: None if _shell(g) else point_strain(g)),
    "nodal fluid flux": _at_nodes(lambda g: at_points(g, "fluid flux")),
}

# nodal fields by domain: plot variable -> nodal field (solver.fields), written for the groups that solve for it
DOMAIN_NODAL: dict[str, str] = {"effective fluid pressure": "fluid pressure"}
SOLUTES = "effective solute concentration"  # nodal fields by domain, of all solutes of the model
# arrays over the model's solutes, and over its solid-bound molecules
ARRAYS = {
    SOLUTES: "solute", "solute concentration": "solute", "partition coefficient": "solute", "solute flux": "solute",
    "sbm concentration": "solid_bound", "sbm referential apparent density": "solid_bound",
}  # fmt: skip


# means over integration points of nodal fields
INTERPOLATED: dict[str, Nodal] = {
    "velocity": lambda r: r.state.velocity,
    "acceleration": lambda r: r.state.acceleration,
}


def interpolated(nodal: Floats, g: Group) -> Floats:
    """Element means of a nodal field (m, comp)."""
    return np.asarray(np.einsum("a,eac->ec", g.N.mean(axis=0), nodal[g.conn]))


# facet values of surfaces in contact, by what a contact calls them
SURFACE: dict[str, str] = {"contact gap": "gap", "contact pressure": "pressure", "contact traction": "traction"}


def on_surfaces(run: Run, name: str) -> dict[str, Floats]:
    """Facet values by the name of the surface, of all contacts that act."""
    out: dict[str, Floats] = {}
    for contact in run.system.contacts if run.system is not None else ():
        values = contact.on_facets(SURFACE[name], run.state)
        for surface, v in zip(contact.names, values or (), strict=False):
            out.setdefault(surface, v)
    return out


def domain(name: str) -> Domain:
    """Values of a domain variable for a group: kinematics, or what its physics offers."""
    return DOMAIN.get(name) or _item(lambda g: at_points(g, name))


def concentrations(run: Run, g: Group, nodes: NDArray[np.integer]) -> Floats | None:
    """Effective concentrations (node, solute of the model), zero where a group lacks one; None: it has none at all."""
    layout = run.state.layout
    all_solutes = [f.name for f in layout.fields if f.name.startswith("concentration")]
    if not any(n in g.fields for n in all_solutes):
        return None
    out = np.zeros((len(nodes), len(all_solutes)))
    for k, n in enumerate(all_solutes):
        if n in g.fields:
            out[:, k] = layout.scalar(run.state.d, n)[nodes]
    return out


def known(name: str, solutes: bool) -> bool:
    """A variable of some part of a model, with or without solutes? Physics that cannot be there are not loaded."""
    if name == SOLUTES:
        return True
    if any(name in t for t in (NODAL, DOMAIN, DOMAIN_NODAL, INTERPOLATED, SURFACE)):
        return True
    return any(name in physics.load(p).work.outputs for p in physics.FILES if solutes or p != "multiphasic")
