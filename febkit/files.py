"""How files are written: beside their place, and put there whole by a rename, so that nothing is half written or lost.

:func:`written` is for what is written in one go: a failure, a full disk or a kill leaves what was there.
:class:`Output` is for what grows while a run goes on: it takes the place of an earlier file when it is worth more,
and grows on in that place. Readers of the earlier file keep that file's contents (on Windows, where a file that is
open cannot be replaced, they must close it first). One writer at a time: a lock on the file itself, which goes with
its process, so that no lock file is ever left.
"""

from __future__ import annotations

import errno
import os
import re
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from hashlib import sha256
from io import FileIO
from itertools import count
from pathlib import Path
from typing import BinaryIO

from febkit.model.source import InputError, Where

PathLike = str | os.PathLike[str]
Mark = tuple[int, str]  # bytes of a file, and what tells them from others
Named = tuple[str, PathLike, Where | None]  # what a file is called in messages, its path, where it was asked for

_WINDOWS = os.name == "nt"
_FLAGS = getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_BINARY", 0) | getattr(os, "O_NOFOLLOW", 0)
_NAME_MAX = 255  # bytes of a file's name on every file system in use
_JOINED = 1 << 16  # parts smaller than this are put together before they are written
_COPIED = 1 << 24  # bytes that are copied at a time
_numbers = count()


def real(path: PathLike) -> Path:
    """The file behind a path, its links followed: a link to a file stays a link when the file is replaced."""
    return Path(os.path.realpath(path))


def same(a: PathLike, b: PathLike) -> bool:
    """Whether two paths are one file: through links, by another spelling, or the same name that is not there yet."""
    try:
        return os.path.samefile(a, b)
    except OSError:
        return os.path.normcase(real(a)) == os.path.normcase(real(b))


_WRITTEN = "which the same call writes"


def keep_apart(outputs: Iterable[Named], inputs: Iterable[Named]) -> None:
    """Refuse to write onto a file that the same call reads, or two outputs into one file."""
    taken = [(what, path, "which the same call reads") for what, path, _ in inputs]
    for what, path, where in outputs:
        if _special(real(path)):
            continue
        for other, its, how in taken:
            if same(path, its):
                if (other, how) == (what, _WRITTEN):
                    raise InputError(f"{_at(path, where)}another {what} of the same call is written to this file: give "
                                     "one of them another name", where)  # fmt: skip
                name = "" if os.fspath(its) == os.fspath(path) else f" {os.fspath(its)}"
                raise InputError(f"{_at(path, where)}this is the {other}{name}, {how}: give the {what} another name",
                                 where)  # fmt: skip
        taken.append((what, path, _WRITTEN))


def may_write(path: PathLike, overwrite: bool = True, where: Where | None = None) -> None:
    """Refuse, before anything is computed, what cannot be written."""
    target = real(path)
    if target.is_dir():
        raise InputError(f"{_at(path, where)}this is a folder: give the name of a file in it", where)
    if _special(target):
        return
    if not target.parent.is_dir():
        raise InputError(f"{_at(path, where)}the folder {target.parent} does not exist", where)
    if not overwrite and os.path.lexists(target):
        raise InputError(f"{_at(path, where)}this file exists already: replace it with --force, or give another name",
                         where)  # fmt: skip
    if not os.access(target.parent, os.W_OK):
        raise InputError(f"{_at(path, where)}nothing can be written in the folder {target.parent}", where)


def is_ours(path: PathLike, what: str, where: Where | None = None) -> None:
    """Refuse to replace a file that no run has written by one of a run: a key of ``_MARKS``."""
    target = real(path)
    if not target.is_file():
        return
    with open(target, "rb") as f:
        head = f.read(4096)
    if head and not re.match(_MARKS[what], head):
        raise InputError(f"{_at(path, where)}this file exists already and is no {what}; a run replaces nothing but "
                         "results: give another name, or remove it", where)  # fmt: skip


_MARKS = {
    "plotfile": rb"BEF\0|\0FEB",
    "log": rb"febkit | \*  WARNING|(?s:.*)={20}",  # FEBio's begins with a frame
    "checkpoint": rb"febkit checkpoint ",
    "data file": rb"\s*(\*Step|[-+.\d])",
}


def _at(path: PathLike, where: Where | None) -> str:
    """The file that a message is about; with a place in a model its name stands in quotes behind that."""
    return f'"{os.fspath(path)}": ' if where else f"{os.fspath(path)}: "


def _special(target: Path) -> bool:
    """A device or a pipe, such as /dev/null: written as it is."""
    return target.exists() and not target.is_file() and not target.is_dir()


def stamp(path: PathLike) -> tuple[int, int, int] | None:
    """What tells a file from one that has taken its place (device, inode) or was rewritten there (time); None where
    there is none."""
    try:
        s = os.stat(path)
    except OSError:
        return None
    return s.st_dev, s.st_ino, s.st_mtime_ns


# ---- in one go -----------------------------------------------------------------------------------


