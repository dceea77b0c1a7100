"""What a reference to a set means: ``"top"``, ``"@surface:top"``, ``"@edge:rim"``, ``"@elem_set:core"``, ...

FEBio looks for a set of the name after the prefix, then makes one of the nodes of the surface, edge,
element set or part list (FEBio 4.11, FEModelBuilder::FindNodeSet).
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from .mesh import Ints, Mesh, Surface
from .model import MeshData
from .source import InputError, Where
from .values import near


def _first_seen(parts: Iterable[Ints]) -> Ints:
    flat = [np.asarray(p).reshape(-1) for p in parts]
    if not flat:
        return np.zeros(0, np.int64)
    every = np.concatenate(flat)
    _, first = np.unique(every, return_index=True)
    return every[np.sort(first)]


def missing(what: str, name: str, known: Iterable[str], where: Where | None) -> InputError:
    """The error for a name that nothing has, with the nearest one that something has."""
    return InputError(f'there is no {what} "{name}"{near(name, known)}', where)


def node_indices(mesh: Mesh, ref: str, where: Where | None = None) -> Ints:
    """0-based nodes of a node set or of ``@surface:``, ``@edge:``, ``@elem_set:``, ``@part_list:`` name."""
    prefix, colon, name = ref.partition(":")
    if not (colon and prefix.startswith("@")):
        if ref in mesh.node_sets:
            return mesh.node_sets[ref].nodes
        if ref in mesh.node_blocks:
            return mesh.node_blocks[ref]
        raise missing("node set", ref, [*mesh.node_sets, *mesh.node_blocks], where)
    if name in mesh.node_sets and prefix != "@part_list":
        return mesh.node_sets[name].nodes
    if prefix == "@surface":
        return _first_seen(surface(mesh, name, where).facets.values())
    if prefix == "@edge":
        if name not in mesh.edges:
            raise missing("edge", name, mesh.edges, where)
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
            raise missing("part list", name, mesh.part_lists, where)
        parts = [element_ids(mesh, p, where) for p in mesh.part_lists[name]]
        return np.concatenate(parts) if parts else np.zeros(0, np.int64)
    name = name if colon and prefix == "@elem_set" else ref
    if name in mesh.element_sets:
        return mesh.element_sets[name].elements
    for b in mesh.blocks:
        if b.name == name:
            return b.ids
    raise missing("element set", name, [*mesh.element_sets, *(b.name for b in mesh.blocks)], where)


def surface(mesh: Mesh, name: str, where: Where | None = None) -> Surface:
    """The surface of this name."""
    if name not in mesh.surfaces:
        raise missing("surface", name, mesh.surfaces, where)
    return mesh.surfaces[name]


def map_items(mesh: Mesh, data: MeshData) -> Ints:
    """0-based places, in the set a map lives on, of the rows that it gives (its ``lid``)."""
    if data.kind == "node":
        size = len(node_indices(mesh, data.set, data.where))
    elif data.kind == "element":
        size = len(element_ids(mesh, data.set, data.where))
    else:
        size = sum(map(len, surface(mesh, data.set, data.where).facets.values()))
    items = np.zeros(0, np.int64) if data.items is None else np.asarray(data.items, np.int64)
    outside = (items < 1) | (items > size)
    if outside.any():
        bad = items[outside][0]
        raise InputError(f'map "{data.name}": row lid={bad} lies outside "{data.set}", which has {size}', data.where)
    return items - 1
