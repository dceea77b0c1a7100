"""A plotfile for reading: header, variables, meshes, states; data of one variable at one time."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from febkit.model import InputError

from . import header, meshes, tags
from .container import Block, Bytes, Container
from .floats import Floats
from .records import MeshOutline, PlotMesh
from .source import Held, Marks

_NEAR = 1 << 12  # bytes between words up to which they are read at once


@dataclass(frozen=True, slots=True)
class Layout:
    """Where the data lie in a state: offsets from the start of its payload."""

    regions: tuple[tuple[tuple[int, int, int], ...], ...]  # per variable: (region, offset, bytes)
    time: int
    status: int  # -1 where the file has none
    flags: tuple[int, int] | None  # offset and bytes of the element states
    objects: tuple[int, int] | None
    pieces: tuple[tuple[int, int], ...]  # bytes that hold all tags, sizes and variable numbers, few others between
    at: np.ndarray  # of those, in words
    words: np.ndarray  # what stands there


@dataclass(frozen=True, slots=True)
class State:
    """One state: its block and the mesh it belongs to."""

    block: Block
    mesh: int


class PlotFile:
    """A plotfile, any version. Opening indexes blocks; meshes, layouts and data are read when touched."""

    def __init__(self, path: str | os.PathLike[str] | Held) -> None:
        self.container = Container(path, state_room)
        try:
            self._index()
        except BaseException:
            self.container.close()
            raise

    def _index(self) -> None:
        self.header = header.read(self.container)
        self.variables = self.header.variables
        self.states: list[State] = []
        self._mesh_at: list[Bytes | Block] = [self.header.mesh] if self.header.mesh else []
        self._outlines: dict[int, MeshOutline] = {}
        self._meshes: dict[int, PlotMesh] = {}
        self._layouts: dict[int, Layout] = {}  # by size, the last one
        self._known: dict[int, Layout] = {}  # by state
        self._seen = 0
        self._take()

    def _take(self) -> None:
        for block in self.container.blocks[self._seen :]:
            if block.tag == tags.MESH:
                self._mesh_at.append(block)
            elif block.tag == tags.STATE:
                self.states.append(State(block, len(self._mesh_at) - 1))
        self._seen = len(self.container.blocks)

    def refresh(self) -> bool:
        """Look for states that were completed since opening; True where there are."""
        fresh = self.container.refresh()
        self._take()
        return fresh

    @property
    def version(self) -> int:
        return self.header.version

    @property
    def n_meshes(self) -> int:
        return len(self._mesh_at)

    def _section(self, i: int) -> Bytes:
        if not self._mesh_at:
            raise InputError("the plotfile has no mesh (was its writing cut short?)", self.container.where)
        if not 0 <= i < len(self._mesh_at):
            raise InputError(f"there is no mesh {i}: the plotfile has {self.n_meshes}", self.container.where)
        at = self._mesh_at[i]
        return at if isinstance(at, Bytes) else self.container.payload(at)

    def outline(self, i: int = 0) -> MeshOutline:
        """A mesh's names, sets and sizes."""
        if i not in self._outlines:
            self._outlines[i] = meshes.outline(self.container, self._section(i), self.header)
        return self._outlines[i]

    def mesh(self, i: int = 0) -> PlotMesh:
        """A whole mesh."""
        if i not in self._meshes:
            made = meshes.read(self.container, self._section(i), self.header, self.outline(i))
            self._meshes[i] = made
        return self._meshes[i]

    def node_ids(self, i: int = 0) -> np.ndarray:
        """(node,) ids of a mesh, without the rest of it."""
        return meshes.node_ids(self.container, self._section(i), self.header)

    def element_ids(self, i: int = 0) -> np.ndarray:
        """(element,) ids of a mesh, without the rest of it."""
        return meshes.element_ids(self.container, self._section(i))

    def payload(self, state: int) -> Bytes:
        return self.container.payload(self.states[state].block)

    def layout(self, state: int) -> Layout:
        """Where a state's data lie; a state of the same size is checked against the last such layout."""
        known = self._known.get(state)
        if known is None:
            self._known[state] = known = self._layout(self.payload(state))
        return known

    def _layout(self, b: Bytes) -> Layout:
        if b.streamed:
            return _Walk(self, b).layout()
        size = b.stop - b.start
        known = self._layouts.get(size)
        if known is not None and np.array_equal(self.container.words_at(b, known.pieces, known.at), known.words):
            return known
        self._layouts[size] = made = _Walk(self, b).layout()
        return made

    @property
    def times(self) -> np.ndarray:
        """(state,) float32."""
        out = np.empty(len(self.states), np.float32)
        i = 0
        while i < len(out):
            n = self._run(i)
            if n > 1:
                out[i : i + n] = self._strided(i, n, self.layout(i).time, "f4")
            else:
                out[i] = self.time(i)
            i += n
        if not np.isfinite(out).all():
            k = int(np.argmin(np.isfinite(out)))
            raise InputError(f"damaged: the time of state {k + 1} is {out[k]}", self.container.where)
        return out

    @property
    def statuses(self) -> np.ndarray:
        """(state,) 0 converged, 1 the mesh changed, 2 not converged."""
        out = np.zeros(len(self.states), np.int32)
        i = 0
        while i < len(out):
            if self.states[i].block.packed:
                out[i] = self.status(i)
                i += 1
                continue
            n, at = self._run(i), self.layout(i).status
            out[i : i + n] = self._strided(i, n, at, "i4") if n > 1 and at >= 0 else self.status(i)
            i += n if at >= 0 else 1
        return out

    def _run(self, i: int) -> int:
        """How many plain states of the same size stand in a row from state i."""
        first = self.states[i].block
        length = first.stop - first.start
        n = 1
        while not first.packed and i + n < len(self.states):
            b = self.states[i + n].block
            if b.packed or b.start != first.start + n * length or b.stop != b.start + length:
                break
            n += 1
        return n

    def _strided(self, i: int, n: int, at: int, kind: str) -> np.ndarray:
        """One word of each header of a run of states, where their headers agree in layout."""
        block, order, data = self.states[i].block, self.container.order, self.container.data
        start, step = block.start + 8 + at, block.stop - block.start
        heads = data.rows(start - 8, step, n, 12).view(order + "u4")
        if (heads[:, :2] != heads[0, :2]).any():
            one = self.time if kind == "f4" else self.status
            return np.array([one(k) for k in range(i, i + n)], kind)
        return heads[:, 2].view(order + kind)

    def time(self, state: int) -> float:
        known = self._head_word(state, tags.STATE_HDR_TIME)
        if known is not None:
            return float(self.container.floats(known)[0])
        b, at = self.payload(state), self.layout(state).time
        return float(self.container.floats(Bytes(b.data, b.start + at, b.start + at + 4))[0])

    def _head_word(self, state: int, wanted: int) -> Bytes | None:
        """A word of a packed state's header, if it is among the bytes that are kept of it."""
        c, head = self.container, self.states[state].block.head
        if len(head) < 8 or c.head.unpack_from(head)[0] != tags.STATE_HEADER:
            return None
        at, end = 8, min(8 + c.head.unpack_from(head)[1], len(head))
        while at + 12 <= end:
            tag, n = c.head.unpack_from(head, at)
            if n != 4:
                return None
            if tag == wanted:
                return Bytes(head, at + 8, at + 12)
            at += 12
        return None

    def status(self, state: int) -> int:
        known = self._head_word(state, tags.STATE_STATUS)
        if known is not None:
            return int(self.container.words(known)[0])
        b, at = self.payload(state), self.layout(state).status
        return 0 if at < 0 else int(self.container.words(Bytes(b.data, b.start + at, b.start + at + 4))[0])

    def element_state(self, state: int) -> np.ndarray | None:
        """One flag per element (1: active), as many as the file holds; None where it has none."""
        found = self.layout(state).flags
        if found is None:
            return None
        b = self._small(state, found[1], "flags of elements")
        words = self.container.words(Bytes(b.data, b.start + found[0], b.start + sum(found)))
        return words.view(self.container.order + "u4")

    def objects(self, state: int) -> bytes:
        found = self.layout(state).objects
        if found is None:
            return b""
        b = self._small(state, found[1], "values of objects")
        return bytes(b.data[b.start + found[0] : b.start + sum(found)])

    def floats(self, variable: int, state: int) -> Iterator[tuple[int, Floats]]:
        """(region, float32 values to be read) of one variable in one state."""
        for region, at, n in self.layout(state).regions[variable]:
            b = self._small(state, n, repr(self.variables[variable].name))
            yield region, Floats(self.container, Bytes(b.data, b.start + at, b.start + at + n))

    def regions(self, variable: int, state: int) -> Iterator[tuple[int, np.ndarray]]:
        """(region, flat float32 values) of one variable in one state."""
        for region, values in self.floats(variable, state):
            yield region, values.read()

    def _small(self, state: int, n: int, what: str) -> Bytes:
        """The payload of a state of which ``n`` bytes are wanted; refused where they unfold from almost nothing."""
        b = self.payload(state)
        if b.streamed and n > _room(self.header, self.outline(max(self.states[state].mesh, 0))):
            say = f"damaged state: {n} bytes of {what}, more than its mesh has room for"
            raise InputError(say, self.container.where)
        return b

    def close(self) -> None:
        self.container.close()

    def __reduce__(self) -> tuple[Callable[[str, Marks], PlotFile], tuple[str, Marks]]:
        return _again, (str(self.container.path), self.container.data.marks)

    def __enter__(self) -> PlotFile:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def _again(path: str, marks: Marks) -> PlotFile:
    """The plotfile that another process has open; refused where another one has taken its place."""
    f = PlotFile(path)
    try:
        f.container.data.check(marks)
    except InputError:
        f.close()
        raise
    return f


