"""Reads a mesh section: nodes, domains, surfaces, edges and sets, without a loop over elements."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from febkit.model import InputError

from . import tags
from .container import Bytes, Container
from .header import Header, parts
from .records import DomainHead, MeshOutline, PlotDomain, PlotMesh, PlotSurface

_OLD_COORDS = 0x01041001  # versions below 8
_FACET_LIMIT = 32  # nodes of a facet; a header that says more than its rows hold, and more than this, is damage

# tags of a list of facets or lines: (one, header, name, how many, rows wide, list)
_SURFACE = (tags.SURFACE, tags.SURFACE_HDR, tags.SURFACE_NAME, tags.SURFACE_FACES, tags.SURFACE_MAX_FACET_NODES,
            tags.FACE_LIST)  # fmt: skip
_FACETSET = (tags.FACETSET, tags.FACETSET_HDR, tags.FACETSET_NAME, tags.FACETSET_SIZE, tags.FACETSET_MAXNODES,
             tags.FACETSET_LIST)  # fmt: skip
_EDGE = (tags.EDGE, tags.EDGE_HDR, tags.EDGE_NAME, tags.EDGE_LINES, tags.EDGE_MAX_NODES, tags.EDGE_LIST)
# of a list of nodes or elements: (one, header, name, how many, list)
_NODESET = (tags.NODESET, tags.NODESET_HDR, tags.NODESET_NAME, tags.NODESET_SIZE, tags.NODESET_LIST)
_ELEMENTSET = (tags.ELEMENTSET, tags.ELEMENTSET_HDR, tags.ELEMENTSET_NAME, tags.ELEMENTSET_SIZE, tags.ELEMENTSET_LIST)


def outline(c: Container, section: Bytes, h: Header) -> MeshOutline:
    """Everything of a mesh section but coordinates and elements."""
    found = _sections(c, section)
    none = Bytes(b"", 0, 0)
    n = _node_rows(c, found.get(tags.NODE_SECTION, none), h).count
    facets = _surfaces(c, found.get(tags.FACETSET_SECTION, none), _FACETSET, n, h.version, None)
    objects = found.get(tags.OBJECTS_SECTION, none)
    old = h.facet_nodes if h.version < 8 else None
    surfaces = _surfaces(c, found.get(tags.SURFACE_SECTION, none), _SURFACE, n, h.version, old)
    materials = h.parts
    if tags.PARTS_SECTION in found:
        materials = parts(c, found[tags.PARTS_SECTION], (tags.PART, tags.PART_ID, tags.PART_NAME))
    return MeshOutline(
        n_nodes=n,
        domains=[d for d, _ in _domain_heads(c, found.get(tags.DOMAIN_SECTION, none))],
        surfaces=surfaces,
        node_sets=_node_sets(c, found.get(tags.NODESET_SECTION, none), n),
        element_sets=_sets(c, found.get(tags.ELEMENTSET_SECTION, none), _ELEMENTSET),
        parts=materials,
        facet_sets=None if _same(surfaces, facets) else facets,
        edges=_surfaces(c, found.get(tags.EDGE_SECTION, none), _EDGE, n, h.version, None),
        objects=bytes(objects.data[objects.start : objects.stop]),
    )


def read(c: Container, section: Bytes, h: Header, o: MeshOutline) -> PlotMesh:
    """The whole mesh section."""
    found = _sections(c, section)
    none = Bytes(b"", 0, 0)
    ids, X = _nodes(c, _node_rows(c, found.get(tags.NODE_SECTION, none), h), h)
    return PlotMesh(
        node_ids=ids,
        X=X,
        domains=_domains(c, found.get(tags.DOMAIN_SECTION, none), len(ids)),
        surfaces=o.surfaces,
        node_sets=o.node_sets,
        element_sets=o.element_sets,
        parts=o.parts,
        facet_sets=o.facet_sets,
        edges=o.edges,
        objects=o.objects,
    )


def node_ids(c: Container, section: Bytes, h: Header) -> np.ndarray:
    """(node,) ids alone."""
    found = _sections(c, section)
    rows = _node_rows(c, found.get(tags.NODE_SECTION, Bytes(b"", 0, 0)), h)
    if rows.old or h.version < 0x33:
        return np.arange(1, rows.count + 1, dtype=np.int32)
    return c.words(rows.data).reshape(rows.count, rows.dim + 1)[:, 0].astype("=i4")


def element_ids(c: Container, section: Bytes) -> np.ndarray:
    """(element,) ids alone, domain after domain."""
    found = _sections(c, section)
    heads = _domain_heads(c, found.get(tags.DOMAIN_SECTION, Bytes(b"", 0, 0)))
    ids = [c.words(b).reshape(d.count, d.width + 3)[:, 2] for d, b in heads if d.count]
    return np.concatenate(ids).astype("=i4") if ids else np.empty(0, np.int32)


def _sections(c: Container, mesh: Bytes) -> dict[int, Bytes]:
    """The sections of a mesh by tag."""
    out: dict[int, Bytes] = {}
    for tag, b in c.children(mesh, "mesh"):
        if tag in out:
            raise InputError(f"damaged mesh: it has section {tag:#010x} twice", c.where)
        out[tag] = b
    return out


@dataclass(frozen=True, slots=True)
class _NodeRows:
    count: int
    dim: int
    data: Bytes
    old: bool  # (x, y, z) rows, before version 8; (id, x, y, z) since


def _same(a: list[PlotSurface], b: list[PlotSurface]) -> bool:
    """Whether two lists of facets are the same but for padding."""
    return len(a) == len(b) and all(
        s.name == t.name and len(s.rows()) == len(t.rows()) and np.array_equal(*_trim(s.rows(), t.rows()))
        for s, t in zip(a, b)
    )


def _trim(a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    width = max(a.shape[1], b.shape[1])
    wide = [np.pad(r, ((0, 0), (0, width - r.shape[1])), constant_values=-1) for r in (a, b)]
    return wide[0], wide[1]


def _node_rows(c: Container, section: Bytes, h: Header) -> _NodeRows:
    """Where the nodes lie."""
    size, dim, data, old = h.nodes, 3, None, True
    for tag, b in c.children(section, "node section"):
        if tag == tags.NODE_HEADER:
            for k, v in c.children(b, "node header"):
                if k == tags.NODE_SIZE:
                    size = c.word(v, "node header")
                elif k == tags.NODE_DIM:
                    dim = c.word(v, "node header")
        elif tag in (tags.NODE_COORDS, _OLD_COORDS):
            data, old = b, tag == _OLD_COORDS
    if data is None or dim not in (2, 3):
        raise InputError("the mesh has no node coordinates", c.where)
    have, want = (data.stop - data.start) // 4, size * (3 if old else dim + 1)
    if have != want:
        raise InputError(f"{size} nodes need {want} numbers, the file has {have}", c.where)
    return _NodeRows(size, dim, data, old)


def _nodes(c: Container, rows: _NodeRows, h: Header) -> tuple[np.ndarray, np.ndarray]:
    """Ids and reference coordinates."""
    n = rows.count
    plain = np.arange(1, n + 1, dtype=np.int32)
    if rows.old:
        return plain, c.floats(rows.data).reshape(n, 3).astype("=f4")
    words = c.words(rows.data).reshape(n, rows.dim + 1)
    ids = words[:, 0].astype("=i4") if h.version >= 0x33 else plain  # an index before version 0x33
    X = np.zeros((n, 3), np.float32)
    X[:, : rows.dim] = c.floats(rows.data).reshape(n, rows.dim + 1)[:, 1:]
    return ids, X


def _domain_heads(c: Container, section: Bytes) -> Iterator[tuple[DomainHead, Bytes]]:
    """Each domain's head and its block of elements."""
    number = 0
    for tag, b in c.children(section, "domain section"):
        if tag != tags.DOMAIN:
            continue
        number += 1
        code, part, count, name, rows = -1, 0, None, None, Bytes(b"", 0, 0)
        for k, v in c.children(b, "domain"):
            if k == tags.DOM_ELEM_LIST:
                rows = v
            elif k == tags.DOMAIN_HDR:
                for kk, vv in c.children(v, "domain header"):
                    if kk == tags.DOM_ELEM_TYPE:
                        code = c.word(vv, "domain header")
                    elif kk == tags.DOM_PART_ID:
                        part = c.word(vv, "domain header")
                    elif kk == tags.DOM_ELEMS:
                        count = c.word(vv, "domain header")
                    elif kk == tags.DOM_NAME:
                        name = c.text(vv)
        if not 0 <= code < len(tags.ELEMENT_TYPES):
            raise InputError(f"domain {number} has unknown element type {code}", c.where)
        type_, width = tags.ELEMENT_TYPES[code]
        have = (rows.stop - rows.start) / (4 * width + 12)
        if have != int(have) or (count is not None and count != have):
            raise InputError(f"domain {number} lists {have:g} of {count} {type_} elements", c.where)
        yield DomainHead(type_, part, name, int(have)), rows


