"""Nodes, element blocks and sets. Ids of the file are labels; arrays are 0-based."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field

import numpy as np
from numpy.typing import NDArray

from febkit.record import record

from .source import Where

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]


@record
class ElementBlock:
    """Elements of one type. ``conn`` (element, local node) holds 0-based node indices."""

    name: str
    type: str  # "hex8", "tet4", "quad4", ...: lower case, FEBio's spelling
    ids: Ints
    conn: Ints
    where: Where = field(default_factory=Where)


@record
class NodeSet:
    name: str
    nodes: Ints  # 0-based node indices
    where: Where = field(default_factory=Where)


@record
class Surface:
    """Facets by type ("quad4", "tri3", ...); order[i] = (type, row) in file order, with facet ids."""

    name: str
    facets: Mapping[str, Ints]  # type -> (facet, local node), 0-based node indices
    ids: Mapping[str, Ints] = field(default_factory=dict)  # type -> facet ids
    where: Where = field(default_factory=Where)


@record
class Edge:
    name: str
    lines: Ints  # (line, 2 or 3) 0-based node indices
    where: Where = field(default_factory=Where)


@record
class ElementSet:
    name: str
    elements: Ints  # element ids of the file
    where: Where = field(default_factory=Where)


@record
class DiscreteSet:
    name: str
    pairs: Ints  # (element, 2) 0-based node indices
    where: Where = field(default_factory=Where)


@record
class SurfacePair:
    name: str
    primary: str
    secondary: str
    where: Where = field(default_factory=Where)


@record
class Mesh:
    node_ids: Ints
    X: Floats  # (node, 3) reference coordinates
    blocks: tuple[ElementBlock, ...] = ()
    node_sets: Mapping[str, NodeSet] = field(default_factory=dict)
    surfaces: Mapping[str, Surface] = field(default_factory=dict)
    edges: Mapping[str, Edge] = field(default_factory=dict)
    element_sets: Mapping[str, ElementSet] = field(default_factory=dict)
    discrete_sets: Mapping[str, DiscreteSet] = field(default_factory=dict)
    surface_pairs: Mapping[str, SurfacePair] = field(default_factory=dict)
    part_lists: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    node_blocks: Mapping[str, Ints] = field(default_factory=dict)  # named <Nodes> groups -> node indices
    hanging: Mapping[int, tuple[int, ...]] = field(default_factory=dict)  # node -> corners whose mean it is

    def block(self, name: str) -> ElementBlock:
        for b in self.blocks:
            if b.name == name:
                return b
        raise KeyError(name)
