"""The sets of a model by name, and what may stand for one: a name, a selection, ids or a mask."""

from __future__ import annotations

from collections.abc import Iterator, MutableMapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from febkit.model import ElementSet, InputError, NodeSet, Surface

from .selection import Elements, Faces, Nodes

if TYPE_CHECKING:
    from .model import Model


class NodeSets(MutableMapping[str, Nodes]):
    """Node sets by name; values may be set as a selection, FEBio ids, or a mask over all nodes."""

    def __init__(self, model: Model) -> None:
        self._model = model

    def __getitem__(self, name: str) -> Nodes:
        mesh = self._model.record.mesh
        if name not in mesh.node_sets:
            raise KeyError(missing("node set", name, mesh.node_sets))
        return Nodes(mesh, mesh.node_sets[name].nodes)

    def __setitem__(self, name: str, given: Any) -> None:
        mesh = self._model.record.mesh
        new = NodeSet(name, node_index(self._model, given))
        self._model._put(mesh=replace(mesh, node_sets={**mesh.node_sets, name: new}))

    def __delitem__(self, name: str) -> None:
        mesh = self._model.record.mesh
        _ = self[name]
        self._model._put(mesh=replace(mesh, node_sets={k: v for k, v in mesh.node_sets.items() if k != name}))

    def __iter__(self) -> Iterator[str]:
        return iter(self._model.record.mesh.node_sets)

    def __len__(self) -> int:
        return len(self._model.record.mesh.node_sets)

    def __repr__(self) -> str:
        return _said((k, len(v.nodes)) for k, v in self._model.record.mesh.node_sets.items())

    def _ipython_key_completions_(self) -> list[str]:
        return list(self)


class Surfaces(MutableMapping[str, Faces]):
    """Surfaces by name; values may be set as a selection of faces, or facets by type (f, nodes) of FEBio ids."""

    def __init__(self, model: Model) -> None:
        self._model = model

    def __getitem__(self, name: str) -> Faces:
        mesh = self._model.record.mesh
        if name not in mesh.surfaces:
            raise KeyError(missing("surface", name, mesh.surfaces))
        return Faces(mesh, mesh.surfaces[name].facets)

    def __setitem__(self, name: str, given: Any) -> None:
        mesh = self._model.record.mesh
        if isinstance(given, Faces):
            facets = dict(given.facets)
        else:
            facets = {k: places(self._model, np.asarray(v)) for k, v in dict(given).items()}
        if not facets:
            raise InputError(f'the surface "{name}" would hold no facet')
        ids, first = {}, 1
        for kind, f in facets.items():
            ids[kind] = np.arange(first, first + len(f))
            first += len(f)
        self._model._put(mesh=replace(mesh, surfaces={**mesh.surfaces, name: Surface(name, facets, ids)}))

    def __delitem__(self, name: str) -> None:
        mesh = self._model.record.mesh
        _ = self[name]
        self._model._put(mesh=replace(mesh, surfaces={k: v for k, v in mesh.surfaces.items() if k != name}))

    def __iter__(self) -> Iterator[str]:
        return iter(self._model.record.mesh.surfaces)

    def __len__(self) -> int:
        return len(self._model.record.mesh.surfaces)

    def __repr__(self) -> str:
        return _said((k, sum(map(len, v.facets.values()))) for k, v in self._model.record.mesh.surfaces.items())

    def _ipython_key_completions_(self) -> list[str]:
        return list(self)


