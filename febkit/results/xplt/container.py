"""A plotfile as an index of blocks: nothing else of it is read until it is touched."""

from __future__ import annotations

import os
import struct
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from febkit.model import InputError, Where

from . import tags
from .inflate import PIECE, Inflated
from .source import Held, Source

_HEAD = 128  # bytes of a packed block that are inflated when it is found
KEPT = 1 << 28  # bytes of an inflated block that are held at most; a larger one is read piece by piece
WHOLE = 1 << 19  # bytes of a plain block up to which it is read whole
_WORTH_A_LOOK = 1 << 26  # bytes that a packed block must claim before the mesh is asked what a state can hold
_DENSEST = 200  # bytes that a byte of a packed mesh can make: ids and coordinates are no run of zeros
_IN_STATE = (tags.STATE_HEADER, tags.STATE_DATA, tags.MESH_STATE, tags.OBJECTS_STATE)
_TOP = (tags.ROOT, tags.MESH, tags.STATE)


@dataclass(frozen=True, slots=True)
class Block:
    """A top-level block. ``packed``: "" plain, "block" tag and size are inside the zlib stream, "body"
    only the payload is compressed."""

    tag: int
    start: int  # first byte of the block in the file
    stop: int
    size: int  # bytes of the payload once inflated; -1 where only inflating it tells
    packed: str = ""
    head: bytes = b""  # first bytes of a packed payload, so that times cost no second inflation


@dataclass(frozen=True, slots=True)
class Bytes:
    """Readable bytes of one block's payload."""

    data: Source | bytes | Inflated
    start: int
    stop: int

    @property
    def streamed(self) -> bool:
        """Whether reading inflates: the payload is too large to be held."""
        return isinstance(self.data, Inflated)

    def flat(self) -> tuple[bytes, int]:
        """A buffer that holds these bytes, and where in it they start."""
        if isinstance(self.data, bytes):
            return self.data, self.start
        return self.data[self.start : self.stop], 0


