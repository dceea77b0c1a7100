"""Writes an edited model back into the document it was read from: only what changed is touched."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np

from febkit.model import Component, Mesh, Model, Step

from . import tree as emit
from .build import STEP_SECTIONS
from .component import tag_of
from .document import Document, Tag
from .serialize import attributes, tag_text

_ORDER = ("Module", "Control", "Globals", "Material", "Mesh", "MeshDomains", "MeshData", "Initial",
          "Boundary", "Rigid", "Loads", "Contact", "Constraints", "Discrete", "MeshAdaptor", "Step",
          "LoadData", "Output")
_MESH = {"NodeSet": "node_sets", "Surface": "surfaces", "Edge": "edges", "ElementSet": "element_sets",
         "DiscreteSet": "discrete_sets", "SurfacePair": "surface_pairs", "PartList": "part_lists"}


@dataclass(slots=True)
class Entry:
    """One child of a section: where it stood, whether that still holds, and how to spell it anew."""

    origin: Tag | None
    same: bool
    make: Callable[[], Tag]
    old: Component | None = None
    new: Component | None = None


@dataclass(slots=True)
class Splice:
    """Collects replacements of bytes of one document."""

    doc: Document
    edits: list[tuple[int, int, bytes]] = field(default_factory=list)

    def apply(self) -> bytes:
        out, at = [], 0
        for start, stop, data in sorted(self.edits, key=lambda e: (e[0], e[1])):
            out += [self.doc.data[at:start], data]
            at = stop
        out.append(self.doc.data[at:])
        return b"".join(out)

    # -- places
    def lead(self, start: int) -> tuple[int, str]:
        """Start of the blank run before a tag (with its line end), and the indent in it."""
        data, i = self.doc.data, start
        while i > 0 and data[i - 1:i] in (b" ", b"\t"):
            i -= 1
        indent = data[i:start].decode("latin-1")
        if i > 0 and data[i - 1:i] == b"\n":
            i -= 2 if data[i - 2:i] == b"\r\n" else 1
        elif i > 0:
            indent = ""
        return i, indent

    def text(self, tag: Tag, indent: str) -> bytes:
        head = self.doc.data[:200].lower()
        name = "latin-1" if b"iso-8859-1" in head else "utf-8"
        return tag_text(tag, indent).rstrip("\n").encode(name, "xmlcharrefreplace")

    def replace(self, origin: Tag, new: Tag) -> None:
        start, stop = self.doc.span(origin)
        _, indent = self.lead(start)
        self.edits.append((start, stop, self.text(new, indent).lstrip()))

    def remove(self, origin: Tag) -> None:
        start, stop = self.doc.span(origin)
        self.edits.append((self.lead(start)[0], stop, b""))

    def append(self, parent: Tag, new: Tag, after: Tag | None) -> None:
        """Puts a child behind ``after``, or first."""
        data = self.doc.data
        if after is not None:
            start, stop = self.doc.span(after)
            _, indent = self.lead(start)
            self.edits.append((stop, stop, b"\n" + self.text(new, indent)))
            return
        start, stop = self.doc.inside(parent)
        _, indent = self.lead(self.doc.span(parent)[0])
        if start == stop and data[start - 2:start] == b"/>":  # <Section/> must open first
            body = b">\n" + self.text(new, indent + "\t") + f"\n{indent}</{parent.name}>".encode()
            self.edits.append((start - 2, start, body))
        else:
            self.edits.append((start, start, b"\n" + self.text(new, indent + "\t")))

    # -- lists
    def children(self, parent: Tag, entries: Sequence[Entry], owned: Iterable[Tag]) -> None:
        """Makes the children ``owned`` of a tag say what the entries say."""
        kept = [e.origin for e in entries if e.origin is not None]
        place = {id(t): i for i, t in enumerate(parent.children)}
        order = [place[id(t)] for t in kept]
        if order != sorted(order):  # reordered: take them all out and put them in anew
            for e in entries:
                e.origin = None
            kept = []
        keep = {id(t) for t in kept}
        last: Tag | None = None
        for t in owned:
            if id(t) not in keep:
                self.remove(t)
        for e in entries:
            if e.origin is None:
                self.append(parent, e.make(), last)
                continue
            last = e.origin
            if not e.same:
                if e.old is not None and e.new is not None:
                    self.component(e.origin, e.old, e.new)
                else:
                    self.replace(e.origin, e.make())

    def components(self, parent: Tag, old: Sequence[Component], new: Sequence[Component]) -> None:
        if old is new:
            return
        self.children(parent, self.matched(old, new), [self.doc.origin[id(c)] for c in old])

    def matched(self, old: Sequence[Component], new: Sequence[Component]) -> list[Entry]:
        """Pairs new components with the old ones they come from: the same one, else by name or place."""
        here = {id(c) for c in old}
        free = [c for c in old if not any(c is n for n in new)]
        out = []
        for i, n in enumerate(new):
            make = _maker(n)
            if id(n) in here:
                out.append(Entry(self.doc.origin[id(n)], True, make))
                continue
            o = next((c for c in free if c.tag == n.tag and c.name == n.name and c.name is not None), None)
            if o is None and len(old) == len(new) and old[i].tag == n.tag and any(old[i] is f for f in free):
                o = old[i]
            if o is None:
                o = next((c for c in free if c.tag == n.tag and c.name is None and n.name is None), None)
            if o is None:
                out.append(Entry(None, False, make))
            else:
                free = [c for c in free if c is not o]
                out.append(Entry(self.doc.origin[id(o)], o == n, make, o, n))
        return out

    def component(self, origin: Tag, old: Component, new: Component) -> None:
        """Changes one tag: its text, its attributes, its children, each only where it differs."""
        if old == new:
            return
        if origin.table is not None or (old.text != new.text and (old.children or new.children)):
            self.replace(origin, tag_of(new))
            return
        spelled_old, spelled_new = tag_of(_bare(old)).attrs, tag_of(_bare(new)).attrs
        start, stop = self.doc.inside(origin)
        first = self.doc.span(origin)[0]
        closed = start == stop and self.doc.data[start - 2:start] == b"/>"
        if (old.text != new.text and closed) or not (old.children or not new.children):
            self.replace(origin, tag_of(new))
            return
        if spelled_old != spelled_new:
            order = {k: spelled_new[k] for k in origin.attrs if k in spelled_new} | spelled_new
            head = f"<{origin.name}{attributes(order)}{'/' if closed else ''}>".encode()
            self.edits.append((first, start, head))
        if old.text != new.text:
            raw = self.doc.data[start:stop]
            pad = len(raw) - len(raw.lstrip()), len(raw) - len(raw.rstrip())
            if b"<" in raw:  # a comment within the text
                pad = 0, 0
            body = self.text(Tag("x", text=new.text), "")[3:-4]
            self.edits.append((start + pad[0], stop - pad[1], body))
        elif old.children != new.children:
            self.components(origin, old.children, new.children)


def _bare(c: Component) -> Component:
    return Component(c.tag, c.type, c.name, c.id, "", c.attrs)


def _given(tag: Tag) -> Callable[[], Tag]:
    return lambda: tag


def _maker(c: Component) -> Callable[[], Tag]:
    return lambda: tag_of(c)


def splice(doc: Document, old: Model, new: Model) -> bytes:
    """The document's bytes with the differences between the two models worked in."""
    s = Splice(doc)
    root = doc.root
    for name in ("Material", "Discrete"):
        key = {"Material": "materials", "Discrete": "discrete"}[name]
        _list(s, root, name, getattr(old, key), getattr(new, key))
    _mesh(s, root, old.mesh, new.mesh)
    _records(s, root, "MeshDomains", old, new, "domains",
             lambda d: emit.domain_tag(d))
    _records(s, root, "MeshData", old, new, "mesh_data", emit.data_tag)
    _records(s, root, "LoadData", old, new, "controllers", emit.controller_tag)
    _stage(s, root, old.common, new.common)
    _steps(s, root, old, new)
    for name, make in (("Module", lambda m: emit.module_tag(m)), ("Globals", emit.globals_tag),
                       ("Output", lambda m: emit.output_tag(m.output))):
        _whole(s, root, name, old, new, make)
    _list(s, root, None, old.unknown, new.unknown)
    return s.apply()


