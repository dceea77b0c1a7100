"""zlib streams read piece by piece, so that what they unfold to need not be held whole."""

from __future__ import annotations

import threading
import zlib

from febkit.model import InputError, Where

from .source import Source

PIECE = 1 << 20  # bytes inflated at a time
_FEW = 1 << 12  # bytes of a stream that are enough for the first hundred that it unfolds to


class Inflated:
    """What the zlib stream in ``data[start:stop]`` unfolds to, by slices, as bytes.

    Going on from the last slice is cheap, going back begins anew. Safe for threads. Raises InputError where the
    stream is damaged, or ends before a slice does.
    """

    def __init__(self, data: Source | bytes, start: int, stop: int, where: Where) -> None:
        self._data, self._start, self._stop, self._where = data, start, stop, where
        self._lock = threading.Lock()
        self._rewind()

    def _rewind(self) -> None:
        self._z = zlib.decompressobj()
        self._raw = self._start  # next byte of the stream
        self._at = 0  # bytes unfolded and asked for
        self._ahead = b""  # unfolded, and not yet asked for

    def _unfold(self, raw: bytes, most: int) -> bytes:
        try:
            return self._z.decompress(raw, most)
        except zlib.error as e:
            raise InputError(f"damaged at byte {self._start}: {e}", self._where) from None

    def _more(self) -> bytes:
        """The next piece, empty where the stream ends or is cut."""
        while not self._z.eof:
            tail = self._z.unconsumed_tail
            last = not tail and self._raw >= self._stop
            if not tail and not last:
                tail = self._data[self._raw : min(self._raw + PIECE, self._stop)]
                self._raw += len(tail)
            out = self._unfold(tail, PIECE)
            if out or last:
                return out
        return b""

    def head(self, n: int) -> bytes:
        """The first ``n`` bytes, or fewer where the stream holds or shows no more."""
        with self._lock:
            self._rewind()
            out = self._unfold(self._data[self._start : min(self._start + _FEW, self._stop)], n)
            self._rewind()
            return out

    def whole(self, most: int) -> bytes | None:
        """All bytes, None where they are more than ``most``."""
        with self._lock:
            self._rewind()
            found, size = [], 0
            while size <= most and (piece := self._more()):
                found.append(piece)
                size += len(piece)
            whole = self._z.eof
            self._rewind()
        if size > most:
            return None
        if not whole:
            raise InputError(f"damaged at byte {self._start}: the compressed data are cut short", self._where)
        return b"".join(found)

    def end(self, most: int | None = None) -> tuple[int, int] | None:
        """(bytes it unfolds to, byte after the stream); None where it is cut. Stops once ``most`` are passed."""
        with self._lock:
            self._rewind()
            size = 0
            while (most is None or size <= most) and (piece := self._more()):
                size += len(piece)
            cut = not self._z.eof and (most is None or size <= most)
            used = self._raw - len(self._z.unused_data)
            self._rewind()
        return None if cut else (size, used)

    def __getitem__(self, key: slice) -> bytes:
        start, stop = int(key.start), int(key.stop)
        with self._lock:
            out = self._slice(start, stop)
        if len(out) != max(stop - start, 0):
            raise InputError(f"damaged at byte {self._start}: the compressed data are cut short", self._where)
        return out

    def _slice(self, start: int, stop: int) -> bytes:
        if start < self._at:
            self._rewind()
        found: list[bytes] = []
        while self._at < stop:
            piece = self._ahead or self._more()
            if not piece:
                break
            skip = min(max(start - self._at, 0), len(piece))
            take = piece[skip : skip + stop - max(start, self._at)]
            self._ahead = piece[skip + len(take) :]
            self._at += skip + len(take)
            if take:
                found.append(take)
        return found[0] if len(found) == 1 else b"".join(found)
