"""Plot variables of a run: FEBio's name -> values, per node, element or domain.

A nodal field returns (node[, comp]); a domain field one array per group, or None where a group has none.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from febkit.solver.group import Group
    from febkit.solver.run import Run

Floats = NDArray[np.float64]
Nodal = Callable[["Run"], Floats]
Domain = Callable[["Group"], "Floats | None"]

VOIGT = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))


def voigt(T: Floats) -> Floats:
    """Symmetric tensors (..., 3, 3) as (..., 6): xx yy zz xy yz xz."""
    return np.stack([T[..., i, j] for i, j in VOIGT], axis=-1)


def _mean(values: Floats) -> Floats:
    """Mean over integration points (element, point, ...), as FEBio writes element data."""
    return values.mean(axis=1)


# ---- integration points -----------------------------------------------------------------------------
def point_stress(g: Group) -> Floats:
    """Cauchy stress (m, g, 6): total in a mixture (solid - p I)."""
    if g.block.mixture is None:
        return g.s
    s = g.s.copy()
    s[..., :3] -= g.pg[..., None]
    return s


def point_strain(g: Group) -> Floats:
    """Green-Lagrange strain (m, g, 6), E = (F^T F - I) / 2."""
    C = np.einsum("egki,egkj->egij", g.F, g.F)
    return voigt(0.5 * (C - np.eye(3)))


def _stretch(g: Group, left: bool, function: Callable[[Floats], Floats]) -> Floats:
    F = g.F
    A = np.einsum("egik,egjk->egij", F, F) if left else np.einsum("egki,egkj->egij", F, F)
    w, v = np.linalg.eigh(A)
    return voigt(np.einsum("egik,egk,egjk->egij", v, function(np.sqrt(w)), v))


def _energy(g: Group) -> Floats | None:
    try:
        W = g.block.solid.energy(g.points())
    except NotImplementedError:
        return None
    if g.block.formulation == "three-field":
        law = g.block.solid
        pts = g.points()
        W = law.dev_energy(pts) + law.volumetric(np.repeat(g.eJ, g.g), pts)  # type: ignore[attr-defined]
    return np.broadcast_to(W, (g.m * g.g,)).reshape(g.m, g.g)


def _density(g: Group) -> Floats:
    rho = np.broadcast_to(g.block.solid.density(g.points()), (g.m * g.g,)).reshape(g.m, g.g)
    return rho / g.J


def _solid_fraction(g: Group) -> Floats | None:
    if g.block.mixture is None:
        return None
    pts = g.points()
    return np.broadcast_to(g.block.mixture.phi0(pts.t, pts.X, pts.e), (g.m * g.g,)).reshape(g.m, g.g)


def _porosity(g: Group) -> Floats | None:
    phi = _solid_fraction(g)
    return None if phi is None else np.maximum(1.0 - phi / g.J, 0.0)


def _load_support(g: Group) -> Floats | None:
    """Interstitial fluid load support -p / sigma_n of the mean stress: here -3 p / tr sigma."""
    if g.block.mixture is None:
        return None
    trace = point_stress(g)[..., :3].sum(axis=-1)
    return np.divide(-3.0 * g.pg, trace, out=np.zeros_like(trace), where=trace != 0)


def _fluid(name: str) -> Domain:
    return lambda g: None if g.block.mixture is None else _mean(getattr(g, name))


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


def _pk1(g: Group) -> Floats:
    """First Piola-Kirchhoff stress J sigma F^-T (m, g, 9)."""
    s = point_stress(g)[..., [0, 3, 5, 3, 1, 4, 5, 4, 2]].reshape(g.m, g.g, 3, 3)
    P = g.J[..., None, None] * np.einsum("egik,egjk->egij", s, np.linalg.inv(g.F))
    return P.reshape(g.m, g.g, 9)


def _shell(g: Group) -> bool:
    return g.block.element.startswith("shell_")


NODAL: dict[str, Nodal] = {
    "displacement": lambda r: r.state.u,
    "nodal velocity": lambda r: r.state.velocity,
    "nodal acceleration": lambda r: r.state.acceleration,
    "reaction forces": lambda r: r.state.reaction,
}

DOMAIN: dict[str, Domain] = {
    "stress": _item(point_stress),
    "solid stress": _item(lambda g: g.s),
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
    "strain energy density": _item(_energy),
    "specific strain energy": _item(
        lambda g: None if _energy(g) is None else _energy(g) / (_density(g) * g.J)  # type: ignore[operator]
    ),
    "fluid pressure": _fluid("pg"),
    "fluid flux": _fluid("w"),
    "fluid load support": _item(_load_support),
    "porosity": _item(_porosity),
    "referential solid volume fraction": _item(_solid_fraction),
    "nodal stress": lambda g: None if _shell(g) else _nodes(point_stress(g), g),
    "nodal strain": lambda g: None if _shell(g) else _nodes(point_strain(g), g),
    "nodal fluid flux": lambda g: None if g.block.mixture is None else _nodes(g.w, g),
}

# per-domain nodal fields: values over all nodes, written for the groups that have them
DOMAIN_NODAL: dict[str, tuple[Nodal, Callable[[Group], bool]]] = {
    "effective fluid pressure": (lambda r: r.state.d[:, 3], lambda g: g.block.mixture is not None),
}


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


def known(name: str) -> bool:
    return any(name in t for t in (NODAL, DOMAIN, DOMAIN_NODAL, INTERPOLATED, SURFACE))
