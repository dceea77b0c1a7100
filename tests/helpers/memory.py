"""How much memory this process takes at most, from a moment on, whatever ran in it before."""

from __future__ import annotations

import resource
import sys
from pathlib import Path

STATUS, REFERENCES = Path("/proc/self/status"), Path("/proc/self/clear_refs")


def begin() -> int:
    """Forget the peak so far, where the system can (Linux); kB that are resident now."""
    try:
        REFERENCES.write_text("5")
    except OSError:
        return peak()
    return _status("VmRSS")


def peak() -> int:
    """kB that have been resident at most."""
    if STATUS.exists():
        return _status("VmHWM")
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return most // 1024 if sys.platform == "darwin" else most


def _status(name: str) -> int:
    line = next(q for q in STATUS.read_text().splitlines() if q.startswith(f"{name}:"))
    return int(line.split()[1])