def _domains(c: Container, section: Bytes, n_nodes: int) -> list[PlotDomain]:
    out: list[PlotDomain] = []
    for d, b in _domain_heads(c, section):
        what = f"domain {len(out) + 1}"
        rows = _rows(c, b, what, d.width + 1)
        _inside(c, rows[:, 1:], n_nodes, what)
        out.append(PlotDomain(d.type, d.part_id, d.name, rows[:, 0], rows[:, 1:]))
    return out


def _rows(c: Container, b: Bytes | None, what: str, width: int | None = None) -> np.ndarray:
    """Blocks of equal size, each a row of integers: (row, width)."""
    if b is None or b.stop == b.start:
        return np.empty((0, width or 0), np.int32)
    _, n = c.head.unpack(b.data[b.start : b.start + 8]) if b.stop - b.start >= 8 else (0, 0)
    w = n // 4
    if n % 4 or (b.stop - b.start) % (n + 8) or (width is not None and w != width):
        raise InputError(f"damaged {what}: rows of {n} bytes do not fill {b.stop - b.start}", c.where)
    words = c.words(b).reshape(-1, w + 2)
    if (words[:, 1] != n).any() or (words[:, 0] != words[0, 0]).any():
        raise InputError(f"damaged {what}: rows differ in size", c.where)
    return words[:, 2:].astype("=i4")


