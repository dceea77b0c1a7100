"""FEBio's nodal integration of facets: a facet's nodes are its points."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from . import get
from .base import Element

RULE = "nodal"
# weights; those of quad8 are as FEBio 4.11 has them (its corners carry all)
WEIGHTS = {
    "tri3": (1 / 6,) * 3, "quad4": (1.0,) * 4, "tri6": (0.0,) * 3 + (1 / 6,) * 3, "quad8": (4 / 9,) * 4 + (0.0,) * 4,
}  # fmt: skip


def areas(kind: str, X: NDArray[np.float64]) -> NDArray[np.float64]:
    """Areas (f, n) that count for the nodes of facets of a kind in WEIGHTS, at positions X (f, n, 3)."""
    e = get(kind)
    t = np.einsum("gaj,fai->fgji", e.gradient(e.natural), X)
    return np.asarray(np.linalg.norm(np.cross(t[:, :, 0], t[:, :, 1]), axis=2) * np.array(WEIGHTS[kind]))


def element(kind: str) -> Element:
    """The facet with its nodes for points. Raises KeyError where its kind is not in WEIGHTS."""
    weights, e = np.array(WEIGHTS[kind]), get(kind)
    r, one = e.natural.copy(), np.eye(len(weights))
    return replace(e, rule=RULE, points=r, weights=weights, N=one, dN=e.gradient(r), extrapolation=one)


__all__ = ["WEIGHTS", "areas", "element"]
