"""Damaged plotfiles: of raw bytes, and of the tree of blocks, where sizes are mended so that damage lies deeper."""

from __future__ import annotations

import struct
import zlib
from dataclasses import dataclass, field

import numpy as np

from febkit.results.xplt import tags as t

WORDS = (0, 1, 2, 3, 7, 64, 777, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 0xFFFFFFF8, 0x01000000, 0x01040000, 0x02000000,
         0x10000000, 0x7FC00000, 0x7F800000)  # fmt: skip
NAMES = (b"", b"\0" * 64, b"x" * 64, b"y" * 5000, b"\xff\xfe\x80", b"a/b", b"..", b"stress", b"%s{}[/]", b"time", b"X",
         "ö²".encode(), b"\x1b[31m", b"a\nb")  # fmt: skip
BRANCHES = frozenset({
    t.ROOT, t.HEADER, t.DICTIONARY, t.DIC_ITEM, t.DIC_GLOBAL, t.DIC_MATERIAL, t.DIC_NODAL, t.DIC_DOMAIN, t.DIC_SURFACE,
    t.DIC_EDGE, t.MATERIALS, t.MATERIAL, t.MESH, t.NODE_SECTION, t.NODE_HEADER, t.DOMAIN_SECTION, t.DOMAIN,
    t.DOMAIN_HDR, t.DOM_ELEM_LIST, t.SURFACE_SECTION, t.SURFACE, t.SURFACE_HDR, t.FACE_LIST, t.NODESET_SECTION,
    t.NODESET, t.NODESET_HDR, t.PARTS_SECTION, t.PART, t.ELEMENTSET_SECTION, t.ELEMENTSET, t.ELEMENTSET_HDR,
    t.FACETSET_SECTION, t.FACETSET, t.FACETSET_HDR, t.FACETSET_LIST, t.EDGE_SECTION, t.EDGE, t.EDGE_HDR, t.EDGE_LIST,
    t.OBJECTS_SECTION, 0x01051000, 0x01052000, t.STATE, t.STATE_HEADER, t.STATE_DATA, t.STATE_VARIABLE,
    t.STATE_VAR_DATA, t.GLOBAL_DATA, t.MATERIAL_DATA, t.NODE_DATA, t.ELEMENT_DATA, t.FACE_DATA, t.EDGE_DATA,
    t.MESH_STATE, t.OBJECTS_STATE,
})  # fmt: skip


@dataclass
class Node:
    """A block: its children, or its bytes. ``size`` is written instead of the true one; ``packed``: "", "block" or
    "body"; ``torn`` is done to the packed bytes."""

    tag: int
    body: bytes = b""
    children: list[Node] = field(default_factory=list)
    size: int | None = None
    packed: str = ""
    torn: int | None = None

    def bytes(self, order: str) -> bytes:
        inner = b"".join(c.bytes(order) for c in self.children) if self.children else self.body
        if self.packed == "body":
            inner = self._torn(zlib.compress(inner, 1))
        size = len(inner) if self.size is None else self.size
        out = struct.pack(order + "II", self.tag & 0xFFFFFFFF, size & 0xFFFFFFFF) + inner
        return self._torn(zlib.compress(out, 1)) if self.packed == "block" else out

    def _torn(self, raw: bytes) -> bytes:
        if self.torn is None:
            return raw
        at = self.torn % len(raw)
        return raw[:at] + bytes([raw[at] ^ 0x55]) + raw[at + 1 :] if self.torn % 2 else raw[:at]

    def walk(self) -> list[Node]:
        return [self, *(n for c in self.children for n in c.walk())]


def parse(raw: bytes, order: str) -> list[Node]:
    """The blocks of a plain plotfile."""
    return _children(raw[4:], order)


def _children(raw: bytes, order: str) -> list[Node]:
    out, at = [], 0
    while at < len(raw):
        tag, n = struct.unpack_from(order + "II", raw, at)
        body = raw[at + 8 : at + 8 + n]
        assert len(body) == n
        out.append(Node(tag, body, _children(body, order) if tag in BRANCHES else []))
        at += 8 + n
    return out


def deep(rng: np.random.Generator, raw: bytes, order: str, packed: str) -> bytes:
    """One to three changes of the tree: sizes, tags, counts, names, blocks lost, doubled, swapped, cut."""
    top = parse(raw, order)
    for n in top:
        if n.tag == t.STATE:
            n.packed = packed
    for _ in range(int(rng.integers(1, 4))):
        _change(rng, top, order)
    out = raw[:4] + b"".join(n.bytes(order) for n in top)
    return out[: int(rng.integers(0, len(out)))] if rng.random() < 0.05 else out


def _change(rng: np.random.Generator, top: list[Node], order: str) -> None:
    lists = [top, *(n.children for b in top for n in b.walk() if n.children)]
    row = lists[int(rng.integers(len(lists)))]
    if not row:
        return
    i, j = (int(k) for k in rng.integers(len(row), size=2))
    node = row[i]
    kind = int(rng.integers(0, 9))
    if kind == 0:
        real = len(node.bytes(order)) - 8 if not node.packed else 100
        node.size = int(rng.choice([*WORDS, max(real - 4, 0), real + 4, real + 1, 2 * real, real // 2]))
    elif kind == 1:
        node.tag = int(rng.choice([*WORDS, *BRANCHES, node.tag + 1, row[j].tag]))
    elif kind == 2:
        del row[i]
    elif kind == 3:
        row.insert(j, node)
    elif kind == 4:
        row[i], row[j] = row[j], row[i]
    elif kind == 5 and not node.children:
        node.body = bytes(NAMES[int(rng.integers(len(NAMES)))])
        if rng.random() < 0.5:
            node.body = struct.pack(order + "I", int(rng.choice([len(node.body), *WORDS]))) + node.body
    elif kind == 6 and not node.children:
        node.body = node.body[: int(rng.integers(0, len(node.body) + 1))]
    elif kind == 7:
        node.torn = int(rng.integers(0, 1 << 30))
    elif not node.children and len(node.body) >= 4:
        at = int(rng.integers(0, len(node.body) // 4)) * 4
        node.body = node.body[:at] + struct.pack(order + "I", int(rng.choice(WORDS))) + node.body[at + 4 :]


def raw(rng: np.random.Generator, data: bytes) -> bytes:
    """One to three of: a bit, a word, a cut, a piece lost, doubled or put in."""
    out = bytearray(data)
    for _ in range(int(rng.integers(1, 4))):
        at = int(rng.integers(0, max(len(out), 1)))
        kind = rng.integers(0, 6)
        if kind == 0 and out:
            out[at] ^= 1 << int(rng.integers(0, 8))
        elif kind == 1 and len(out) >= 8:
            at = at // 4 * 4 if rng.random() < 0.8 else at
            out[at : at + 4] = struct.pack("<I", int(rng.choice(WORDS)))
        elif kind == 2:
            del out[at:]
        elif kind == 3:
            del out[at : at + int(rng.integers(1, 64))]
        elif kind == 4:
            out[at:at] = out[at : at + int(rng.integers(1, 64))]
        else:
            out[at:at] = bytes(rng.integers(0, 256, int(rng.integers(1, 16)), dtype=np.uint8))
    return bytes(out)
