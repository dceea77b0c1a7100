"""Blocks of a plotfile as bytes."""

from __future__ import annotations

import struct
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from . import tags
from .records import PlotDomain, PlotMesh, PlotSurface, PlotVariable

_HEAD = struct.Struct("<II")
LIMIT = 2**32 - 1  # bytes of one block


def block(tag: int, *payload: bytes) -> bytes:
    """[tag][bytes][payload]."""
    body = b"".join(payload)
    if len(body) > LIMIT:
        raise ValueError(f"a plotfile block holds at most 4 GiB, this one needs {len(body)} bytes")
    return _HEAD.pack(tag, len(body)) + body


def integer(tag: int, value: int) -> bytes:
    return _HEAD.pack(tag, 4) + struct.pack("<I", value & 0xFFFFFFFF)


def text(tag: int, value: str) -> bytes:
    """u32 length + characters."""
    raw = value.encode()
    return _HEAD.pack(tag, len(raw) + 4) + struct.pack("<I", len(raw)) + raw


def name64(tag: int, value: str) -> bytes:
    """char[64], cut at 63 characters, zero padded."""
    raw = value.encode()[: tags.NAME_SIZE - 1]
    return _HEAD.pack(tag, tags.NAME_SIZE) + raw.ljust(tags.NAME_SIZE, b"\0")


def header(
    version: int, compress: bool, software: str | None, units: str | None, author: str | None
) -> bytes:
    parts = [integer(tags.HDR_VERSION, version), integer(tags.HDR_COMPRESSION, int(compress))]
    if author:
        parts.append(text(tags.HDR_AUTHOR, author))
    if software:
        parts.append(text(tags.HDR_SOFTWARE, software))
    if units is not None:
        parts.append(text(tags.HDR_UNITS, units))
    return block(tags.HEADER, *parts)


def dictionary(variables: Sequence[PlotVariable], with_units: bool) -> bytes:
    parts = []
    for section, (tag, _) in tags.SECTIONS.items():
        items = [dictionary_item(v, with_units) for v in variables if v.section == section]
        if items:
            parts.append(block(tag, *items))
    return block(tags.DICTIONARY, *parts)


def dictionary_item(v: PlotVariable, with_units: bool) -> bytes:
    parts = [
        integer(tags.DIC_ITEM_TYPE, tags.ITEM_CODE[v.type]),
        integer(tags.DIC_ITEM_FMT, tags.FORMATS.index(v.format)),
        integer(tags.DIC_ITEM_ARRAYSIZE, v.n),
    ]
    if v.n and len(v.array_names) == v.n:
        parts += [name64(tags.DIC_ITEM_ARRAYNAME, a) for a in v.array_names]
    parts.append(name64(tags.DIC_ITEM_NAME, v.name))
    if with_units and v.units:
        parts.append(name64(tags.DIC_ITEM_UNITS, v.units))
    return block(tags.DIC_ITEM, *parts)


def mesh(m: PlotMesh, version: int) -> bytes:
    """The mesh section, its parts in FEBio's order."""
    facet_sets = m.surfaces if m.facet_sets is None else m.facet_sets
    parts = [_nodes(m, version), block(tags.DOMAIN_SECTION, *map(_domain, m.domains))]
    optional = (
        (tags.SURFACE_SECTION, _surfaces(m.surfaces, _SURFACE), 0x30),
        (tags.EDGE_SECTION, _surfaces(m.edges, _EDGE), 0x35),
        (tags.NODESET_SECTION, _sets(m.node_sets.items(), _NODESET), 0x30),
        (tags.ELEMENTSET_SECTION, _sets(m.element_sets.items(), _ELEMENTSET), 0x32),
        (tags.FACETSET_SECTION, _surfaces(facet_sets, _FACETSET), 0x32),
        (tags.PARTS_SECTION, [_part(i, n) for i, n in m.parts], 0x30),
        (tags.OBJECTS_SECTION, [m.objects] if m.objects else [], 0x30),
    )
    parts += [block(tag, *body) for tag, body, since in optional if body and version >= since]
    return block(tags.MESH, *parts)


