"""What a process that solves is set to, before it does, and how it ends."""

from __future__ import annotations

import atexit
import gc
import os
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import NoReturn


def one_blas_thread() -> None:
    """Have numpy's BLAS, if it is not loaded yet, use one thread: its matrices are small, the threads the solver's."""
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")


def keep_freed_memory() -> None:
    """Have glibc keep up to 256 MB that were freed, where the C library is glibc.

    Stresses and tangents of every iteration take arrays of the same sizes; given back to the system each time, a
    third of a solve's processor time went into the kernel's clearing of pages (``mallopt``, glibc manual).
    """
    if sys.platform != "linux":
        return
    import ctypes

    with suppress(AttributeError, OSError):
        mallopt = ctypes.CDLL(None).mallopt
        trim, map_above = -1, -3
        mallopt(trim, 256 << 20)
        mallopt(map_above, 32 << 20)


def forget_peak() -> None:
    """The peak of the memory begins anew, where the system can (Linux, proc(5))."""
    with suppress(OSError), open("/proc/self/clear_refs", "w") as references:
        references.write("5")


def peak_memory() -> float | None:
    """MB that were resident at most since :func:`forget_peak`, or since the process began where that can do nothing;
    None where the system does not tell (Windows)."""
    with suppress(OSError), open("/proc/self/status") as status:
        for line in status:
            if line.startswith("VmHWM:"):
                return round(int(line.split()[1]) / 1e3, 1)
    try:
        import resource
    except ImportError:
        return None
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return round(most / (1e6 if sys.platform == "darwin" else 1e3), 1)


@contextmanager
def nothing_collected() -> Iterator[None]:
    """What is imported and set up within stays: the garbage collector does not go through it, not until :func:`settled`
    nor, as far as it is there by then, after (it took a twentieth of a small run)."""
    gc.disable()
    try:
        yield
    finally:
        settled()


def settled() -> None:
    """From here on garbage is collected, of what is made from here on."""
    gc.freeze()
    gc.enable()


def leave(code: int) -> NoReturn:
    """End the process: at once where nobody asked to be told, else as Python does.

    Taking apart, object by object, what a process of one small model has imported is a sixth of its time.
    """
    asked = getattr(atexit, "_ncallbacks", lambda: 1)() or threading.active_count() > 1
    if asked or sys.gettrace() or sys.getprofile():
        sys.exit(code)
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError):
            stream.flush()
    os._exit(code)
