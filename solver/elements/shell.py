"""Shells as solids: a facet's functions times linear functions through the thickness.

A shell element of n nodes is a solid element of 2n: first the n nodes of its bottom (back) face, t = -1,
then the n of its top (front) face, t = 1. FEBio's solid-shell formulation, with a displacement of the front
face and one of the back face at each node, is this element; see Hou et al., Shell elements with
displacements on both faces, J. Biomech. Eng. 140 (2018) 121001.
"""

from __future__ import annotations

from . import shape
from .base import Shape


def thick(facet: str, order: int, center: tuple[float, float], rules: dict[str, str]) -> Shape:
    """The shell over the facet element of this name."""
    base = shape(facet)
    n = len(base.nodes)
    nodes = tuple((*r, t) for t in (-1.0, 1.0) for r in base.nodes)
    through = " ".join("t" if word == "1" else f"{word}t" for word in base.span.split())
    corners, middles = [*range(base.corners)][::-1], [*range(base.corners, n)][::-1]
    bottom = (*corners, *middles[1:], *middles[:1])  # the edge from the first to the last corner comes last
    return Shape(
        name=f"shell_{facet}", dim=3, order=order, corners=2 * base.corners, nodes=nodes,
        span=f"{base.span} {through}", rules=rules, center=(*center, 0.0),
        facets=((facet, tuple(range(n, 2 * n))), (facet, bottom)),
    )
