"""The <Mesh> section of version 4.0: nodes, element blocks and sets."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from febkit.model import (
    DiscreteSet,
    Edge,
    ElementBlock,
    ElementSet,
    InputError,
    Mesh,
    NodeSet,
    Surface,
    SurfacePair,
    values,
)
from febkit.model.elements import ELEMENTS, of_dimension
from febkit.model.mesh import Floats, Ints

from .document import Tag

# nodes per element, by FEBio's spelling of the type (lower case); aliases carry an integration rule
NODES_OF = {name: e.nodes for name, e in ELEMENTS.items()}
MOST = 20_000_000  # ids that one list of ranges may hold
_INTEGERS = re.compile(r"[\s\d,:+-]*", re.ASCII)
FACETS = {name: NODES_OF[name] for name in of_dimension(2)}
VAR_MAPS = ("shell thickness", "fiber", "mat_axis")  # element data that fill what they are called
LINES = {"line2": 2, "line3": 3}  # edges; trusses and beams are elements


def node_count(type_: str) -> int | None:
    """Nodes of an element type such as "hex8", "HEX8G8", "tet10", "q4eas" or "tri3s"; None if unknown."""
    t = type_.lower()
    if t in NODES_OF:
        return NODES_OF[t]
    if t.startswith("q4"):
        return 4
    for name in sorted(NODES_OF, key=len, reverse=True):
        if t.startswith(name):
            return NODES_OF[name]
    return None


def ints(text: str, tag: Tag) -> Ints:
    """Integers of a list: commas or blanks between, and ranges ``a:b`` or ``a:b:step``."""
    if not _INTEGERS.fullmatch(text):
        bad = next((w for w in text.replace(",", " ").split() if not _INTEGERS.fullmatch(w)), text)
        raise InputError(f"<{tag.name}> must be a list of integers, not {values.shown(bad)}", tag.where)
    if ":" not in text:
        try:
            out = np.array(text.replace(",", " ").split(), dtype=np.int64)
        except (ValueError, OverflowError):
            raise InputError(f"<{tag.name}> must be a list of integers of 32 bits", tag.where) from None
        return _ids(out, tag)
    runs: list[Ints] = []
    total = 0
    for word in text.replace(",", " ").split():
        try:
            ends = [int(w) for w in word.split(":")]
        except ValueError:
            raise InputError(f"<{tag.name}> must be a list of integers, not {word!r}", tag.where) from None
        if any(abs(e) > values.LARGEST for e in ends):
            raise InputError(f"<{tag.name}> holds a range that makes no sense: {word[:60]}", tag.where)
        a, b, step = ends[0], ends[1] if len(ends) > 1 else ends[0], ends[2] if len(ends) > 2 else 1
        total += max((b - a) // max(step, 1) + 1, 0)
        if step <= 0 or total > MOST or len(ends) > 3:
            raise InputError(f"<{tag.name}> holds a range that makes no sense: {word[:60]}", tag.where)
        runs.append(np.arange(a, b + 1, step, dtype=np.int64))
    return np.concatenate(runs) if runs else np.zeros(0, np.int64)


def floats(text: str, tag: Tag) -> list[float]:
    """Finite numbers, with commas or else blanks between."""
    try:
        out = [float(w) for w in text.split(",")] if "," in text else [float(w) for w in text.split()]
    except ValueError:
        out = [math.nan]
    if not all(map(math.isfinite, out)) or "_" in text or not text.isascii():
        raise InputError(f"<{tag.name}> must be numbers, not {text.strip()[:60]!r}", tag.where)
    return out


def label(tag: Tag, attr: str = "id") -> int:
    return values.label(tag.need(attr), f"{attr}= of <{tag.name}>", tag.where)


def _ids(labels: Ints, tag: Tag) -> Ints:
    """Ids that 32 bits hold: plotfiles store no others."""
    if len(labels) and (int(labels.max()) > values.LARGEST or int(labels.min()) < -values.LARGEST):
        bad = int(labels[np.abs(labels) > values.LARGEST][0])
        raise InputError(f"<{tag.name}{_named(tag)}> holds the id {bad}: ids go up to {values.LARGEST}", tag.where)
    return labels


def rows(tag: Tag, names: Iterable[str], columns: int | None, attr: str = "id") -> tuple[Ints, Floats]:
    """Labels and numbers of a list of rows with equal counts."""
    t = tag.table
    names = tuple(names)
    if t is not None and t.tag in names and t.attr == attr and columns in (None, t.values.shape[1]):
        return _ids(t.labels, tag), t.values
    if t is not None:
        raise InputError(f"<{tag.name}> holds rows <{t.tag} {t.attr}=...> of {t.values.shape[1]} numbers; "
                         f"expected <{names[0]} {attr}=...> of {columns}", tag.where)
    labels, numbers = [], []
    for row in tag:
        if row.name not in names:
            raise InputError(f"<{row.name}> does not belong in <{tag.name}>", row.where)
        v = floats(row.text, row)
        if columns is None:
            columns = len(v)
        if len(v) != columns:
            raise InputError(f"<{row.name}> must hold {columns} numbers, not {len(v)}", row.where)
        labels.append(label(row, attr))
        numbers.append(v)
    return np.array(labels, dtype=np.int64), np.array(numbers, dtype=float).reshape(len(numbers), columns or 0)


class NodeIndex:
    """0-based index of a node id."""

    def __init__(self, ids: Ints) -> None:
        n = len(ids)
        self.n = n
        self.first = int(ids[0]) if n else 0
        self.plain = n > 0 and int(ids[-1]) - self.first == n - 1 and bool((np.diff(ids) == 1).all())
        if not self.plain:
            self.order = np.argsort(ids, kind="stable")
            self.sorted = ids[self.order]

    def __call__(self, ids: Ints, tag: Tag) -> Ints:
        if self.plain:
            out = ids - self.first
            bad = (out < 0) | (out >= self.n)
        else:
            at = np.minimum(np.searchsorted(self.sorted, ids), max(self.n - 1, 0))
            out = self.order[at] if self.n else np.zeros_like(ids)
            bad = self.sorted[at] != ids if self.n else np.ones(ids.shape, bool)
        if bad.any():
            i = int(np.argmax(bad.reshape(-1)))
            raise InputError(f"<{tag.name}{_named(tag)}> refers to node {int(ids.reshape(-1)[i])}, "
                             "which does not exist", tag.where)
        return out


def _named(tag: Tag) -> str:
    return f' name="{tag.attrs["name"]}"' if "name" in tag.attrs else ""


def whole(numbers: Floats, tag: Tag) -> Ints:
    """Numbers that must be integers."""
    if (np.abs(numbers) > values.LARGEST).any():
        raise InputError(f"<{tag.name}{_named(tag)}> must hold node ids", tag.where)
    out = numbers.astype(np.int64)
    if (out != numbers).any():
        raise InputError(f"<{tag.name}{_named(tag)}> must hold node ids", tag.where)
    return out


class MeshReader:
    """Reads <Mesh> in two passes: nodes first, then what refers to them."""

    def __init__(self, section: Tag) -> None:
        self.section = section
        self.out: dict[str, Any] = {k: {} for k in (
            "node_sets", "surfaces", "edges", "element_sets", "discrete_sets", "surface_pairs",
            "part_lists", "node_blocks")}
        self.blocks: list[ElementBlock] = []

    def read(self) -> Mesh:
        ids, X = self.nodes()
        self.index = NodeIndex(ids)
        for tag in self.section:
            reader = READERS.get(tag.name)
            if reader is None:
                raise InputError(f"<{tag.name}> does not belong in <Mesh>", tag.where)
            reader(self, tag)
        return Mesh(ids, X, tuple(self.blocks), **self.out)

    def nodes(self) -> tuple[Ints, Floats]:
        ids: list[Ints] = []
        X: list[Floats] = []
        count = 0
        for tag in self.section.all("Nodes"):
            i, x = rows(tag, ("node",), 3)
            if (np.diff(i) <= 0).any() or (ids and len(i) and len(ids[-1]) and i[0] <= ids[-1][-1]):
                raise InputError("node ids must increase", tag.where)
            if tag.get("name"):
                self.out["node_blocks"][tag.attrs["name"]] = np.arange(count, count + len(i))
            count += len(i)
            ids.append(i)
            X.append(x)
        if not count:
            raise InputError("the mesh has no nodes", self.section.where)
        return np.concatenate(ids), np.ascontiguousarray(np.concatenate(X))

    def put(self, kind: str, tag: Tag, record: Any) -> None:
        name = tag.need("name")
        if name in self.out[kind]:
            raise InputError(f'<{tag.name} name="{name}"> is defined twice', tag.where)
        self.out[kind][name] = record

    def elements(self, tag: Tag) -> None:
        name, type_ = tag.need("name"), tag.need("type")
        n = node_count(type_)
        if n is None:
            raise InputError(f'unknown element type "{type_}"', tag.where)
        if any(b.name == name for b in self.blocks):
            raise InputError(f'<Elements name="{name}"> is defined twice', tag.where)
        ids, conn = rows(tag, ("elem", "e"), n)
        if (np.diff(ids) <= 0).any():
            raise InputError(f'element ids of <Elements name="{name}"> must increase', tag.where)
        nodes = self.index(whole(conn, tag), tag)
        self.blocks.append(ElementBlock(name, type_.lower(), ids, nodes, tag.where))

    def node_set(self, tag: Tag) -> None:
        if tag.children or tag.table is not None:
            raise InputError("<NodeSet> must hold a list of node ids", tag.where)
        self.put("node_sets", tag, NodeSet(tag.need("name"), self.index(ints(tag.text, tag), tag), tag.where))

    def facets(self, tag: Tag, kinds: dict[str, int]) -> tuple[dict[str, Ints], dict[str, Ints]]:
        t = tag.table
        if t is not None:
            if t.tag not in kinds or t.values.shape[1] != kinds[t.tag]:
                raise InputError(f"<{t.tag}> of {t.values.shape[1]} nodes does not belong in <{tag.name}>",
                                 tag.where)
            return {t.tag: self.index(whole(t.values, tag), tag)}, {t.tag: _ids(t.labels, tag)}
        found: dict[str, list[list[float]]] = {}
        labels: dict[str, list[int]] = {}
        for row in tag:
            n = kinds.get(row.name)
            v = floats(row.text, row)
            if n is None or len(v) != n:
                raise InputError(f"<{row.name}> of {len(v)} nodes does not belong in <{tag.name}>", row.where)
            found.setdefault(row.name, []).append(v)
            labels.setdefault(row.name, []).append(label(row))
        return ({k: self.index(whole(np.array(v), tag), tag) for k, v in found.items()},
                {k: np.array(v, dtype=np.int64) for k, v in labels.items()})

    def surface(self, tag: Tag) -> None:
        facets, labels = self.facets(tag, FACETS)
        self.put("surfaces", tag, Surface(tag.need("name"), facets, labels, tag.where))

    def edge(self, tag: Tag) -> None:
        lines, _ = self.facets(tag, LINES)
        if len(lines) > 1:
            raise InputError("<Edge> must hold lines of one type", tag.where)
        conn = next(iter(lines.values()), np.zeros((0, 2), np.int64))
        self.put("edges", tag, Edge(tag.need("name"), conn, tag.where))

    def element_set(self, tag: Tag) -> None:
        if tag.children or tag.table is not None:
            raise InputError("<ElementSet> must hold a list of element ids", tag.where)
        self.put("element_sets", tag, ElementSet(tag.need("name"), ints(tag.text, tag), tag.where))

    def discrete_set(self, tag: Tag) -> None:
        pairs = []
        for row in tag:
            v = floats(row.text, row)
            if row.name != "delem" or len(v) != 2:
                raise InputError("<DiscreteSet> must hold <delem> of two nodes", row.where)
            pairs.append(v)
        p = self.index(whole(np.array(pairs).reshape(-1, 2), tag), tag)
        self.put("discrete_sets", tag, DiscreteSet(tag.need("name"), p, tag.where))

    def surface_pair(self, tag: Tag) -> None:
        side = {c.name: c.text.strip() for c in tag}
        for s in ("primary", "secondary"):
            if s not in side:
                raise InputError(f"<SurfacePair{_named(tag)}> lacks <{s}>", tag.where)
        record = SurfacePair(tag.need("name"), side["primary"], side["secondary"], tag.where)
        self.put("surface_pairs", tag, record)

    def part_list(self, tag: Tag) -> None:
        parts = tuple(w.strip() for w in tag.text.split(",") if w.strip())
        self.put("part_lists", tag, parts)


READERS: dict[str, Callable[[MeshReader, Tag], None]] = {
    "Nodes": lambda r, t: None,
    "Elements": MeshReader.elements,
    "NodeSet": MeshReader.node_set,
    "Surface": MeshReader.surface,
    "Edge": MeshReader.edge,
    "ElementSet": MeshReader.element_set,
    "DiscreteSet": MeshReader.discrete_set,
    "SurfacePair": MeshReader.surface_pair,
    "PartList": MeshReader.part_list,
}
