"""What a plotfile holds: mesh, domains, surfaces and the dictionary of variables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from febkit.record import record, value_record

from . import tags

Ints = NDArray[np.integer]


@record
class PlotDomain:
    """Elements of one type and material. ``conn`` (element, local) holds 0-based node indices.

    FEBio writes names for solid domains only; None writes no name.
    """

    type: str  # "hex8", "tet4", ...
    part_id: int  # id of the material (part)
    name: str | None
    element_ids: Ints
    conn: Ints

    def nodes(self) -> Ints:
        """Node indices in the order in which the elements first name them: the order of FMT_NODE data."""
        return first_seen(np.asarray(self.conn).reshape(-1))


def first_seen(nodes: Ints) -> Ints:
    """Each value once, in order of appearance."""
    if not nodes.size:
        return nodes
    order = np.arange(nodes.size)
    first = np.empty(int(nodes.max()) + 1, order.dtype)
    first[nodes[::-1]] = order[::-1]  # the last assignment stays: the first appearance
    return np.asarray(nodes[first[nodes] == order])


@record
class PlotSurface:
    """Facets, either by type ("quad4": conn, ...) or as one array (facet, local) padded with -1."""

    name: str
    facets: Mapping[str, ArrayLike] | NDArray
    max_nodes: int | None = None  # nodes per facet row; the largest facet unless the file said more

    def rows(self) -> Ints:
        """(facet, local) node indices padded with -1, facets in file order."""
        if not isinstance(self.facets, Mapping):
            return _widen(np.asarray(self.facets, dtype=np.int64), self.max_nodes)
        blocks = [np.atleast_2d(np.asarray(c, dtype=np.int64)) for c in self.facets.values()]
        blocks = [b for b in blocks if b.size]
        width = max([b.shape[1] for b in blocks], default=0)
        out = np.concatenate([_widen(b, width) for b in blocks]) if blocks else np.empty((0, 0), np.int64)
        return _widen(out, self.max_nodes)

    def nodes(self) -> Ints:
        """Node indices in first-seen order: the order of FMT_NODE surface data."""
        flat = self.rows().reshape(-1)
        return first_seen(flat[flat >= 0])


def _widen(rows: Ints, width: int | None) -> Ints:
    if width is None or rows.shape[1] >= width:
        return rows
    return np.pad(rows, ((0, 0), (0, width - rows.shape[1])), constant_values=-1)


@record
class PlotMesh:
    """The mesh section. Sets hold 0-based node indices, or element ids of the file."""

    node_ids: Ints
    X: NDArray  # (node, 3) reference coordinates
    domains: Sequence[PlotDomain]
    surfaces: Sequence[PlotSurface] = ()
    node_sets: Mapping[str, ArrayLike] = field(default_factory=dict)
    element_sets: Mapping[str, ArrayLike] = field(default_factory=dict)
    parts: Sequence[tuple[int, str]] = ()
    facet_sets: Sequence[PlotSurface] | None = None  # None: FEBio's habit, the surfaces again
    edges: Sequence[PlotSurface] = ()
    objects: bytes = b""  # payload of the section of rigid and other objects, as it is

    @property
    def n_elements(self) -> int:
        return sum(len(d.element_ids) for d in self.domains)

    def element_ids(self) -> Ints:
        """(element,) ids, domain after domain."""
        ids = [np.asarray(d.element_ids, np.int32) for d in self.domains]
        return np.concatenate(ids) if ids else np.empty(0, np.int32)

    def connectivity(self) -> Ints:
        """(element, local) node indices, domain after domain, padded with -1."""
        width = max((d.conn.shape[1] for d in self.domains), default=0)
        out = np.full((self.n_elements, width), -1, np.int32)
        at = 0
        for d in self.domains:
            out[at : at + len(d.conn), : d.conn.shape[1]] = d.conn
            at += len(d.conn)
        return out


@value_record
class DomainHead:
    """A domain without its elements."""

    type: str
    part_id: int
    name: str | None
    count: int

    @property
    def width(self) -> int:
        return tags.ELEMENT_TYPES[tags.ELEMENT_CODE[self.type]][1]


@record
class MeshOutline:
    """A mesh without its nodes' coordinates and its elements: what can be said without reading them."""

    n_nodes: int
    domains: Sequence[DomainHead]
    surfaces: Sequence[PlotSurface]
    node_sets: Mapping[str, ArrayLike]
    element_sets: Mapping[str, ArrayLike]
    parts: Sequence[tuple[int, str]]
    facet_sets: Sequence[PlotSurface] | None
    edges: Sequence[PlotSurface]
    objects: bytes

    @property
    def n_elements(self) -> int:
        return sum(d.count for d in self.domains)

    @property
    def part_names(self) -> list[str]:
        """One name per domain: its own, its material's, or a number; made unique."""
        materials = dict(self.parts)
        out: list[str] = []
        for i, d in enumerate(self.domains):
            name = d.name or materials.get(d.part_id) or f"part{i + 1}"
            if name in out:
                name = next(f"{name}_{k}" for k in range(2, len(out) + 3) if f"{name}_{k}" not in out)
            out.append(name)
        return out


@value_record
class PlotVariable:
    """One entry of the dictionary: what is stored, where, in which shape."""

    name: str
    section: str  # "node", "domain", "surface", "global", "edge"
    type: str  # "float", "vec3f", "mat3fs", "mat3fd", "tens4fs", "mat3f", "array", "array vec3f"
    format: str  # "node", "item", "mult", "region"
    n: int = 0  # array size of the two array types
    units: str | None = None
    array_names: tuple[str, ...] = ()

    @property
    def values(self) -> int:
        """Floats per item."""
        fixed = tags.ITEM_TYPES[tags.ITEM_CODE[self.type]][1]
        return fixed or self.n * (3 if self.type == "array vec3f" else 1)