def state_room(c: Container) -> int:
    """Bytes that a state of the last mesh in the file can fill at most."""
    h = header.read(c)
    at = next((b for b in reversed(c.blocks) if b.tag == tags.MESH), None)
    section = h.mesh if at is None else c.payload(at)
    return 0 if section is None else _room(h, meshes.outline(c, section, h))


def _room(h: header.Header, o: MeshOutline) -> int:
    """Every variable on every node, element, facet and line of every region, flags of the elements, the objects."""
    facets = [s.rows().size for s in (*o.surfaces, *o.edges)]
    regions = len(o.domains) + len(facets)
    rows = o.n_nodes + sum(d.count * d.width for d in o.domains) + sum(facets) + regions
    values = sum(v.values for v in h.variables)
    heads = 16 * len(h.variables) * (regions + 1)
    return 4 * rows * values + heads + 4 * o.n_elements + 2 * len(o.objects) + 4096


class _Walk:
    """Walks a state's blocks once and notes where everything is."""

    def __init__(self, f: PlotFile, b: Bytes) -> None:
        self.c = f.container
        self.b = b
        self.start = b.start
        self.at: list[int] = []  # offsets of all tags, sizes and variable numbers, and what stands there
        self.words: list[int] = []
        self.time = self.status = -1
        self.flags: tuple[int, int] | None = None
        self.objects: tuple[int, int] | None = None
        self.regions: list[list[tuple[int, int, int]]] = [[] for _ in f.variables]
        self.index: dict[str, list[int]] = {}
        self.seen: set[tuple[str, int, int]] = set()  # (section, variable, region) with data
        for i, v in enumerate(f.variables):
            self.index.setdefault(v.section, []).append(i)

    def layout(self) -> Layout:
        for tag, b in self._blocks(self.b):
            if tag == tags.STATE_HEADER:
                self._header(b)
            elif tag == tags.STATE_DATA:
                self._data(b)
            elif tag == tags.MESH_STATE:
                for k, v in self._blocks(b):
                    if k == tags.ELEMENT_STATE:
                        self.flags = self._span(v)
            elif tag == tags.OBJECTS_STATE:
                self.objects = self._span(b)
        if self.time < 0:
            raise InputError("a state has no time", self.c.where)
        at, kept = np.array(self.at), np.array(self.words, "u4")
        if (at % 4).any():  # words that never match make a state of odd layout be walked each time
            at, kept = np.empty(0, int), np.zeros(1, "u4")
        pieces, within = _pieces(at)
        regions = tuple(map(tuple, self.regions))
        return Layout(regions, self.time, self.status, self.flags, self.objects, pieces, within, kept)

    def _blocks(self, b: Bytes) -> Iterator[tuple[int, Bytes]]:
        for tag, inner in self.c.children(b, "state"):
            at = inner.start - self.start
            self.at += [at - 8, at - 4]
            self.words += [tag, inner.stop - inner.start]
            yield tag, inner

    def _span(self, b: Bytes) -> tuple[int, int]:
        return b.start - self.start, b.stop - b.start

    def _header(self, head: Bytes) -> None:
        for tag, b in self._blocks(head):
            if tag in (tags.STATE_HDR_TIME, tags.STATE_STATUS) and b.stop - b.start != 4:
                raise InputError("damaged state header", self.c.where)
            if tag == tags.STATE_HDR_TIME and self.time >= 0:
                raise InputError("damaged state: it has two times", self.c.where)
            if tag == tags.STATE_HDR_TIME:
                self.time = b.start - self.start
            elif tag == tags.STATE_STATUS:
                self.status = b.start - self.start

    def _data(self, data: Bytes) -> None:
        section_of = {tag: section for section, (_, tag) in tags.SECTIONS.items()}
        for tag, b in self._blocks(data):
            section = section_of.get(tag)
            if section is None:
                continue
            for kind, v in self._blocks(b):
                if kind == tags.STATE_VARIABLE:
                    self._variable(v, section)

    def _variable(self, variable: Bytes, section: str) -> None:
        number = 0
        mine = self.index.get(section, [])
        for tag, b in self._blocks(variable):
            if tag == tags.STATE_VAR_ID:
                number = self.c.word(b, "state variable")
                self.at.append(b.start - self.start)
                self.words.append(number)
            elif tag == tags.STATE_VAR_DATA:
                if not 1 <= number <= len(mine):
                    say = f"a state holds {section} variable {number} of {len(mine)}"
                    raise InputError(say, self.c.where)
                found = self.regions[mine[number - 1]]
                for region, r in self._blocks(b):
                    at, n = self._span(r)
                    if n % 4:
                        raise InputError("damaged state: values of odd size", self.c.where)
                    if n and (section, number, region) in self.seen:
                        say = f"damaged state: {section} variable {number} has data of region {region} twice"
                        raise InputError(say, self.c.where)
                    if n:
                        self.seen.add((section, number, region))
                        found.append((region, at, n))


def _pieces(at: np.ndarray) -> tuple[tuple[tuple[int, int], ...], np.ndarray]:
    """Pieces of a state that hold the words at these bytes, and the words' places in the pieces one after the other."""
    order = np.argsort(at, kind="stable")
    pieces: list[tuple[int, int]] = []
    within = np.empty(len(at), int)
    before = 0
    for k in order:
        a = int(at[k])
        if pieces and a - pieces[-1][1] <= _NEAR:
            pieces[-1] = (pieces[-1][0], max(pieces[-1][1], a + 4))
        else:
            before += (pieces[-1][1] - pieces[-1][0]) // 4 if pieces else 0
            pieces.append((a, a + 4))
        within[k] = before + (a - pieces[-1][0]) // 4
    return tuple(pieces), within
