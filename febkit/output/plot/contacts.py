"""What contacts say of their surfaces: of each facet, its nodes, or the whole.

A surface of several contacts has the values of the first, or of the one whose name stands in the brackets. Signs are
FEBio's: tractions of facets on facets, and forces of nodes on facets, are those on the other surface.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from febkit.solver.contact.facet_on_facet import FacetOnFacet
from febkit.solver.contact.node_on_facet import NodeOnFacet
from febkit.solver.contact.sliding_elastic import SlidingElastic, SlidingPoints
from febkit.solver.contact.sliding_friction import FrictionPoints
from febkit.solver.contact.tied_elastic import TiedElastic
from febkit.solver.contact.tied_node import TiedNode
from febkit.solver.fields import PRESSURE

from .base import Face, Floats, Give, register
from .surfaces import fluid_force

if TYPE_CHECKING:
    from febkit.solver.contact.base import Contact, Side

VECTORS = ("traction",)


def sides(face: Face, name: str = "") -> tuple[Contact, Side] | None:
    """The first contact that has a surface, and its side of it; of this ``name`` where one is given."""
    run, model = face.view.run, face.view.model
    acting = run.system.contacts if run.system is not None else []
    specs = [*model.common.contact, *(model.steps[run.index].contact if model.steps else ())]
    for contact, spec in zip(acting, specs, strict=False):
        for own, side in zip(contact.names, contact.sides, strict=False):
            if own == face.name and name in ("", spec.name):
                return None if contact.eroded else (contact, side)
    return None


def at_points(face: Face, what: str, name: str = "") -> tuple[Side, Floats] | None:
    """The "gap", "pressure" or "traction" at the points of a side, zero where it does not act or has none."""
    found = sides(face, name)
    if found is None:
        return None
    contact, side = found
    v = contact.values(side, what, face.state) if side in contact.passes else None
    return side, np.zeros((side.n, 3) if what in VECTORS else side.n) if v is None else v


def facets(what: str) -> Give:
    """Means over facets (facet, ...)."""

    def give(face: Face, name: str = "") -> Floats | None:
        found = at_points(face, what, name)
        return None if found is None else found[0].surface.means(found[1], found[0].nodal)

    return give


def to_nodes(face: Face, side: Side, v: Floats) -> Floats:
    """Values at the points of a side at the nodes of its facets (facet, width, ...)."""
    w = side.surface
    if side.nodal:
        inside = (w.local >= 0).reshape(*w.local.shape, *[1] * (v.ndim - 1))
        return np.where(inside, v[w.local], 0.0)[:, : face.width]
    if v.ndim == 1:
        return w.to_nodes(v)[:, : face.width]
    return np.stack([w.to_nodes(v[:, k])[:, : face.width] for k in range(v.shape[1])], axis=-1)


def nodes(what: str) -> Give:
    """At the nodes of facets (facet, node, ...)."""

    def give(face: Face) -> Floats | None:
        found = at_points(face, what)
        return None if found is None else to_nodes(face, *found)

    return give


def _slides_on_fluid(side: Side) -> bool:
    return isinstance(side, SlidingPoints) and hasattr(side, "passages")


def around(face: Face, side: Side, v: Floats) -> Floats:
    """At a node the mean over the facets around that bear a pressure."""
    pressure = at_points(face, "pressure")
    assert pressure is not None
    w, means = side.surface, side.surface.means(v, side.nodal)
    bears = w.means(pressure[1], side.nodal) > 0.0
    local = w.local[bears]
    inside = local >= 0
    count = np.bincount(local[inside], minlength=len(w.nodes))
    each = np.repeat(means[bears][:, None], local.shape[1], axis=1)[inside]
    total = np.zeros((len(w.nodes), *means.shape[1:]))
    np.add.at(total, local[inside], each)
    total /= np.maximum(count, 1).reshape(-1, *[1] * (means.ndim - 1))
    there = (w.local >= 0).reshape(*w.local.shape, *[1] * (means.ndim - 1))
    return np.where(there, total[w.local], 0.0)[:, : face.width]


def nodal_traction(face: Face) -> Floats | None:
    """Tractions at the nodes of facets; of facets on facets those on the surface itself, unlike the means.

    FEBio has means over facets in sliding contacts with fluid, and values of the points in others.
    """
    found, contact = at_points(face, "traction"), sides(face)
    if found is None or contact is None:
        return None
    if _slides_on_fluid(found[0]):
        return around(face, *found)
    turned = -1.0 if isinstance(contact[0], FacetOnFacet) and not isinstance(contact[0], NodeOnFacet) else 1.0
    return to_nodes(face, found[0], turned * found[1])


# ---- gaps as vectors ------------------------------------------------------------------------------------
def gaps(face: Face) -> tuple[Side, Floats] | None:
    """Vectors of gaps at the points (q, 3): how far what is tied, or sticks, is from where it should be."""
    found = sides(face)
    if found is None:
        return None
    contact, side = found
    own: Any = side
    acts = side in contact.passes
    if isinstance(contact, (TiedElastic, TiedNode)):
        return side, own.gap if acts else np.zeros((side.n, 3))
    if isinstance(contact, SlidingElastic):
        return side, own.dg if acts and hasattr(own, "dg") else np.zeros((side.n, 3))
    return None


def vector_gap(face: Face) -> Floats | None:
    found = gaps(face)
    return None if found is None else found[0].surface.means(found[1], found[0].nodal)


def nodal_vector_gap(face: Face) -> Floats | None:
    found = gaps(face)
    return None if found is None else to_nodes(face, *found)


# ---- how contact stands -----------------------------------------------------------------------------------
def stick(face: Face) -> Floats | None:
    """Fraction of the points of each facet that stick, of contacts that have friction."""
    found = sides(face)
    if found is None or not isinstance(found[0], SlidingElastic):
        return None
    contact, side = found
    sticks = getattr(side, "sticks", None) if side in contact.passes else None
    return side.surface.means(np.zeros(side.n) if sticks is None else sticks.astype(float), side.nodal)


def status(face: Face) -> Floats | None:
    """How many points of each facet have a partner; of facets on facets alone, as FEBio has it."""
    found = sides(face)
    if found is None or not isinstance(found[0], FacetOnFacet) or isinstance(found[0], NodeOnFacet):
        return None
    contact, side = found
    w = side.surface
    met = side.partner >= 0 if side in contact.passes else np.zeros(side.n, bool)
    return np.bincount(w.facet, met.astype(float), len(w.conn)).astype(float)


def penalty(face: Face) -> Floats | None:
    """What the penalty of a sliding contact multiplies: moduli of automatic penalties, else 1; not beside fluid."""
    found = sides(face)
    if found is None or isinstance(found[0], NodeOnFacet):
        return None
    contact, side = found
    if not isinstance(contact, (FacetOnFacet, SlidingElastic)) or _slides_on_fluid(side):
        return None
    return side.surface.means(side.modulus, side.nodal)


def friction(face: Face) -> Floats | None:
    """Tangential traction over pressure, averaged over facets, of contacts with fluid: what the fluid leaves of mu."""
    found = sides(face)
    if found is None or getattr(found[1], "passages", None) is None:
        return None
    contact, side = found
    mu = np.zeros(side.n)
    if side in contact.passes and isinstance(side, FrictionPoints):
        along = np.linalg.norm(side.t + side.p[:, None] * side.normals, axis=1)
        mu = np.divide(along, side.p, out=mu, where=side.p > 0)
    return side.surface.means(mu, side.nodal)


def areas(side: Side, x: Floats) -> Floats:
    """Present areas that the points of a surface stand for (q, 3), along their normals."""
    w = side.surface
    t = np.einsum("qad,qai->qdi", w.G, x[np.maximum(w.conn, 0)][w.facet])
    return np.cross(t[:, 0], t[:, 1]) * w.weight[:, None]


def pressed(face: Face, side: Side, v: Floats) -> Floats:
    """Nodal values of a side (m,), or values at its points, at the integration points of its facets (q,)."""
    w = side.surface
    return (w.N * np.where(w.local >= 0, v[w.local], 0.0)[w.facet]).sum(axis=1) if side.nodal else v


def area(face: Face) -> Floats | None:
    """Present area of the points that bear something (,); of tied nodes zero, as in FEBio."""
    acting = sides(face)
    if acting is None:
        return None
    tied = isinstance(acting[0], (TiedElastic, TiedNode))
    found = at_points(face, "traction" if tied else "pressure")
    assert found is not None
    side, v = found
    size = np.linalg.norm(areas(side, face.state.x), axis=1)
    if v.ndim > 1:
        bears = np.linalg.norm(v, axis=1) != 0.0
        return np.array(0.0 if side.nodal else size[bears].sum())
    return np.array(size[pressed(face, side, v) > 0.0].sum())


def force(face: Face) -> Floats | None:
    """Force of the contact on a surface (3,); of nodes on facets the pressure over the area of the reference."""
    found = sides(face)
    if found is None:
        return None
    contact, side = found
    s = face.state
    if isinstance(contact, NodeOnFacet):
        p = at_points(face, "pressure")
        assert p is not None
        n = areas(side, s.x)
        n /= np.linalg.norm(n, axis=1)[:, None]
        return (n * (pressed(face, side, p[1]) * side.surface.reference_weight)[:, None]).sum(axis=0)
    R, before = np.zeros_like(s.d), contact.snapshot()
    contact.residual(s, R)
    contact.restore(before)
    return s.layout.u(R)[side.surface.nodes].sum(axis=0)


# ---- fluid ----------------------------------------------------------------------------------------------
def pressure_gap(face: Face) -> Floats | None:
    """Difference of the fluid's pressures at the points, averaged over facets."""
    return step(face, PRESSURE.name)