@contextmanager
def written(path: PathLike, overwrite: bool = True) -> Iterator[Path]:
    """A path to write to, which becomes ``path`` when the block ends without an error.

    It has the ending of ``path``. Raises InputError where ``path`` exists and ``overwrite`` is False, or where a run
    writes to it; OSError that names ``path`` where writing fails.
    """
    may_write(path, overwrite)
    target = real(path)
    if _special(target):
        yield Path(path)
        return
    _refuse_busy(target, path)
    temp = _beside(target, f".{os.getpid()}-{next(_numbers)}")
    with _named(path):
        os.close(os.open(temp, os.O_WRONLY | os.O_CREAT | os.O_EXCL | _FLAGS, 0o666))
    try:
        with _named(path, temp):
            yield temp
            _settle(temp, target, path, overwrite)
    finally:
        temp.unlink(missing_ok=True)


def put(path: PathLike, data: bytes, overwrite: bool = True) -> None:
    """Write a whole file."""
    with written(path, overwrite) as temp:
        temp.write_bytes(data)


def _settle(temp: Path, target: Path, path: PathLike, overwrite: bool) -> None:
    if not overwrite:
        try:
            os.link(temp, target)
            return
        except FileExistsError:
            may_write(path, overwrite=False)
        except OSError:  # a file system without links
            may_write(path, overwrite=False)
    elif target.exists():
        _like(temp, target)
        with open(temp, "rb+") as f:
            os.fsync(f.fileno())
    os.replace(temp, target)


@contextmanager
def _named(path: PathLike, temp: Path | None = None) -> Iterator[None]:
    """Errors of the system name the file that was meant."""
    try:
        yield
    except OSError as e:
        about = None if e.filename is None else str(e.filename)
        if e.errno is None or about not in (None, str(path), str(temp)):
            raise
        raise OSError(e.errno, e.strerror, os.fspath(path)) from None


def _like(temp: Path, target: Path) -> None:
    """The permissions of the file that is replaced."""
    with suppress(OSError):
        os.chmod(temp, target.stat().st_mode & 0o7777)


def _beside(target: Path, tag: str = "") -> Path:
    """A hidden name in the same folder, of the same ending."""
    name = f".febkit{tag}.{target.name}"
    if len(os.fsencode(name)) > _NAME_MAX:
        name = f".febkit{tag}.{sha256(os.fsencode(target.name)).hexdigest()[:16]}{target.suffix[-16:]}"
    return target.with_name(name)


# ---- while a run goes on ---------------------------------------------------------------------------


class Output:
    """A growing file, written beside ``path`` until :meth:`place` puts it there, where it grows on.

    Raises InputError where it cannot be written, or where another run writes to ``path``.
    """

    def __init__(self, path: PathLike, where: Where | None = None, mark: Mark | None = None) -> None:
        may_write(path, where=where)
        self.path = os.fspath(path)
        self.target = real(path)
        self.temp = _beside(self.target)
        self.size = 0
        self.placed = special = _special(self.target)
        with _named(path):
            self._file = FileIO(self.path, "w") if special else FileIO(self._open(where), "w")
        if mark is not None and not special:
            try:
                self._take_over(mark)
            except BaseException:
                self.discard()
                raise

    def _take_over(self, mark: Mark) -> None:
        """Begin with what stood in place at ``mark``; the file in place stays as it is until :meth:`place`."""
        size, tail = mark
        with _named(self.path), open_or_refuse(self.target, self.path) as f:
            if _tail(f, size) != tail:
                raise InputError(f"{self.path}: this is not the file that the checkpoint goes on with, or it was cut: "
                                 "put that back, or start anew without --resume")  # fmt: skip
            f.seek(0)
            while self.size < size:
                self.write(f.read(min(size - self.size, _COPIED)))

    def mark(self) -> Mark | None:
        """Put the file in place, through to the disk; how far it stands (None: a device), to go on from there."""
        self.place()
        if _special(self.target):
            return None
        with _named(self.path), open(self.target, "rb") as f:
            os.fsync(self._file.fileno())
            return self.size, _tail(f, self.size)

    def begins(self, data: bytes) -> bool:
        """Does the file in place begin so?"""
        with open(self.target, "rb") as f:
            return f.read(len(data)) == data

    @property
    def replaces(self) -> bool:
        """Whether an earlier file would be lost by :meth:`place`."""
        return not self.placed and self.target.exists()

    def _open(self, where: Where | None) -> int:
        """The file beside, locked. Its lock goes with it when it is put in place, so that whoever finds no file
        beside still finds a lock on the one in place."""
        while True:
            fd = os.open(self.temp, os.O_RDWR | os.O_CREAT | _FLAGS, 0o666)
            try:
                if not lock(fd):
                    raise _busy(self.path, fd, where)
                if _still(fd, self.temp):  # else its owner has moved or removed it meanwhile
                    os.ftruncate(fd, 0)
                    _refuse_busy(self.target, self.path, where)
                    return fd
            except BaseException:
                if _still(fd, self.temp) and lock(fd):
                    self.temp.unlink(missing_ok=True)
                os.close(fd)
                raise
            os.close(fd)

    def write(self, *parts: bytes) -> None:
        """Append, all or nothing: where the disk is full the file ends where it ended before."""
        try:
            size = sum(map(len, parts))
            for piece in (b"".join(parts),) if 0 < size <= _JOINED else _pieces(parts):
                view = memoryview(piece)
                while view:
                    view = view[self._file.write(view) :]
        except BaseException as e:
            if not _special(self.target):
                with suppress(OSError):
                    self._file.truncate(self.size)
                    self._file.seek(self.size)
            if isinstance(e, OSError):
                raise OSError(e.errno, e.strerror, self.path) from None
            raise
        self.size += size

    def place(self) -> None:
        """Put the file in place, over an earlier one."""
        if self.placed:
            return
        with _named(self.path, self.temp):
            if self.target.exists():
                _like(self.temp, self.target)
                os.fsync(self._file.fileno())
            if _WINDOWS:  # a file that is open has a fixed name
                self._file.close()
            os.replace(self.temp, self.target)
            if _WINDOWS:
                self._file = FileIO(self.target, "r+")
                self._file.seek(self.size)
                lock(self._file.fileno())
        self.placed = True

    def close(self) -> None:
        """Put the file in place and end it."""
        if not self._file.closed:
            self.place()
            self._file.close()

    def discard(self) -> None:
        """End the file; where it is not in place yet, what was there before stays."""
        if self._file.closed:
            return
        if not self.placed and not _WINDOWS:
            self.temp.unlink(missing_ok=True)
        self._file.close()
        if not self.placed and _WINDOWS:
            self.temp.unlink(missing_ok=True)


