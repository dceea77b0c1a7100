"""The XML document of a .feb file: a light tree in which every tag knows its bytes and its line.

Long regular lists (nodes, elements, facets, element data) are read by :mod:`.table` and taken out, with
their line ends left in, before expat sees the rest. Offsets are mapped back to the file's own bytes.
DOCTYPE and entity declarations are refused, so no XML bomb and no external entity is ever expanded.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import field
from typing import Any
from xml.parsers import expat

from febkit.model import InputError, Where
from febkit.record import variable_record

from . import table

MAX_DEPTH = 100
_LISTS = ("Nodes", "Elements", "Surface", "Edge", "ElementData", "NodeData", "SurfaceData", "NodeSet",
          "ElementSet", "elements", "surface", "node_data", "elem_data", "surface_data")
_SCAN = re.compile(
    rb"<!--|<!\[CDATA\[|<\?|<(" + "|".join(_LISTS).encode()
    + rb""")(?=[\s>/])((?:[^<>"']|"[^"<]*"|'[^'<]*')*)>""")
_CLOSE = {b"<!--": b"-->", b"<![CDATA[": b"]]>", b"<?": b"?>"}
_START_TAG = re.compile(rb"""<[^\s/>]+(?:[^<>"']|"[^"<]*"|'[^'<]*')*>""")


class Tag:
    """One XML element. ``start`` and ``stop`` are bytes of the parsed text (see :meth:`Document.span`)."""

    __slots__ = ("attrs", "children", "doc", "line", "name", "start", "stop", "table", "text")

    def __init__(self, name: str, attrs: dict[str, str] | None = None, text: str = "",
                 children: list[Tag] | None = None, line: int = 0, doc: Document | None = None) -> None:
        self.name = name
        self.attrs: dict[str, str] = {} if attrs is None else attrs
        self.text = text
        self.children: list[Tag] = [] if children is None else children
        self.line = line
        self.doc = doc
        self.table: table.Table | None = None
        self.start = self.stop = -1

    def __iter__(self) -> Iterator[Tag]:
        return iter(self.children)

    def __repr__(self) -> str:
        return f"<{self.name} {self.attrs} line {self.line}>"

    @property
    def where(self) -> Where:
        return Where(self.doc.file if self.doc else "", self.line)

    @property
    def empty(self) -> bool:
        """True where the tag holds neither children nor rows nor text."""
        return not self.children and self.table is None and not self.text.strip()

    def get(self, attr: str, default: str | None = None) -> str | None:
        return self.attrs.get(attr, default)

    def need(self, attr: str) -> str:
        v = self.attrs.get(attr)
        if v is None:
            raise InputError(f'<{self.name}> lacks the attribute {attr}="..."', self.where)
        return v

    def child(self, name: str) -> Tag | None:
        for c in self.children:
            if c.name == name:
                return c
        return None

    def all(self, name: str) -> list[Tag]:
        return [c for c in self.children if c.name == name]


@variable_record
class Document:
    """A file's bytes and its tree."""

    file: str
    data: bytes
    root: Tag = field(init=False)
    _at: list[int] = field(default_factory=list)  # start of each cut in the parsed text
    _shift: list[int] = field(default_factory=list)  # bytes taken out up to and with that cut
    baseline: Any = None  # the model as it was read
    remarks: dict[str, list[str]] = field(default_factory=dict)  # comments in front of sections, by section
    sources: tuple[str, ...] = ()  # files whose sections stand in the model, where it includes some
    own: bool = False  # the model was read from this very tree, not from a converted one
    origin: dict[int, Tag] = field(default_factory=dict)  # id(component) -> the tag it was read from

    def offset(self, parsed: int, end: bool = False) -> int:
        """Byte in the file of a byte in the parsed text where a tag starts, or (``end``) where it ends."""
        i = bisect_right(self._at, parsed if end else parsed - 1)
        return parsed + (self._shift[i - 1] if i else 0)

    def span(self, tag: Tag) -> tuple[int, int]:
        """First byte of a tag and the byte after its end, in the file."""
        start, stop = self.offset(tag.start), self.offset(tag.stop, end=True)
        if self.data[stop:stop + 2] == b"</" and not self._closed_at(start, stop):
            stop = self.data.index(b">", stop) + 1
        return start, stop

    def _closed_at(self, start: int, stop: int) -> bool:
        """True where ``<tag .../>`` ends at ``stop``."""
        m = _START_TAG.match(self.data, start)
        return m is not None and m.end() == stop and m.group(0).endswith(b"/>")

    def inside(self, tag: Tag) -> tuple[int, int]:
        """Bytes between the start and the end tag."""
        start, _ = self.span(tag)
        m = _START_TAG.match(self.data, start)
        assert m is not None
        return m.end(), (m.end() if m.group(0).endswith(b"/>") else self.offset(tag.stop, end=True))


def _cut(data: bytes) -> tuple[bytes, list[int], list[int], dict[int, table.Table]]:
    """Takes regular lists out of the text, line ends left in; tables by parsed offset of their start."""
    pieces: list[bytes] = []
    at: list[int] = []
    shift: list[int] = []
    tables: dict[int, table.Table] = {}
    pos = done = gone = 0
    ends: dict[bytes, int] = {}  # where the next end tag of each name is: thousands of unclosed ones look for it once
    while (m := _SCAN.search(data, pos)) is not None:
        close = _CLOSE.get(m.group(0))
        if close is not None:
            pos = data.find(close, m.end())
            if pos < 0:
                break
            continue
        pos = m.end()
        if m.group(2).endswith(b"/"):
            continue
        end = ends.get(m.group(1), 0)
        if 0 <= end < pos:
            end = ends[m.group(1)] = data.find(b"</" + m.group(1) + b">", pos)
        # a list within a list of its name is none: thousands of unclosed ones would all be read to the end
        if end < 0 or data.find(b"<" + m.group(1), pos, end) >= 0:
            continue
        t = table.parse(data, pos, end)
        if t is None:
            continue
        blank = b"\n" * data.count(b"\n", pos, end)
        pieces += [data[done:pos], blank]
        tables[m.start() - gone] = t
        at.append(pos - gone)
        gone += end - pos - len(blank)
        shift.append(gone)
        pos = done = end
    pieces.append(data[done:])
    return b"".join(pieces), at, shift, tables


class _Builder:
    """expat's handlers; they build the tree."""

    def __init__(self, doc: Document, tables: dict[int, table.Table]) -> None:
        self.doc, self.tables = doc, tables
        self.stack: list[Tag] = []
        self.root: Tag | None = None
        self.waiting: list[str] = []  # comments whose section comes next
        self.parser = p = expat.ParserCreate()
        p.buffer_text = True
        p.StartElementHandler = self.start
        p.EndElementHandler = self.end
        p.CharacterDataHandler = self.text
        p.CommentHandler = self.comment
        p.StartDoctypeDeclHandler = self.doctype

    def comment(self, text: str) -> None:
        if len(self.stack) < 2:
            self.waiting.append(text)

    def doctype(self, name: str, *_: object) -> None:
        raise InputError("DOCTYPE and entity declarations are not read: remove them from the file",
                         Where(self.doc.file, self.parser.CurrentLineNumber))

    def start(self, name: str, attrs: dict[str, str]) -> None:
        p, stack = self.parser, self.stack
        tag = Tag(name, attrs, line=p.CurrentLineNumber, doc=self.doc)
        tag.start = p.CurrentByteIndex
        tag.table = self.tables.get(tag.start)
        if stack:
            stack[-1].children.append(tag)
            if len(stack) > MAX_DEPTH:
                raise InputError(f"tags are nested more than {MAX_DEPTH} deep", tag.where)
        else:
            self.root = tag
        if self.waiting and len(stack) < 2:
            self.doc.remarks.setdefault(tag.name, []).extend(self.waiting)
            self.waiting = []
        stack.append(tag)

    def end(self, name: str) -> None:
        self.stack.pop().stop = self.parser.CurrentByteIndex

    def text(self, text: str) -> None:
        self.stack[-1].text += text


def parse(data: bytes, file: str = "") -> Document:
    """The document of a file's bytes. Raises InputError with the line where the XML is broken."""
    doc = Document(file, data)
    if not data.strip():
        raise InputError("the file is empty", Where(file))
    body, doc._at, doc._shift, tables = _cut(data)
    builder = _Builder(doc, tables)
    try:
        builder.parser.Parse(body, True)
    except expat.ExpatError as e:
        raise InputError(f"not well-formed XML: {expat.ErrorString(e.code)}", Where(file, e.lineno)) from None
    except (LookupError, ValueError) as e:
        if isinstance(e, InputError):
            raise
        here = Where(file, builder.parser.CurrentLineNumber)
        raise InputError(f"cannot read the text: {e}", here) from None
    assert builder.root is not None
    doc.root = builder.root
    return doc
