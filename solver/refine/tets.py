"""Tetrahedra cut in eight, all of them (FEBio User Manual, "Mesh adaptor", tet_refine)."""

from __future__ import annotations

from typing import Any

import numpy as np

from .split import Floats, Split, children, padded
from .topology import Topology

EIGHTHS = np.array([
    (0, 4, 6, 7), (4, 1, 5, 8), (2, 6, 5, 9), (7, 8, 9, 3), (4, 8, 6, 7), (4, 8, 5, 6), (5, 6, 8, 9), (6, 7, 8, 9),
])  # fmt: skip


def eighths(top: Topology, X: Floats, *_: Any) -> Split:
    """Cut all elements; new nodes are the middles of the edges."""
    every = np.ones(len(top.conn), bool)
    edges = len(X) + np.arange(len(top.edges))
    conn, parent = children(top.conn, every, np.hstack([top.conn, edges[top.element_edges]]), EIGHTHS)
    faces = np.full(len(top.faces), -1)
    return Split(top, padded(top.edges), conn, parent, edges, faces, np.zeros(len(faces), bool), {})


def same(top: Topology, X: Floats, *_: Any) -> Split:
    """Cut nothing: elements begin anew, as FEBio's test_refine has it."""
    none = np.zeros((0, 8), np.int64)
    edges, faces = (np.full(len(q), -1) for q in (top.edges, top.faces))
    return Split(top, none, top.conn, np.arange(len(top.conn)), edges, faces, np.zeros(len(faces), bool), {})