def _append_section(s: Splice, root: Tag, new: Tag) -> None:
    """Puts a section where FEBio expects it: behind those that come before it."""
    place = _ORDER.index(new.name) if new.name in _ORDER else len(_ORDER)
    before = [c for c in root if c.name in _ORDER and _ORDER.index(c.name) <= place]
    s.append(root, new, before[-1] if before else None)


def _list(s: Splice, root: Tag, name: str | None, old: Sequence[Component], new: Sequence[Component]) -> None:
    if old is new or list(old) == list(new):
        return
    if name is None:
        plain = [c for c in old if c.tag != "Globals"]
        s.children(root, s.matched(plain, [c for c in new if c.tag != "Globals"]),
                   [s.doc.origin[id(c)] for c in plain])
        return
    parents = root.all(name)
    if len(parents) == 1:
        s.components(parents[0], old, new)
        return
    for p in parents:
        s.remove(p)
    _append_section(s, root, emit.section(name, new))


def _stage(s: Splice, stage: Tag, old: Step, new: Step) -> None:
    for name, key in STEP_SECTIONS.items():
        _list(s, stage, name, getattr(old, key), getattr(new, key))


def _steps(s: Splice, root: Tag, old: Model, new: Model) -> None:
    if old.steps is new.steps or old.steps == new.steps:
        return
    holders = [t for section in root.all("Step") for t in section.all("step")]
    top = root.child("Control")
    if top is not None and not holders and len(new.steps) == 1:
        _control(s, root, top, old.steps[0], new.steps[0])
        if _same_but_control(old.steps[0], new.steps[0]):
            return
    if top is None and len(holders) == len(old.steps) == len(new.steps):
        for t, o, n in zip(holders, old.steps, new.steps):
            if o is not n and o.name == n.name:
                _control(s, t, t.child("Control"), o, n)
                _stage(s, t, o, n)
            elif o is not n:
                attrs = {"id": t.get("id") or "1"} | ({"name": n.name} if n.name else {})
                s.replace(t, Tag("step", attrs, children=emit.step_sections(n)))
        return
    for section in (*root.all("Step"), *root.all("Control")):
        s.remove(section)
    for section in emit.tree(new).children:
        if section.name in ("Step", "Control"):
            _append_section(s, root, section)


