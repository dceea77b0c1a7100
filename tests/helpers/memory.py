"""How much memory this process takes at most, from a moment on, whatever ran in it before."""

from __future__ import annotations

from febkit import process


def begin() -> int:
    """Forget the peak so far, where the system can (Linux); kB that are resident now."""
    process.forget_peak()
    return peak()


def peak() -> int:
    """kB that have been resident at most."""
    most = process.peak_memory()
    assert most is not None
    return round(1e3 * most)