class Container:
    """The open file and its top-level blocks; complete blocks only, so a growing file reads well."""

    def __init__(
        self, path: str | os.PathLike[str] | Held, room: Callable[[Container], int] | None = None
    ) -> None:
        """``room`` gives the bytes that a state of the mesh read so far can fill."""
        self.path = Path() if isinstance(path, Held) else Path(path)
        self.where = Where(str(self.path))
        self.room = room
        self.blocks: list[Block] = []
        self._held: tuple[Block, Bytes] | None = None
        self.data = path if isinstance(path, Held) else Source(path, self.where)
        self.size = len(self.data)
        try:
            self.order = self._magic()
            self.head = struct.Struct(self.order + "II")
            self._word = struct.Struct(self.order + "I")
            self._end = 4
            self.refresh()
        except BaseException:
            self.data.close()
            raise

    def _magic(self) -> str:
        if self.size < 4:
            raise InputError("not a plotfile: it has fewer than four bytes", self.where)
        for order in "<>":
            if struct.unpack(order + "I", self.data[0:4])[0] == tags.MAGIC:
                return order
        raise InputError("not an FEBio plotfile: the first four bytes are not its mark", self.where)

    @property
    def truncated(self) -> bool:
        """Bytes after the last complete block: a state that is still being written, or was cut."""
        return self._end < self.size

    @property
    def leftover(self) -> int:
        return self.size - self._end

    def unread(self) -> str | None:
        """What to say of bytes after the last complete block."""
        if not self.truncated:
            return None
        return (f"{self.path.name}: the last {self.leftover} bytes are no complete state and are left out: "
                "the run goes on, or the file was cut")

    def refresh(self) -> bool:
        """Index the blocks that were completed since; True where there are new ones."""
        self.size = self.data.look()
        count = len(self.blocks)
        at = self._end
        while at + 8 <= self.size:
            block = self._plain(at) or self._whole(at)
            if block is None:
                break
            self.blocks.append(block)
            at = block.stop
            if block.tag == tags.STATE and not block.packed:
                at = self._repeats(block)
        self._end = at
        self.data.remember(at)
        return len(self.blocks) > count

    def _plain(self, at: int) -> Block | None:
        tag, n = self.head.unpack(self.data[at : at + 8])
        if tag not in _TOP or at + 8 + n > self.size:
            return None
        if tag == tags.STATE and n >= 4:
            first = self._word.unpack(self.data[at + 8 : at + 12])[0]
            if first not in _IN_STATE and self._zlib_at(at + 8):
                head = Inflated(self.data, at + 8, at + 8 + n, self.where).head(_HEAD)
                return Block(tag, at, at + 8 + n, -1, "body", head)
        return Block(tag, at, at + 8 + n, n)

    def _repeats(self, block: Block) -> int:
        """States of equal size follow one another: find them in one strided look instead of one by one."""
        length = block.stop - block.start
        at, many = block.stop, 16
        while length >= 12:  # tag, size and the first word of the payload
            n = min(many, (self.size - at) // length)
            if n < 1:
                return at
            heads = self.data.rows(at, length, n, 12).view(self.order + "u4")
            first = self._word.unpack(self.data[block.start + 8 : block.start + 12])[0]
            same = (heads == (tags.STATE, length - 8, first)).all(axis=1)
            k = n if same.all() else int(np.argmin(same))
            starts = range(at, at + k * length, length)
            self.blocks += [Block(tags.STATE, s, s + length, length - 8) for s in starts]
            at += k * length
            if k < n:
                return at
            many *= 4
        return at

    def _zlib_at(self, at: int) -> bool:
        a, b = self.data[at : at + 2]
        return a & 0x0F == 8 and a >> 4 <= 7 and (a * 256 + b) % 31 == 0

    def _whole(self, at: int) -> Block | None:
        """A block that FEBio compressed together with its tag and size; None where it is cut short."""
        if not self._zlib_at(at):
            self._check_cut(at)
            return None
        stream = Inflated(self.data, at, self.size, self.where)
        head = stream.head(_HEAD)
        if len(head) < 8:
            return None
        tag, n = self.head.unpack_from(head)
        if tag not in (tags.STATE, tags.MESH):
            raise InputError(f"damaged at byte {at}: compressed data is no state of a plotfile", self.where)
        self._plausible(at, tag, n)
        end = stream.end(n + 8)
        if end is None:
            return None
        size, stop = end
        if size != n + 8:
            raise InputError(f"damaged at byte {at}: compressed data is no state of a plotfile", self.where)
        if tag == tags.MESH and n > max(_WORTH_A_LOOK, _DENSEST * (stop - at)):
            raise InputError(f"damaged at byte {at}: {stop - at} bytes unfold to a mesh of {n}", self.where)
        return Block(tag, at, stop, n, "block", head[8:])

    def _check_cut(self, at: int) -> None:
        """Raise unless the file ends within the block at ``at``, or in zeros that were never written over."""
        tag, n = self.head.unpack(self.data[at : at + 8])
        if tag in _TOP:
            last = self.blocks[-1] if self.blocks else None
            after = at + last.stop - last.start if last and last.tag == tag == tags.STATE else self.size
            if after + 8 <= self.size and self.head.unpack(self.data[after : after + 8])[0] == tags.STATE:
                say = f"a state of {n} bytes runs past the end of the file, but another follows at byte {after}"
                raise InputError(f"damaged at byte {at}: {say}", self.where)
            return
        if not any(self.data[i : min(i + PIECE, self.size)].strip(b"\0") for i in range(at, self.size, PIECE)):
            return
        raise InputError(f"damaged at byte {at}: {tag:#010x} is no block of a plotfile", self.where)

    def _plausible(self, at: int, tag: int, size: int) -> None:
        """Refuse a packed state that claims far more than the mesh and the variables can fill."""
        if tag != tags.STATE or size <= _WORTH_A_LOOK or self.room is None:
            return
        room = self.room(self)
        if size > 2 * room + _WORTH_A_LOOK:
            say = f"a state that unfolds to {size} bytes, where mesh and variables fill {room} at most"
            raise InputError(f"damaged at byte {at}: {say}", self.where)

    def payload(self, block: Block) -> Bytes:
        """The bytes of a block; the last one that was inflated or read whole is kept."""
        self.data.look()
        if not block.packed and block.stop - block.start > WHOLE:
            return Bytes(self.data, block.start + 8, block.stop)
        kept = self._held  # one look: another thread may replace it
        if kept is None or kept[0] is not block:
            self._held = kept = (block, self._inflate(block) if block.packed else self._read(block))
        return kept[1]

    def _read(self, block: Block) -> Bytes:
        return Bytes(self.data[block.start + 8 : block.stop], 0, block.stop - block.start - 8)

    def _inflate(self, block: Block) -> Bytes:
        head = 8 if block.packed == "block" else 0
        stream = Inflated(self.data, block.start + 8 - head, block.stop, self.where)
        size = block.size + head
        if size <= KEPT:  # or not known
            out = stream.whole(KEPT)
            if out is not None:
                return Bytes(out, head, len(out))
        if block.size < 0:
            most = None if self.room is None else 2 * self.room(self) + _WORTH_A_LOOK
            end = stream.end(most)
            if end is None:
                raise InputError(f"damaged at byte {block.start}: the compressed state is cut short", self.where)
            size = end[0]
            self._plausible(block.start, block.tag, size)
        return Bytes(stream, head, size)

    def children(self, b: Bytes, what: str) -> Iterator[tuple[int, Bytes]]:
        """The blocks inside a block; a block that runs over its parent's end is an error."""
        at = b.start
        while at < b.stop:
            if at + 8 > b.stop:
                raise InputError(f"damaged {what}: {b.stop - at} stray bytes", self.where)
            tag, n = self.head.unpack(b.data[at : at + 8])
            if at + 8 + n > b.stop:
                say = f"damaged {what}: block {tag:#010x} of {n} bytes runs over its end"
                raise InputError(say, self.where)
            yield tag, Bytes(b.data, at + 8, at + 8 + n)
            at += 8 + n

    def word(self, b: Bytes, what: str) -> int:
        """An unsigned integer."""
        if b.stop - b.start < 4:
            raise InputError(f"damaged {what}: an integer has {b.stop - b.start} bytes", self.where)
        return int(self._word.unpack(b.data[b.start : b.start + 4])[0])

    def words_at(self, b: Bytes, at: Sequence[tuple[int, int]], pick: np.ndarray) -> np.ndarray:
        """Words of ``b``: those of these pieces (first and last byte from its start), of which ``pick`` are kept."""
        raw = b"".join([b.data[b.start + first : b.start + last] for first, last in at])
        return np.asarray(np.frombuffer(raw, self.order + "u4")[pick])

    def words(self, b: Bytes) -> np.ndarray:
        """All integers of a block."""
        data, start = b.flat()
        return np.frombuffer(data, self.order + "i4", (b.stop - b.start) // 4, start)

    def floats(self, b: Bytes) -> np.ndarray:
        """All floats of a block."""
        data, start = b.flat()
        return np.frombuffer(data, self.order + "f4", (b.stop - b.start) // 4, start)

    def text(self, b: Bytes) -> str:
        """A string, stored either as u32 length + characters or as zero-padded characters."""
        raw = bytes(b.data[b.start : b.stop])
        if len(raw) >= 4 and self._word.unpack_from(raw)[0] == len(raw) - 4:
            raw = raw[4:]
        elif len(raw) >= 4 and raw[3] == 0 and self._word.unpack_from(raw)[0] < len(raw):
            raw = raw[4 : 4 + self._word.unpack_from(raw)[0]]
        return _decode(raw.split(b"\0")[0])

    def name64(self, b: Bytes) -> str:
        """Zero-padded characters, 64 at most."""
        raw = bytes(b.data[b.start : min(b.stop, b.start + tags.NAME_SIZE)])
        return _decode(raw.split(b"\0")[0])

    def close(self) -> None:
        self._held = None
        self.data.close()


def _decode(raw: bytes) -> str:
    try:
        return raw.decode()
    except UnicodeDecodeError:
        return raw.decode("latin-1")
