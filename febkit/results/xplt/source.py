"""The bytes of an open plotfile, and whether it is still the file that was opened."""

from __future__ import annotations

import os
import stat
import threading
import warnings
from collections.abc import Sequence
from contextlib import suppress
from typing import Any

import numpy as np

from febkit.model import InputError, Where

Marks = Sequence[tuple[int, bytes]]

_MARKS, _WIDTH = 16, 64  # places of a file that are remembered, and bytes of each
_SPARSE = 1 << 16  # bytes between rows above which each is read for itself
_CHUNK = 1 << 23


class Source:
    """A file's bytes by slices. It is read, not mapped: a program that cuts the file while it is open then causes an
    error in words, where touching a mapped page would end the process.

    A file that is exchanged for another (as febkit's own runs do) stays readable as it was; that it is no longer the
    one in its place is said once, as a warning. One that is rewritten in place is refused from then on.
    """

    def __init__(self, path: str | os.PathLike[str], where: Where) -> None:
        self._path, self._where = os.path.abspath(path), where
        self._marks: list[tuple[int, bytes]] = []
        self._end = 0
        self._fd = -1
        self._told = False
        self._lock = threading.Lock()
        try:
            flags = os.O_RDONLY | getattr(os, "O_BINARY", 0) | getattr(os, "O_NONBLOCK", 0)
            self._fd = os.open(path, flags)
        except OSError as e:
            raise InputError(f"cannot read the file: {e.strerror or e}", where) from None
        s = os.fstat(self._fd)
        if not stat.S_ISREG(s.st_mode):
            self.close()
            raise InputError("cannot read the file: it is no regular file", where)
        self._id = (s.st_dev, s.st_ino)
        self._seen = (s.st_size, s.st_mtime_ns)

    def __reduce__(self) -> tuple[Any, ...]:
        return again, (self._path, self._where, self._marks, self._end)

    def __len__(self) -> int:
        """Bytes when it was last looked at."""
        return self._seen[0]

    def __getitem__(self, key: slice) -> bytes:
        start, stop = int(key.start), int(key.stop)
        out = self._read(start, stop - start) if stop > start else b""
        if len(out) < stop - start:
            raise self._rewritten("became shorter")
        return out

    def _read(self, start: int, n: int) -> bytes:
        self._need_open()
        out = self._at(start, n)
        while 0 < len(out) < n:  # a signal, or more than the system reads at once
            more = self._at(start + len(out), n - len(out))
            if not more:
                break
            out += more
        return out

    def _at(self, start: int, n: int) -> bytes:
        if hasattr(os, "pread"):
            return os.pread(self._fd, n, start)
        with self._lock:
            os.lseek(self._fd, start, os.SEEK_SET)
            return os.read(self._fd, n)

    def into(self, start: int, out: np.ndarray) -> None:
        """Fill a contiguous array."""
        self._need_open()
        view = memoryview(out.reshape(-1).view(np.uint8).data)
        done = 0
        if hasattr(os, "preadv"):
            while done < len(view) and (n := os.preadv(self._fd, [view[done:]], start + done)):
                done += n
        if done < len(view):
            view[done:] = self[start + done : start + len(view)]

    def rows(self, start: int, step: int, n: int, width: int) -> np.ndarray:
        """(n, width) bytes, the first of each row ``step`` bytes behind that of the last."""
        if step > _SPARSE:
            raw = b"".join([self[a : a + width] for a in range(start, start + n * step, step)])
            return np.frombuffer(raw, np.uint8).reshape(n, width)
        out = np.empty((n, width), np.uint8)
        many = max(1, _CHUNK // step)
        for k in range(0, n, many):
            m, a = min(many, n - k), start + k * step
            raw = self[a : a + (m - 1) * step + width]
            out[k : k + m] = np.ndarray((m, width), np.uint8, raw, 0, (step, 1))
        return out

    # ---- still the same? ------------------------------------------------------------------------

    def look(self) -> int:
        """The file's size now. Raises InputError where it was rewritten since."""
        self._need_open()
        s = os.fstat(self._fd)
        if (s.st_size, s.st_mtime_ns) != self._seen:
            if s.st_size < self._end:
                raise self._rewritten("became shorter")
            self.check(self._marks)
            self._seen = (s.st_size, s.st_mtime_ns)
        if not self._told:
            self._warn_exchanged()
        return s.st_size

    def remember(self, end: int) -> None:
        """Note some of the first ``end`` bytes: a file that goes on growing keeps them, one that is written anew
        does not."""
        last = max(end - _WIDTH, 0)
        places = sorted({last * k // (_MARKS - 1) for k in range(_MARKS)})
        self._marks = [(at, self[at : min(at + _WIDTH, end)]) for at in places]
        self._end = end

    @property
    def marks(self) -> Marks:
        return self._marks

    def check(self, marks: Marks) -> None:
        """Raise unless these bytes still stand in the file."""
        if any(self._read(at, len(m)) != m for at, m in marks):
            raise self._rewritten("was written anew")

    def _rewritten(self, how: str) -> InputError:
        return InputError(f"the file {how} while it was open: open it again", self._where)

    def _warn_exchanged(self) -> None:
        try:
            s = os.stat(self._path)
        except OSError:  # removed; what was opened can still be read
            return
        if (s.st_dev, s.st_ino) != self._id:
            self._told = True
            say = "another file has taken its place since it was opened; these are still the values of the earlier one"
            warnings.warn(f"{self._where.file}: {say}: open it again for the new ones", stacklevel=2)

    def _need_open(self) -> None:
        if self._fd < 0:
            raise InputError("the file has been closed: open it again", self._where)

    def close(self) -> None:
        fd, self._fd = self._fd, -1
        if fd >= 0:
            os.close(fd)

    def __del__(self) -> None:
        with suppress(OSError, AttributeError):
            self.close()


class Held(Source):
    """Bytes in memory."""

    def __init__(self, data: bytes | bytearray) -> None:
        self._data = memoryview(data)

    def __reduce__(self) -> tuple[Any, ...]:
        return Held, (bytes(self._data),)

    def __len__(self) -> int:
        return len(self._data)

    def _read(self, start: int, n: int) -> bytes:
        return bytes(self._data[start : start + n])

    def into(self, start: int, out: np.ndarray) -> None:
        view = out.reshape(-1).view(np.uint8)
        view[:] = np.frombuffer(self._data, np.uint8, len(view), start)

    def look(self) -> int:
        return len(self)

    def remember(self, end: int) -> None: ...

    def check(self, marks: Marks) -> None: ...

    def close(self) -> None: ...


def again(path: str, where: Where, marks: Marks, end: int) -> Source:
    """The file that another process has open; refused where another one has taken its place."""
    source = Source(path, where)
    try:
        source.check(marks)
        source.remember(end)
    except InputError:
        source.close()
        raise
    return source
