"""Hexahedra cut in eight, or in four within the XY plane (FEBio User Manual, "Mesh adaptor", hex_refine, hex_refine2d).

Nodes on edges and faces of elements that stay whole hang: they are the means of the corners there. An element with a
hanging node is not cut, so that no node hangs on one that hangs.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ..group import Impossible
from .split import Floats, Hanging, Ints, Split, children, padded
from .topology import Topology

EIGHTHS = np.array([
    (0, 8, 24, 11, 16, 20, 26, 23), (8, 1, 9, 24, 20, 17, 21, 26), (11, 24, 10, 3, 23, 26, 22, 19),
    (24, 9, 2, 10, 26, 21, 18, 22), (16, 20, 26, 23, 4, 12, 25, 15), (20, 17, 21, 26, 12, 5, 13, 25),
    (23, 26, 22, 19, 15, 25, 14, 7), (26, 21, 18, 22, 25, 13, 6, 14),
])  # fmt: skip
QUARTERS = np.array([
    (0, 8, 16, 11, 4, 12, 17, 15), (8, 1, 9, 16, 12, 5, 13, 17), (11, 16, 10, 3, 15, 17, 14, 7),
    (16, 9, 2, 10, 17, 13, 6, 14),
])  # fmt: skip
FLAT = 0.999  # z of the unit normal of faces that count as lying in the XY plane
NEAR = {"hex8": 1e-6, "flat": 1e-9**0.5}  # how near a node must be to be the one that is wanted, as FEBio has it
PART = 1e-3  # and of the edge at most, where elements are small


def eighths(top: Topology, X: Floats, chosen: NDArray[np.bool_], hanging: Hanging, most: int = 0) -> Split | None:
    """Cut the elements ``chosen`` (m,) in eight, ``most`` of them (0: all); None where there are none to cut."""
    chosen = whole(top, chosen, hanging)
    if most > 0:
        chosen[np.flatnonzero(chosen)[most:]] = False
    if not chosen.any():
        return None
    faces = np.zeros(len(top.faces), bool)
    faces[top.element_faces[chosen]] = True
    edges = np.zeros(len(top.edges), bool)
    edges[top.face_edges[faces]] = True
    parts = [(edges, top.edges), (faces, top.faces), (chosen, top.conn)]
    (at_edge, at_face, at_element), masters = _place(X, parts, [2, 1, 0], NEAR["hex8"])
    bare = np.zeros(len(top.edges), bool)  # edges of what stays whole
    bare[top.face_edges[at_face < 0]] = True
    bare[top.element_edges[~chosen]] = True
    held = np.zeros(len(top.faces), bool)
    held[top.element_faces[~chosen]] = True
    left = _left(hanging, at_edge, at_face, at_element)
    left |= _hang(top.edges, at_edge, bare) | _hang(top.faces, at_face, held)
    table = np.hstack([top.conn, at_edge[top.element_edges], at_face[top.element_faces], at_element[:, None]])
    conn, parent = children(top.conn, chosen, table, EIGHTHS)
    return Split(top, masters, conn, parent, at_edge, at_face, np.zeros(len(at_face), bool), left)


def quarters(top: Topology, X: Floats, chosen: NDArray[np.bool_], hanging: Hanging, most: int = 0) -> Split | None:
    """Cut the elements ``chosen`` (m,) in four along Z; None where there are none to cut, or more than ``most`` (as in
    FEBio).

    Faces beside them are halved; for each FEBio makes a node that nothing has. Raises Impossible.
    """
    chosen = whole(top, chosen, hanging)
    if not chosen.any() or 0 < most < chosen.sum():
        return None
    level = _level(top, X)
    if not level[top.element_faces[chosen][:, 4:]].all() or level[top.element_faces[chosen][:, :4]].any():
        raise Impossible("hex_refine2d takes elements whose first and last four nodes lie in planes of constant Z")
    near = np.zeros(len(top.faces), bool)
    near[top.element_faces[chosen]] = True
    faces, halved = near & level, near & ~level
    edges = np.zeros(len(top.edges), bool)
    edges[top.face_edges[faces]] = True
    parts = [(edges, top.edges), (faces, top.faces)]
    (at_edge, at_face), masters = _place(X, parts, [1, 0], NEAR["flat"])
    bare = np.zeros(len(top.edges), bool)
    bare[top.face_edges[~near]] = True
    left = _left(hanging, at_edge, at_face) | _hang(top.edges, at_edge, bare)
    table = np.hstack([top.conn, at_edge[top.element_edges[:, :8]], at_face[top.element_faces[:, 4:]]])
    conn, parent = children(top.conn, chosen, table, QUARTERS)
    masters = np.concatenate([masters, np.full((int(halved.sum()), 8), -1)])
    return Split(top, masters, conn, parent, at_edge, at_face, halved, left)


def whole(top: Topology, chosen: NDArray[np.bool_], hanging: Hanging) -> NDArray[np.bool_]:
    """Those of the elements ``chosen`` that have no hanging node."""
    hangs = np.zeros(top.nodes, bool)
    hangs[list(hanging)] = True
    return np.asarray(chosen & ~hangs[top.conn].any(axis=1))


def _level(top: Topology, X: Floats) -> NDArray[np.bool_]:
    """Do faces lie in the XY plane?"""
    a, b, c = (X[top.faces[:, k]] for k in range(3))
    n = np.cross(b - a, c - a)
    return np.asarray(np.abs(n[:, 2]) >= FLAT * np.linalg.norm(n, axis=1))


def _place(
    X: Floats, parts: list[tuple[NDArray[np.bool_], Ints]], order: list[int], near: float
) -> tuple[list[Ints], Ints]:
    """The node in the middle of each thing that is cut, -1 of others, and the masters of those that are new.

    ``parts``: what is cut, and the nodes of each. A node that is there already, since an element beside was cut
    earlier, is taken; new ones are numbered in FEBio's order: ``order`` where all are new, else that of ``parts``.
    """
    tree, at, new = cKDTree(X), [], []
    for cut, nodes in parts:
        here = X[nodes[cut]]
        size = np.linalg.norm(here[:, 1] - here[:, 0], axis=1)
        middle = sum(here[:, k] for k in range(nodes.shape[1])) / nodes.shape[1]
        found = tree.query_ball_point(middle, np.minimum(near, PART * size))
        node = np.full(len(cut), -1)
        node[cut] = [min(q, default=-1) for q in found]
        at.append(node)
        new.append(np.flatnonzero(cut & (node < 0)))
    if any(len(k) < cut.sum() for k, (cut, _) in zip(new, parts)):
        order = list(range(len(parts)))
    n = len(X)
    for k in order:
        at[k][new[k]] = n + np.arange(len(new[k]))
        n += len(new[k])
    return at, padded(*(parts[k][1][new[k]] for k in order))


def _left(hanging: Hanging, *at: Ints) -> Hanging:
    """What hung and was not met again."""
    met = set(np.concatenate(at).tolist())
    return {node: masters for node, masters in hanging.items() if node not in met}


def _hang(corners: Ints, at: Ints, bare: NDArray[np.bool_]) -> Hanging:
    rows = np.flatnonzero(bare & (at >= 0))
    return {int(at[k]): tuple(corners[k].tolist()) for k in rows}