def _same_but_control(a: Step, b: Step) -> bool:
    names = [f.name for f in fields(Step) if f.name not in ("control", "where")]
    return all(getattr(a, n) == getattr(b, n) for n in names)


def _control(s: Splice, stage: Tag, tag: Tag | None, old: Step, new: Step) -> None:
    if old.control == new.control:
        return
    if tag is not None and old.control is not None and new.control is not None:
        s.component(tag, old.control, new.control)
    elif tag is not None:
        s.remove(tag)
    elif new.control is not None:
        s.append(stage, tag_of(new.control), None)


def _records(s: Splice, root: Tag, name: str, old: Model, new: Model, key: str,
             make: Callable[[Any], Tag]) -> None:
    """Records that keep the component they were read from."""
    a, b = getattr(old, key), getattr(new, key)
    if a is b:
        return
    parents = root.all(name)
    if len(parents) != 1:
        for p in parents:
            s.remove(p)
        _append_section(s, root, Tag(name, children=[make(r) for r in b]))
        return
    mine = {id(r.spec): r for r in a}
    entries = []
    for r in b:
        was = mine.get(id(r.spec))
        origin = s.doc.origin.get(id(r.spec)) if was is not None else None
        entries.append(Entry(origin, was is r, lambda r=r: make(r)))  # type: ignore[misc]
    s.children(parents[0], entries, [s.doc.origin[id(r.spec)] for r in a])


def _mesh(s: Splice, root: Tag, old: Mesh, new: Mesh) -> None:
    if old is new:
        return
    section = root.child("Mesh")
    made = emit.mesh_tag(new)
    renumbered = old.node_ids is not new.node_ids and not np.array_equal(old.node_ids, new.node_ids)
    if section is None or renumbered:
        if section is not None:
            s.replace(section, made)
        else:
            _append_section(s, root, made)
        return
    fresh = {(t.name, t.get("name")): t for t in made.children if t.name != "Nodes"}
    there = {(t.name, t.get("name")): t for t in section if t.name != "Nodes"}
    entries = [Entry(there.get(k), _unchanged(k, old, new), _given(t)) for k, t in fresh.items()]
    place = {id(t): i for i, t in enumerate(section.children)}
    entries.sort(key=lambda e: place[id(e.origin)] if e.origin is not None else len(place))
    nodes = section.all("Nodes")
    if old.X is not new.X and not np.array_equal(old.X, new.X):
        spelled = [t for t in made.children if t.name == "Nodes"]
        if len(spelled) == len(nodes):
            entries = [Entry(t, False, _given(n)) for t, n in zip(nodes, spelled)] + entries
        else:
            s.replace(section, made)
            return
    else:
        entries = [Entry(t, True, _given(t)) for t in nodes] + entries
    entries.sort(key=lambda e: place[id(e.origin)] if e.origin is not None else len(place))
    s.children(section, entries, section.children)


def _unchanged(key: tuple[str, str | None], old: Mesh, new: Mesh) -> bool:
    kind, name = key
    if kind == "Elements":
        a = next((b for b in old.blocks if b.name == name), None)
        return a is not None and any(b is a for b in new.blocks)
    group = _MESH[kind]
    a, b = getattr(old, group).get(name), getattr(new, group).get(name)
    return a is not None and (a is b or (kind == "PartList" and a == b))


def _whole(s: Splice, root: Tag, name: str, old: Model, new: Model,
           make: Callable[[Model], Tag | None]) -> None:
    """Sections small enough to write anew when they differ."""
    a, b = make(old), make(new)
    first = tag_text(a) if a is not None else ""
    second = tag_text(b) if b is not None else ""
    if first == second:
        return
    there = root.all(name)
    for extra in there[1:]:
        s.remove(extra)
    if b is None:
        for t in there[:1]:
            s.remove(t)
    elif there:
        s.replace(there[0], b)
    else:
        _append_section(s, root, b)