def step(face: Face, field: str) -> Floats | None:
    """Difference at the points of a field that passes, averaged over facets; zero where it does not."""
    found = sides(face)
    passages = getattr(found[1], "passages", None) if found is not None else None
    if found is None or passages is None:
        return None
    contact, side = found
    own = [q for q in passages if q.field == field] if side in contact.passes else []
    return side.surface.means(own[0].step if own else np.zeros(side.n), side.nodal)


def of_fluid(face: Face) -> Floats | None:
    """Force of the fluid on a surface in contact (3,)."""
    found = sides(face)
    if found is None or getattr(found[1], "passages", None) is None:
        return None
    return fluid_force(face, face.state.layout.scalar(face.state.d, PRESSURE.name))


def supports(face: Face) -> tuple[Side, Floats] | None:
    """Fluid's share p / p_contact of the pressure at the points of sliding contacts, at most 1."""
    found = at_points(face, "pressure")
    if found is None or getattr(found[0], "passages", None) is None:
        return None
    side, pn = found
    w, p = side.surface, face.state.layout.scalar(face.state.d, PRESSURE.name)
    fluid = (w.N * p[np.maximum(w.conn, 0)][w.facet]).sum(axis=1)
    return side, np.minimum(np.divide(fluid, pn, out=np.zeros_like(pn), where=pn > 0), 1.0)


def local_support(face: Face) -> Floats | None:
    """Its mean over facets."""
    found = supports(face)
    return None if found is None else found[0].surface.means(found[1], False)


def support(face: Face) -> Floats | None:
    """Its mean over the area in contact (,)."""
    found, whole = supports(face), area(face)
    if found is None or whole is None:
        return None
    size = np.linalg.norm(areas(found[0], face.state.x), axis=1)
    return np.array((found[1] * size).sum() / whole if whole > 0 else 0.0)


register("contact gap", facets("gap"), more=True)
register("contact pressure", facets("pressure"), more=True)
register("contact traction", facets("traction"), more=True)
register("nodal contact gap", nodes("gap"))
register("nodal contact pressure", nodes("pressure"))
register("nodal contact traction", nodal_traction)
register("vector gap", vector_gap)
register("nodal vector gap", nodal_vector_gap)
register("contact stick", stick)
register("contact status", status)
register("contact penalty", penalty)
register("effective friction coefficient", friction)
register("contact area", area)
register("contact force", force)
register("pressure gap", pressure_gap)
register("fluid force", of_fluid)
register("local fluid load support", local_support)
register("fluid load support", support)
