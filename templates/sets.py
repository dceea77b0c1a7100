"""Names for what a model refers to: faces of the cube, outer surface, surfaces of the cells."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from febkit.model import ElementBlock, ElementSet, Mesh, NodeSet, Surface
from febkit.model.mesh import Floats, Ints

from .facets import Facets, between_parts, select
from .parts import Parts, body

# name: axis, and whether it is the far side
FACES = {"left": (0, 0), "right": (0, 1), "front": (1, 0), "back": (1, 1), "bottom": (2, 0), "top": (2, 1)}
# node sets made of faces; edges belong to both
FACE_NODES = {"x_faces": ("left", "right"), "y_faces": ("front", "back"), "bottom": ("bottom",),
              "top": ("top",)}
PART_LISTS = {"cells": "cell_", "pcms": "pcm_", "membranes": "membrane_"}


def named_mesh(made: Parts) -> Mesh:
    """The model's mesh, ids from 1 in order of the parts.

    Surfaces: the six faces (of a body whose outer surface lies in the planes of its bounding box),
    ``outer``; for each cell ``cell_i_surface`` out of the cell, for each PCM ``pcm_i_surface`` into
    the ECM, ``cell_cube`` between ECM and tissue. Node sets: ``x_faces``, ``y_faces``, ``bottom``,
    ``top``, ``outer``. Part lists: ``cells``, ``pcms``, ``membranes``. Element sets: bodies with elements of several
    types.
    """
    names = list(made.parts)
    facets = between_parts(list(made.parts.values()), len(made.X))
    every = np.arange(len(names))
    surfaces = _faces(made.X, select(facets, every)) | {"outer": select(facets, every)}
    surfaces |= _interfaces(names, facets)
    node_sets = {name: _nodes([surfaces[f] for f in faces if f in surfaces])
                 for name, faces in FACE_NODES.items()}
    node_sets["outer"] = _nodes([surfaces["outer"]])
    lists = {k: tuple(n for n in (*names, *made.shells) if n.startswith(prefix)) for k, prefix in PART_LISTS.items()}
    blocks = _blocks(made)
    return Mesh(
        node_ids=np.arange(1, len(made.X) + 1), X=made.X, blocks=blocks,
        node_sets={k: NodeSet(k, v) for k, v in node_sets.items() if len(v)},
        surfaces={k: _surface(k, v) for k, v in surfaces.items() if v},
        element_sets={k: ElementSet(k, np.concatenate([blocks[i].ids for i in own]))
                      for k, own in bodies(names).items() if len(own) > 1},
        part_lists={k: v for k, v in lists.items() if v},
        node_blocks={"nodes": np.arange(len(made.X))},
    )


def _blocks(made: Parts) -> tuple[ElementBlock, ...]:
    blocks, first = [], 1
    for name, (kind, conn) in (*made.parts.items(), *made.shells.items()):
        blocks.append(ElementBlock(name, kind, np.arange(first, first + len(conn)), conn))
        first += len(conn)
    return tuple(blocks)


def _surface(name: str, facets: dict[str, Ints]) -> Surface:
    ids, first = {}, 1
    for kind, conn in facets.items():
        ids[kind] = np.arange(first, first + len(conn))
        first += len(conn)
    return Surface(name, facets, ids)


def _faces(X: Floats, outer: dict[str, Ints]) -> dict[str, dict[str, Ints]]:
    """The outer facets in each plane of the bounding box; {} where some lie in none of the planes."""
    low, high = X.min(axis=0), X.max(axis=0)
    tol = 1e-6 * float((high - low).max())
    faces: dict[str, dict[str, Ints]] = {}
    seen = dict.fromkeys(outer, 0)
    for name, (axis, far) in FACES.items():
        plane = (high if far else low)[axis]
        for kind, conn in outer.items():
            on = (np.abs(X[conn, axis] - plane) < tol).all(axis=1)
            seen[kind] += int(on.sum())
            if on.any():
                faces.setdefault(name, {})[kind] = conn[on]
    return faces if all(seen[k] == len(conn) for k, conn in outer.items()) else {}


def _interfaces(names: list[str], facets: list[Facets]) -> dict[str, dict[str, Ints]]:
    """Surfaces of the cells (out of the cell), of the PCM (into what surrounds it), of the cell cube."""
    found = {}
    for name, own in bodies(names).items():
        role = name.partition("_")[0]
        if role == "cell":
            found[f"{name}_surface"] = select(facets, np.array(own))
        elif role == "pcm":
            beside = np.unique(np.concatenate([f.outside[np.isin(f.inside, own)] for f in facets])).tolist()
            within = own + [k for k in beside if k >= 0 and names[k].startswith("cell")]
            found[f"{name}_surface"] = select(facets, np.array(within))
    if "tissue" in bodies(names) and len(names) > 1:
        found["cell_cube"] = select(facets, np.array([i for i, n in enumerate(names) if body(n) != "tissue"]))
    return found


def bodies(names: Sequence[str]) -> dict[str, list[int]]:
    """Numbers of the parts of each body."""
    out: dict[str, list[int]] = {}
    for i, name in enumerate(names):
        out.setdefault(body(name), []).append(i)
    return out


def _nodes(surfaces: list[dict[str, Ints]]) -> Ints:
    """Sorted nodes of several surfaces."""
    flat = [conn.ravel() for s in surfaces for conn in s.values()]
    return np.unique(np.concatenate(flat)) if flat else np.empty(0, dtype=np.int64)


def membranes(made: Parts) -> dict[str, tuple[str, Ints]]:
    """Shells ``membrane_i`` on the surface of each cell, front outwards; one for each type of facet, if several."""
    facets = between_parts(list(made.parts.values()), len(made.X))
    found = {}
    for name, own in bodies(list(made.parts)).items():
        role, _, which = name.partition("_")
        if role == "cell":
            surface = select(facets, np.array(own))
            for kind, conn in surface.items():
                found[f"membrane_{which}" + (f"_{kind}" if len(surface) > 1 else "")] = (kind, conn)
    return found
