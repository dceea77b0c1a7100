"""What a reference to a set means: ``"top"``, ``"@surface:top"``, ``"@edge:rim"``, ``"@elem_set:core"``, ...

FEBio looks for a set of the name after the prefix, then makes one of the nodes of the surface, edge,
element set or part list (FEBio 4.11, FEModelBuilder::FindNodeSet).
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from .mesh import Ints, Mesh
from .source import InputError, Where


def _first_seen(parts: Iterable[Ints]) -> Ints:
    flat = [np.asarray(p).reshape(-1) for p in parts]
    if not flat:
        return np.zeros(0, np.int64)
    every = np.concatenate(flat)
    _, first = np.unique(every, return_index=True)
    return every[np.sort(first)]


def _missing(what: str, name: str, where: Where | None) -> InputError:
    return InputError(f'there is no {what} "{name}"', where)


def node_indices(mesh: Mesh, ref: str, where: Where | None = None) -> Ints:
    """0-based nodes of a node set or of ``@surface:``, ``@edge:``, ``@elem_set:``, ``@part_list:`` name."""
    prefix, colon, name = ref.partition(":")
    if not (colon and prefix.startswith("@")):
        if ref in mesh.node_sets:
            return mesh.node_sets[ref].nodes
        if ref in mesh.node_blocks:
            return mesh.node_blocks[ref]
        raise _missing("node set", ref, where)
    if name in mesh.node_sets and prefix != "@part_list":
        return mesh.node_sets[name].nodes
    if prefix == "@surface":
        if name not in mesh.surfaces:
            raise _missing("surface", name, where)
        return _first_seen(mesh.surfaces[name].facets.values())
    if prefix == "@edge":
        if name not in mesh.edges:
            raise _missing("edge", name, where)
        return _first_seen([mesh.edges[name].lines])
    if prefix in ("@elem_set", "@part_list"):
        ids = element_ids(mesh, ref if prefix == "@part_list" else name, where)
        return _first_seen(b.conn[np.isin(b.ids, ids)] for b in mesh.blocks)
    raise InputError(f'"{ref}": {prefix} is no kind of set', where)


def element_ids(mesh: Mesh, ref: str, where: Where | None = None) -> Ints:
    """Element ids of an element set, of a part by name, or of ``@part_list:`` name."""
    prefix, colon, name = ref.partition(":")
    if colon and prefix == "@part_list":
        if name not in mesh.part_lists:
            raise _missing("part list", name, where)
        parts = [element_ids(mesh, p, where) for p in mesh.part_lists[name]]
        return np.concatenate(parts) if parts else np.zeros(0, np.int64)
    name = name if colon and prefix == "@elem_set" else ref
    if name in mesh.element_sets:
        return mesh.element_sets[name].elements
    for b in mesh.blocks:
        if b.name == name:
            return b.ids
    raise _missing("element set", name, where)
