"""What a process that solves is set to, before it does."""

from __future__ import annotations

import os
import sys
from contextlib import suppress


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
