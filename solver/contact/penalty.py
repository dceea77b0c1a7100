"""FEBio's automatic penalty: the stiffness of the element behind a facet."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from ..fields import PRESSURE
from ..points import VOIGT, Points
from .surface import Floats, Ints, Surface

if TYPE_CHECKING:
    from ..group import Group
    from ..state import State


def automatic(surface: Surface, groups: list[Group]) -> Floats:
    """E_n A / V of each facet (f,), 0 where no element is known: E_n from the compliance along n of the tangent at rest
    (Young's modulus where n is an axis), A the facet's area and V the element's volume in the reference.

    FEBio User Manual, "auto_penalty".
    """
    out = _by_element(surface, groups, _modulus)
    for kind, rows in surface.kinds:
        if kind in surface.given.modulus:
            out[rows] += surface.given.modulus[kind]
    return out


def mixture(surface: Surface, groups: list[Group], state: State) -> Floats:
    """As :func:`automatic`, with the tangent of mixtures with solutes at the present state."""

    def law(g: Group, e: Ints, n: Floats) -> Floats:
        C = g.physics.mixture_tangent(e, state)
        return _modulus(g, e, n) if C is None else _along(C, n)

    return _by_element(surface, groups, law)


def conductance(surface: Surface, groups: list[Group], field: str) -> Floats:
    """n . k . n A / V of each facet (f,), 0 where the element does not have the nodal ``field``.

    k at rest is the permeability for the fluid's pressure, phi kappa_hat D for the concentration of a solute.
    """
    if field == PRESSURE.name:
        return _by_element(surface, groups, _permeability)

    def law(g: Group, e: Ints, n: Floats) -> Floats:
        k = g.physics.diffusivity(e, field)
        return np.zeros(len(e)) if k is None else np.asarray((_product(n) * k).sum(axis=1))

    return _by_element(surface, groups, law)


def _by_element(surface: Surface, groups: list[Group], law: Callable[[Group, Ints, Floats], Floats]) -> Floats:
    """``law`` (group, elements, normals) times A / V for the facets of known elements."""
    out = np.zeros(len(surface.conn))
    normals = _normals(surface)
    for kind, rows in surface.kinds:
        owner = surface.given.owner.get(kind)
        if owner is None:
            continue
        at = np.arange(rows.start, rows.stop)
        for block in np.unique(owner[:, 0][owner[:, 0] >= 0]):
            g, mine = groups[int(block)], owner[:, 0] == block
            e = owner[mine, 1]
            out[at[mine]] = law(g, e, normals[at[mine]]) * surface.area[at[mine]] / _volumes(g, e, surface.X)
    return out


def _volumes(g: Group, e: Ints, X: Floats) -> Floats:
    """Reference volumes of elements e; FEBio counts a shell's here as if its front face were its middle."""
    if not g.shell:
        return np.asarray(g.wJ0[e].sum(axis=1))
    x = X[g.conn[e]]
    back, front = np.split(x, 2, axis=1)
    J = np.einsum("gaj,eai->egij", g.dN, x + np.tile(0.5 * (front - back), (1, 2, 1)))
    return np.asarray(np.linalg.det(J) @ g.element.weights)


def _normals(surface: Surface) -> Floats:
    """Reference normals (f, 3) at the middle of natural coordinates (0, 0), where FEBio takes them."""
    from .. import elements

    out = np.zeros((len(surface.conn), 3))
    for kind, rows in surface.kinds:
        e = elements.get(kind)
        G = e.gradient(np.zeros((1, 2)))[0]
        t = np.einsum("aj,fai->fji", G, surface.X[surface.conn[rows, : e.nodes]])
        n = np.cross(t[:, 0], t[:, 1])
        out[rows] = n / np.linalg.norm(n, axis=1)[:, None]
    return out


def _at_rest(g: Group, e: Ints) -> Points:
    """The first points of elements e, undeformed."""
    m, first = len(e), e * g.g
    pts = Points(np.tile(np.eye(3), (m, 1, 1)), np.ones(m), g.Xg[first], e)
    Q = g._axes()
    pts.Q = None if Q is None else np.ascontiguousarray(Q[first])
    pts.old, pts.new = g.old[first].copy(), g.new[first].copy()
    return pts


def _product(n: Floats) -> Floats:
    """n x n (m, 6), off-diagonal terms doubled."""
    return np.stack([n[:, i] * n[:, k] * (1.0 if i == k else 2.0) for i, k in VOIGT], axis=1)


def _modulus(g: Group, e: Ints, n: Floats) -> Floats:
    """Young's modulus along n (m, 3) of elements e."""
    s, C = np.zeros((len(e), 6)), np.zeros((len(e), 6, 6))
    g.block.solid.stress(_at_rest(g, e), s, C)
    return _along(C, n)


def _along(C: Floats, n: Floats) -> Floats:
    """Young's modulus along n (m, 3) of tangents C (m, 6, 6)."""
    # FEBio 4.11 takes the inverse of the 6 x 6 matrix for the compliance tensor, so that its shears count four times;
    # this tells where a facet is oblique to the axes
    v = _product(n)
    return np.asarray(1.0 / (v * np.linalg.solve(C, v[:, :, None])[:, :, 0]).sum(axis=1))


def _permeability(g: Group, e: Ints, n: Floats) -> Floats:
    """n . k . n of elements e."""
    k = g.physics.permeability(_at_rest(g, e))
    return np.zeros(len(e)) if k is None else np.asarray((_product(n) * k).sum(axis=1))