def _nodes(m: PlotMesh, version: int) -> bytes:
    n = len(m.node_ids)
    rows = np.empty((n, 4), "<i4")
    rows[:, 0] = m.node_ids if version >= 0x33 else np.arange(n)  # an index before version 0x33
    rows[:, 1:] = np.asarray(m.X, "<f4").view("<i4")
    head = block(tags.NODE_HEADER, integer(tags.NODE_SIZE, n), integer(tags.NODE_DIM, 3))
    return block(tags.NODE_SECTION, head, block(tags.NODE_COORDS, rows.tobytes()))


def _domain(d: PlotDomain) -> bytes:
    code = tags.ELEMENT_CODE[d.type]
    head = [
        integer(tags.DOM_ELEM_TYPE, code),
        integer(tags.DOM_PART_ID, d.part_id),
        integer(tags.DOM_ELEMS, len(d.element_ids)),
    ]
    if d.name is not None:
        head.append(text(tags.DOM_NAME, d.name))
    rows = np.column_stack([np.asarray(d.element_ids), np.asarray(d.conn)])
    elements = block(tags.DOM_ELEM_LIST, _rows(tags.ELEMENT, rows))
    return block(tags.DOMAIN, block(tags.DOMAIN_HDR, *head), elements)


def _rows(tag: int, rows: np.ndarray) -> bytes:
    """Each row of integers as one block."""
    out = np.empty((rows.shape[0], rows.shape[1] + 2), "<i4")
    out[:, 0] = tag
    out[:, 1] = 4 * rows.shape[1]
    out[:, 2:] = rows
    return out.tobytes()


# tags of a set of facets or lines: (set, header, ids and sizes in file order, list, row)
_SURFACE = (tags.SURFACE, tags.SURFACE_HDR, tags.SURFACE_ID, tags.SURFACE_FACES, tags.SURFACE_NAME,
            tags.SURFACE_MAX_FACET_NODES, tags.FACE_LIST, tags.FACE, 0)
_FACETSET = (tags.FACETSET, tags.FACETSET_HDR, tags.FACETSET_ID, tags.FACETSET_SIZE, tags.FACETSET_NAME,
             tags.FACETSET_MAXNODES, tags.FACETSET_LIST, tags.FACET, tags.FACET_MAX_NODES)
_EDGE = (tags.EDGE, tags.EDGE_HDR, tags.EDGE_ID, tags.EDGE_LINES, tags.EDGE_NAME,
         tags.EDGE_MAX_NODES, tags.EDGE_LIST, tags.LINE, 3)
# (set, header, id, size, name, list)
_NODESET = (tags.NODESET, tags.NODESET_HDR, tags.NODESET_ID, tags.NODESET_SIZE, tags.NODESET_NAME,
            tags.NODESET_LIST)
_ELEMENTSET = (tags.ELEMENTSET, tags.ELEMENTSET_HDR, tags.ELEMENTSET_ID, tags.ELEMENTSET_SIZE,
               tags.ELEMENTSET_NAME, tags.ELEMENTSET_LIST)


def _surfaces(surfaces: Sequence[PlotSurface], t: tuple[int, ...]) -> list[bytes]:
    whole, head, id_, size, name, width, list_, row, fixed = t
    out = []
    for i, s in enumerate(surfaces):
        nodes = s.rows()
        w = max(fixed, nodes.shape[1])
        rows = np.zeros((len(nodes), w + 2), np.int64)
        # FEBio numbers facets within the surface, and lines by the edge they belong to
        rows[:, 0] = i + 1 if t is _EDGE else np.arange(1, len(nodes) + 1)
        rows[:, 1] = (nodes >= 0).sum(axis=1)
        rows[:, 2 : 2 + nodes.shape[1]] = np.maximum(nodes, 0)
        h = block(head, integer(id_, i + 1), integer(size, len(nodes)), text(name, s.name), integer(width, w))
        out.append(block(whole, h, block(list_, _rows(row, rows))))
    return out


def _sets(sets: Iterable[tuple[str, ArrayLike]], t: tuple[int, ...]) -> list[bytes]:
    whole, head, id_, size, name, list_ = t
    out = []
    for i, (label, members) in enumerate(sets):
        a = np.asarray(members, "<i4")
        h = block(head, integer(id_, i + 1), integer(size, len(a)), text(name, label))
        out.append(block(whole, h, block(list_, a.tobytes())))
    return out


def _part(number: int, name: str) -> bytes:
    return block(tags.PART, integer(tags.PART_ID, number), name64(tags.PART_NAME, name))
