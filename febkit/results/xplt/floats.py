"""Floats of a plotfile that are read when they are asked for, all or some of their rows."""

from __future__ import annotations

import sys
from dataclasses import dataclass

import numpy as np

from .container import Bytes, Container
from .source import Source

_NEAR = 1 << 12  # bytes between rows up to which they are read at once
_SPANS = 256  # pieces above which all is read
_NATIVE = "<" if sys.byteorder == "little" else ">"


@dataclass(frozen=True, slots=True)
class Floats:
    """Floats of one region of a variable in one state."""

    container: Container
    bytes: Bytes

    @property
    def size(self) -> int:
        return (self.bytes.stop - self.bytes.start) // 4

    def read(self) -> np.ndarray:
        """(size,) float32."""
        return self.container.floats(self.bytes)

    def into(self, out: np.ndarray) -> None:
        """Fill ``out``, an array of as many numbers."""
        plain = out.dtype == np.float32 and out.dtype.isnative and out.flags.c_contiguous
        if plain and isinstance(self.bytes.data, Source) and self.container.order == _NATIVE:
            self.bytes.data.into(self.bytes.start, out)
        else:
            out[...] = self.read().reshape(out.shape)

    def rows(self, rows: np.ndarray, width: int) -> np.ndarray:
        """(row, width): rows of ``width`` floats; of large states what lies far from them is not read."""
        data, start = self.bytes.data, self.bytes.start
        if not isinstance(data, Source):
            return np.asarray(self.read().reshape(-1, width)[rows])
        order = np.argsort(rows, kind="stable")
        at = rows[order]
        cuts = np.flatnonzero(np.diff(at) > max(_NEAR // (4 * width), 1)) + 1
        if len(cuts) >= _SPANS:
            return np.asarray(self.read().reshape(-1, width)[rows])
        out = np.empty((len(rows), width), np.float32)
        for mine in np.split(np.arange(len(rows)), cuts) if len(rows) else ():
            first, last = int(at[mine[0]]), int(at[mine[-1]])
            raw = np.frombuffer(data[start + 4 * width * first : start + 4 * width * (last + 1)],
                                self.container.order + "f4")  # fmt: skip
            out[order[mine]] = raw.reshape(-1, width)[at[mine] - first]
        return out