def _inside(c: Container, nodes: np.ndarray, n_nodes: int, what: str) -> None:
    if nodes.size and (nodes.min() < 0 or nodes.max() >= n_nodes):
        raise InputError(f"{what} names a node that does not exist (the mesh has {n_nodes})", c.where)


def _surfaces(
    c: Container, section: Bytes, t: tuple[int, ...], n_nodes: int, version: int, old: int | None
) -> list[PlotSurface]:
    one, head, name_, count_, width_, list_ = t
    out = []
    for tag, b in c.children(section, "surface section"):
        if tag != one:
            continue
        name, width, rows, count = "", old, None, None
        for k, v in c.children(b, "surface"):
            if k == list_:
                rows = v
            elif k == head:
                for kk, vv in c.children(v, "surface header"):
                    if kk == name_:
                        name = c.text(vv)
                    elif kk == width_:
                        width = c.word(vv, "surface header")
                    elif kk == count_:
                        count = c.word(vv, "surface header")
        what = f"surface {name!r}"
        nodes = _facets(c, _rows(c, rows, what), version, what)
        _counted(c, count if version >= 8 else None, len(nodes), what)
        _inside(c, np.where(nodes < 0, 0, nodes), n_nodes, what)
        if width and width > max(nodes.shape[1], _FACET_LIMIT):
            raise InputError(f"damaged {what}: facets of {width} nodes", c.where)
        out.append(PlotSurface(name, nodes, width if width and width > nodes.shape[1] else None))
    return out


def _counted(c: Container, said: int | None, listed: int, what: str) -> None:
    if said is not None and said != listed:
        raise InputError(f"damaged {what}: it lists {listed} where its header counts {said}", c.where)


def _facets(c: Container, rows: np.ndarray, version: int, what: str) -> np.ndarray:
    """Node indices padded with -1, from rows (id, count, nodes...), or (id, four nodes) in version 1."""
    if not len(rows):
        return np.empty((0, max(rows.shape[1] - 2, 0)), np.int32)
    if version == 1 and rows.shape[1] == 5:
        nodes = rows[:, 1:].copy()
        nodes[nodes[:, 3] == nodes[:, 2], 3] = -1  # a triangle repeats its last node
        return nodes
    if rows.shape[1] < 2:
        raise InputError(f"damaged {what}: rows of {rows.shape[1]} numbers", c.where)
    counts, nodes = rows[:, 1], rows[:, 2:]
    if counts.min() < 0 or counts.max() > nodes.shape[1]:
        raise InputError(f"damaged {what}: a facet of {counts.max()} nodes in {nodes.shape[1]}", c.where)
    pad = np.arange(nodes.shape[1]) >= counts[:, None]
    if (nodes[~pad] < 0).any():
        raise InputError(f"{what} names a negative node", c.where)
    return np.where(pad, -1, nodes).astype(np.int32)


def _sets(c: Container, section: Bytes, t: tuple[int, ...]) -> dict[str, np.ndarray]:
    one, head, name_, count_, list_ = t
    out: dict[str, np.ndarray] = {}
    for tag, b in c.children(section, "sets"):
        if tag != one:
            continue
        name, members, count = "", np.empty(0, np.int32), None
        for k, v in c.children(b, "set"):
            if k == list_:
                members = c.words(v).astype("=i4")
            elif k == head:
                for kk, vv in c.children(v, "set header"):
                    if kk == name_:
                        name = c.text(vv)
                    elif kk == count_:
                        count = c.word(vv, "set header")
        _counted(c, count, len(members), f"set {name!r}")
        out[_free(name, out)] = members
    return out


def _node_sets(c: Container, section: Bytes, n_nodes: int) -> dict[str, np.ndarray]:
    sets = _sets(c, section, _NODESET)
    for name, nodes in sets.items():
        _inside(c, nodes, n_nodes, f"node set {name!r}")
    return sets


def _free(name: str, taken: dict[str, np.ndarray]) -> str:
    """Two sets of one name (or none) stay two."""
    if name not in taken:
        return name
    return next(f"{name}_{i}" for i in range(2, len(taken) + 3) if f"{name}_{i}" not in taken)