def open_or_refuse(target: Path, path: str) -> BinaryIO:
    """A result that a run goes on with."""
    try:
        return open(target, "rb")
    except FileNotFoundError:
        raise InputError(f"{path}: this file of the run is not there any more: put it back, or start anew without "
                         "--resume") from None  # fmt: skip


def _tail(f: BinaryIO, size: int) -> str:
    """What tells the first ``size`` bytes of a file from others: their last ones."""
    f.seek(max(size - _JOINED, 0))
    return sha256(f.read(min(size, _JOINED))).hexdigest()


class Buffer:
    """The same in memory, ``data``."""

    replaces = False

    def __init__(self) -> None:
        self.data = bytearray()

    def mark(self) -> None:
        """Nothing to go on from is left of it."""

    def begins(self, data: bytes) -> bool:
        return self.data.startswith(data)

    def write(self, *parts: bytes) -> None:
        for p in parts:
            self.data += p

    def place(self) -> None: ...

    def close(self) -> None: ...

    def discard(self) -> None:
        self.data.clear()


def _pieces(parts: Iterable[bytes]) -> Iterator[bytes]:
    """Small parts put together, large ones as they are."""
    small: list[bytes] = []
    size = 0
    for p in parts:
        if size and size + len(p) > _JOINED:
            yield b"".join(small)
            small, size = [], 0
        if len(p) > _JOINED:
            yield p
        else:
            small.append(p)
            size += len(p)
    if size:
        yield b"".join(small)


def _still(fd: int, path: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(fd), os.stat(path))
    except OSError:
        return False


# ---- locks -----------------------------------------------------------------------------------------


def lock(fd: int, shared: bool = False) -> bool:
    """Lock an open file until it is closed; False where another holds it. True where there are no locks."""
    try:
        import fcntl
    except ImportError:
        return _lock_windows(fd)
    try:
        fcntl.flock(fd, (fcntl.LOCK_SH if shared else fcntl.LOCK_EX) | fcntl.LOCK_NB)
    except OSError as e:
        return e.errno not in (errno.EWOULDBLOCK, errno.EAGAIN, errno.EACCES)
    return True


def _lock_windows(fd: int) -> bool:
    import msvcrt

    at = os.lseek(fd, 0, os.SEEK_CUR)
    os.lseek(fd, 1 << 40, os.SEEK_SET)  # locked bytes cannot be read by others: one that no file has
    try:
        msvcrt.locking(fd, msvcrt.LK_NBLCK, 1)  # type: ignore[attr-defined,unused-ignore]
    except OSError:
        return False
    finally:
        os.lseek(fd, at, os.SEEK_SET)
    return True


def _refuse_busy(target: Path, path: PathLike, where: Where | None = None) -> None:
    if not target.is_file():
        return
    try:
        fd = os.open(target, os.O_RDONLY | _FLAGS)
    except OSError:
        return
    try:
        if not lock(fd, shared=True):
            raise _busy(path, fd, where)
    finally:
        os.close(fd)


def _busy(path: PathLike, fd: int, where: Where | None = None) -> InputError:
    pid = _holder(os.fstat(fd).st_ino)
    who = "this process" if pid == os.getpid() else f"process {pid}" if pid else "another process"
    return InputError(f"{_at(path, where)}{who} is writing to this file: wait for it, or give another name", where)


def _holder(inode: int) -> int:
    """The process that has locked a file, where the system tells; 0 where not."""
    try:
        with open("/proc/locks") as f:
            for line in f:
                words = line.split()
                if "FLOCK" in words and "->" not in words and words[-3].endswith(f":{inode}"):
                    return max(int(words[-4]), 0)
    except (OSError, ValueError, IndexError):
        pass
    return 0
