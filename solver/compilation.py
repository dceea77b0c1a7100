"""What compiling costs this process: how many kernels, how many seconds, and who is told of it."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter

# called with an event of :class:`.run.Listener` and its text: ("compiling", kernel) before a kernel is compiled,
# ("warning", sentence) where machine code is not kept
hears: list[Callable[[str, str], object]] = []
_LOCK = threading.Lock()
_paused, _since, _seconds = 0, 0.0, 0.0
_making, _count = 0, 0


def tell(event: str, text: str) -> None:
    for hear in tuple(hears):
        hear(event, text)


@contextmanager
def paused() -> Iterator[None]:
    """The clock stands still: a kernel is being compiled, here or by a process that is waited for."""
    global _paused, _since, _seconds
    with _LOCK:
        _paused += 1
        if _paused == 1:
            _since = perf_counter()
    try:
        yield
    finally:
        with _LOCK:
            if _paused == 1:
                _seconds += perf_counter() - _since
            _paused -= 1


@contextmanager
def compiling(kernel: Callable[..., object]) -> Iterator[None]:
    """Around the making of a kernel; kernels made on its behalf, or at the same time, are part of it."""
    global _making, _count
    with paused():
        with _LOCK:
            _making += 1
            first = _making == 1
            _count += first
        try:
            if first:
                tell("compiling", f"{kernel.__module__.rpartition('.')[2]}.{kernel.__name__}")
            yield
        finally:
            with _LOCK:
                _making -= 1


def count() -> int:
    """Kernels compiled so far."""
    return _count


def seconds() -> float:
    """Seconds for which the clock has stood still so far."""
    if not _paused:
        return _seconds
    with _LOCK:
        return _seconds + (perf_counter() - _since if _paused else 0.0)


def now() -> float:
    """Seconds on a clock that stands still while kernels are compiled: what work takes once they are there."""
    return perf_counter() - (seconds() if _paused else _seconds)
