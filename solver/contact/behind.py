"""What the elements behind the facets of a side bear: the part of the fluid, and tractions of their stress."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from .. import elements
from ..fields import PRESSURE
from ..multiphasic.voigt import full
from .surface import Floats, Ints

if TYPE_CHECKING:
    from ..elements.base import Element
    from ..group import Group
    from ..state import State
    from .base import Side


def _solids(s: Side, groups: list[Group]) -> Iterator[tuple[Element, Group, Ints, Ints, Ints]]:
    """Facets in front of the solid elements of a group, by type: (type, group, elements, facets, points (f, g))."""
    w = s.surface
    for kind, rows in w.kinds:
        e, facets = elements.get(kind, w.given.rules.get(kind)), np.arange(rows.start, rows.stop)
        at = np.flatnonzero(np.isin(w.facet, facets)).reshape(len(facets), e.npoints)
        owner = w.given.owner.get(kind, np.full((len(facets), 2), -1))
        for block in np.unique(owner[:, 0][owner[:, 0] >= 0]):
            mine, g = owner[:, 0] == block, groups[int(block)]
            if not g.shell:  # which FEBio passes over
                yield e, g, owner[mine, 1], facets[mine], at[mine]


def _stress(g: Group, e: Ints) -> Floats:
    """Stress of the whole (k, g, 6) in elements e."""
    stress = g.physics.outputs["stress"](g.physics)
    assert stress is not None
    return stress[e]


def load_support(s: Side, groups: list[Group], state: State, around: float) -> Floats:
    """-p / (n . s . n) at the points (q,), from the means of pressure and stress in the elements behind their facets.

    p is the pressure above that ``around``; 0 where no element with a stress is behind. As in FEBio the normals of a
    facet's first points count as those of its nodes, between whose values the shape functions go.
    """
    out = np.zeros(s.n)
    for e, g, behind, _, at in _solids(s, groups):
        p = np.zeros(len(behind))
        if PRESSURE.name in g.fields:
            p = state.layout.scalar(state.d, PRESSURE.name)[g.conn[behind]] @ g.N.mean(axis=0)
        normals = s.normals[at][:, : e.nodes]
        tn = np.einsum("fai,fij,faj->fa", normals, full(_stress(g, behind).mean(axis=1)), normals)
        out[at] = np.divide(around - p[:, None], tn, out=np.zeros_like(tn), where=tn != 0.0) @ e.N.T
    return out


def tractions(s: Side, groups: list[Group]) -> Floats:
    """s . n at the points (q, 3), of stresses that go from the points of the elements behind to the facets' nodes.

    0 where no element with a stress is behind; for the normals see :func:`load_support`.
    """
    out = np.zeros((s.n, 3))
    for e, g, behind, facets, at in _solids(s, groups):
        corners = s.surface.conn[facets, : e.nodes]
        local = (g.conn[behind][:, None, :] == corners[:, :, None]).argmax(axis=2)
        nodal = np.einsum("ng,egc->enc", g.element.extrapolation, _stress(g, behind))
        stress = full(np.take_along_axis(nodal, local[:, :, None], axis=1))
        out[at] = np.einsum("ga,faij,faj->fgi", e.N, stress, s.normals[at][:, : e.nodes])
    return out
