"""Machine code that came with the wheel: a shared library for each level of processors, made by :mod:`.build`.

A function's name holds the hash of the sources it was made of, so what was edited since is not found. A library is
loaded if its file is what the build has made, by the checksum beside it.
"""

from __future__ import annotations

import ctypes
import hashlib
import os
import sys
from functools import lru_cache
from pathlib import Path

from .calls import level

FOLDER = Path(__file__).parent / "machine"
SUFFIX = {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")
LEVELS = ("x86-64-v2", "x86-64-v3", "x86-64-v4")  # each has all that the ones before have


def settings() -> list[str]:
    """numba's settings in the environment, but those that leave machine code as it is."""
    others = ("NUMBA_CACHE_DIR", "NUMBA_DISABLE_JIT", "NUMBA_NUM_THREADS", "NUMBA_THREADING_LAYER")
    return sorted(f"{k}={v}" for k, v in os.environ.items() if k.startswith("NUMBA_") and k not in others)


def address(name: str) -> int | None:
    """Where the function of this name is, or None."""
    library = _library()
    try:
        return ctypes.addressof(ctypes.c_char.in_dll(library, name)) if library else None
    except ValueError:
        return None


def listed(kernel: str) -> list[str]:
    """Lists of argument types for which the libraries hold this kernel ("kernels.vectors inner")."""
    return table().get(kernel, []) if _library() else []


@lru_cache(maxsize=1)
def _library() -> ctypes.CDLL | None:
    """The library of the best level that this processor has; none where numba's settings ask for other code."""
    own = level()
    if os.environ.get("FEBKIT_NATIVE") == "0" or settings():
        return None
    for name in reversed(LEVELS[: LEVELS.index(own) + 1]) if own in LEVELS else [own]:
        path = FOLDER / f"{name}{SUFFIX}"
        try:
            if path.with_suffix(".sha256").read_text() == hashlib.sha256(path.read_bytes()).hexdigest():
                return ctypes.CDLL(str(path))
        except OSError:  # not built, or not for this system
            continue
    return None


@lru_cache(maxsize=1)
def table() -> dict[str, list[str]]:
    """Kernels of ``shipped.txt`` and their lists of types."""
    found: dict[str, list[str]] = {}
    for line in Path(__file__).with_name("shipped.txt").read_text().splitlines():
        module, name, types = line.split(" ", 2)
        found.setdefault(f"{module} {name}", []).append(types)
    return found