class ElementSets(MutableMapping[str, Elements]):
    """Element sets by name; values may be set as a selection or FEBio ids."""

    def __init__(self, model: Model) -> None:
        self._model = model

    def __getitem__(self, name: str) -> Elements:
        mesh = self._model.record.mesh
        if name not in mesh.element_sets:
            raise KeyError(missing("element set", name, mesh.element_sets))
        return Elements(mesh, mesh.element_sets[name].elements)

    def __setitem__(self, name: str, given: Any) -> None:
        mesh = self._model.record.mesh
        ids = given.ids if isinstance(given, Elements) else np.atleast_1d(np.asarray(given, dtype=np.int64))
        known = np.concatenate([b.ids for b in mesh.blocks]) if mesh.blocks else np.zeros(0, int)
        strange = ids[~np.isin(ids, known)]
        if len(strange):
            raise InputError(f'the element set "{name}" names element {strange[0]}, which the mesh does not have')
        self._model._put(mesh=replace(mesh, element_sets={**mesh.element_sets, name: ElementSet(name, ids)}))

    def __delitem__(self, name: str) -> None:
        mesh = self._model.record.mesh
        _ = self[name]
        self._model._put(mesh=replace(mesh, element_sets={k: v for k, v in mesh.element_sets.items() if k != name}))

    def __iter__(self) -> Iterator[str]:
        return iter(self._model.record.mesh.element_sets)

    def __len__(self) -> int:
        return len(self._model.record.mesh.element_sets)

    def __repr__(self) -> str:
        return _said((k, len(v.elements)) for k, v in self._model.record.mesh.element_sets.items())

    def _ipython_key_completions_(self) -> list[str]:
        return list(self)


def _said(sizes: Any) -> str:
    return ", ".join(f"{k} ({n})" for k, n in sizes) or "none"


def missing(what: str, name: str, known: Any) -> str:
    """There is no such name; what there is."""
    from difflib import get_close_matches  # where a name is wrong

    close = get_close_matches(str(name), list(known), 1, 0.6)
    hint = f'; did you mean "{close[0]}"?' if close else f"; there are {', '.join(known) or 'none'}"
    return f'there is no {what} "{name}"{hint}'


def places(model: Model, ids: Any) -> Any:
    """0-based nodes of FEBio ids of any shape. InputError where one is not in the mesh."""
    own = model.record.mesh.node_ids
    ids = np.asarray(ids)
    if ids.dtype.kind not in "iu":
        raise InputError("nodes are given by their ids, whole numbers")
    order = np.argsort(own)
    at = np.searchsorted(own[order], ids)
    at[at == len(own)] = 0
    found = order[at] if len(own) else np.zeros(ids.shape, int)
    if not len(own) or (own[found] != ids).any():
        strange = ids.ravel()[(own[found] != ids).ravel()][0] if len(own) else ids.ravel()[0]
        raise InputError(f"node {strange} is not in the mesh")
    return found


def node_index(model: Model, given: Any) -> Any:
    """0-based nodes of a selection, ids, or a mask over all nodes."""
    if isinstance(given, Faces):
        given = given.nodes
    if isinstance(given, Nodes):
        return given.index
    a = np.atleast_1d(np.asarray(given))
    if a.dtype == bool:
        if len(a) != len(model.record.mesh.X):
            raise InputError(f"a mask of {len(a)} for {len(model.record.mesh.X)} nodes")
        return np.flatnonzero(a)
    return places(model, a)


def node_reference(model: Model, given: Any) -> str:
    """The reference by which a condition names its nodes; a selection becomes a node set of its own."""
    mesh = model.record.mesh
    if isinstance(given, str):
        if given in mesh.node_sets or given.startswith("@"):
            return given
        if given in mesh.surfaces:
            return f"@surface:{given}"
        if any(b.name == given for b in mesh.blocks):
            model.node_sets[given] = model.nodes(part=given)
            return given
        if given == "all":
            model.node_sets["all"] = np.ones(len(mesh.X), dtype=bool)
            return "all"
        known = [*mesh.node_sets, *mesh.surfaces]
        raise InputError(missing("node set or surface", given, known))
    name = fresh("nodes", mesh.node_sets)
    model.node_sets[name] = given
    return name


def surface_reference(model: Model, given: Any) -> str:
    """The name of a surface; a selection of faces becomes a surface of its own."""
    mesh = model.record.mesh
    if isinstance(given, str):
        if given not in mesh.surfaces:
            raise InputError(missing("surface", given, mesh.surfaces))
        return given
    if not isinstance(given, Faces):
        raise InputError("a surface is given by its name or by m.faces(...)")
    name = fresh("surface", mesh.surfaces)
    model.surfaces[name] = given
    return name


def fresh(stem: str, known: Any) -> str:
    n = 1
    while f"{stem}_{n}" in known:
        n += 1
    return f"{stem}_{n}"
