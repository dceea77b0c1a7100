"""Machine code on disk: where it is kept, whom it is taken from, and files that are whole or count as missing.

To load machine code is to run it. A folder of it counts only where the user owns it and nobody else can write to
it, and so does each file in it. A file begins with a checksum of its name and content: what is cut, damaged or
renamed counts as missing and is made again. Processes that make the same file at once wait for the first.
"""

from __future__ import annotations

import hashlib
import os
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from . import compilation

_MAGIC = b"febkit2\n"
_HEAD = len(_MAGIC) + hashlib.sha256().digest_size
WAIT = 60.0  # seconds for which another process is waited for: it may have been stopped in the middle
_said: set[str] = set()  # why machine code is not kept: one reason per process


def root() -> Path | None:
    """Folder of all machine code; ``FEBKIT_CACHE`` overrides the user's cache folder. None where there is no home."""
    own = os.environ.get("FEBKIT_CACHE")
    if own:
        return Path(own).absolute()
    with suppress(RuntimeError):  # the user has no home
        return _users_cache() / "febkit"
    return None


def _users_cache() -> Path:
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches"
    said = os.environ.get("XDG_CACHE_HOME", "")
    return Path(said) if os.path.isabs(said) else Path.home() / ".cache"


def read(path: Path) -> bytes | None:
    """What was written under this name, or None where there is no file, or none to be trusted."""
    try:
        if not _trusted(path.parent):
            return None
        with open(path, "rb") as f:
            data = b"" if _foreign(os.fstat(f.fileno())) else f.read()
    except OSError:
        return None
    body = data[_HEAD:]
    return body if data[:_HEAD] == _head(path, body) else None


def write(path: Path, body: bytes) -> None:
    """Keep ``body`` under this name, where that can be done: readers see the old file or the new one, whole."""
    import tempfile

    if not ready(path.parent):
        return
    try:
        handle, beside = tempfile.mkstemp(prefix=f"{path.stem}.", dir=path.parent)  # for this user alone
        try:
            with os.fdopen(handle, "wb") as f:
                f.write(_head(path, body) + body)
            os.replace(beside, path)
        except BaseException:
            os.unlink(beside)
            raise
    except OSError as e:
        if not path.is_file():  # else another process has put its own there and holds it open (Windows)
            _cannot(path.parent, e)


@contextmanager
def turn(path: Path) -> Iterator[None]:
    """One process at a time makes the file ``path``. Who waited looks for it again.

    The lock ends with the process that holds it; where files cannot be locked, all make their own.
    """
    beside, held = path.with_suffix(".lock"), None
    if ready(path.parent):
        with suppress(OSError):
            held = os.open(beside, os.O_RDWR | os.O_CREAT, 0o600)
            end = time.monotonic() + WAIT
            while not _locked(held) and time.monotonic() < end and not path.exists():
                time.sleep(0.02)
    try:
        yield
    finally:
        if held is not None:
            with suppress(OSError):  # Windows keeps the name of an open file
                os.unlink(beside)
            os.close(held)


def ready(folder: Path) -> bool:
    """Make the folder where it is not there; False where it cannot be made, or is not this user's alone."""
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        return _trusted(folder)
    except OSError as e:
        _cannot(folder, e)
        return False


def _trusted(folder: Path) -> bool:
    """Is the folder this user's alone? Raises OSError where it is not there."""
    why = _foreign(os.stat(folder))
    if why:
        _complain(f"machine code in {folder} is not used, as {why}")
    return not why


def _locked(handle: int) -> bool:
    """Take the lock of an open file; False where another process has it."""
    try:
        if sys.platform == "win32":
            import msvcrt

            msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
        else:
            import fcntl

            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except (BlockingIOError, PermissionError):
        return False
    return True


def unkept() -> None:
    """Say that there is no folder to keep machine code in."""
    _complain("machine code is not kept, as you have no home folder")


def keeps() -> bool:
    """Has machine code been kept so far, as far as there was any?"""
    return not _said


def _head(path: Path, body: bytes) -> bytes:
    return _MAGIC + hashlib.sha256(path.name.encode() + b"\0" + body).digest()


def _foreign(found: os.stat_result) -> str:
    """Why somebody else could have written here, or nothing. (Windows keeps a user's folders for that user.)"""
    if sys.platform == "win32":
        return ""
    if found.st_uid != os.geteuid():
        return "it belongs to another user"
    return "others can write to it" if found.st_mode & 0o022 else ""


def _cannot(folder: Path, e: OSError) -> None:
    _complain(f"machine code cannot be kept in {folder} ({e.strerror or e})")


def _complain(why: str) -> None:
    """Once per process: compiling in every process is slow, and no reason to fail."""
    message = f"{why}; kernels are compiled in every run. FEBKIT_CACHE may name a folder of your own"
    if _said:
        return
    _said.add(why)
    if compilation.hears:
        compilation.tell("warning", message)
    else:
        import warnings

        warnings.warn(message, RuntimeWarning, stacklevel=2)
