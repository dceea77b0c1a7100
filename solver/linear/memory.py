"""Memory that a factorisation may take: what the machine, or the container this process runs in, has left."""

from __future__ import annotations

import sys
from pathlib import Path

SHARE = 0.9  # of what is left, that a factor may fill
CGROUP = Path("/sys/fs/cgroup")
_LIMITS = (
    ("memory.max", "memory.current", "memory.stat"),
    ("memory/memory.limit_in_bytes", "memory/memory.usage_in_bytes", "memory/memory.stat"),
)


def available() -> float:
    """Bytes that can be taken without swapping; infinity where nobody says."""
    if sys.platform == "win32":
        return _windows()
    return min(_machine(), _container())


def _machine() -> float:
    """What Linux reckons it can hand out (MemAvailable of /proc/meminfo)."""
    try:
        lines = Path("/proc/meminfo").read_text(encoding="ascii").splitlines()
    except OSError:
        return float("inf")
    known = [float(line.split()[1]) * 1024 for line in lines if line.startswith("MemAvailable:")]
    return known[0] if known else float("inf")


def _container() -> float:
    """What the limit of a control group leaves; pages of files that may be dropped count as left."""
    for limit, used, stat in _LIMITS:
        try:
            left = float((CGROUP / limit).read_text()) - float((CGROUP / used).read_text())
            parts = dict(line.split() for line in (CGROUP / stat).read_text().splitlines())
        except (OSError, ValueError):  # not there, or "max"
            continue
        return left + float(parts.get("inactive_file", 0))
    return float("inf")


def _windows() -> float:
    import ctypes

    class Status(ctypes.Structure):
        _fields_ = [("length", ctypes.c_ulong), ("load", ctypes.c_ulong)] + [
            (name, ctypes.c_ulonglong) for name in ("total", "free", "page", "page_free", "virtual", "left", "more")
        ]  # fmt: skip

    status = Status()
    status.length = ctypes.sizeof(status)
    known = ctypes.windll.kernel32.GlobalMemoryStatusEx(ctypes.byref(status))  # type: ignore[attr-defined,unused-ignore]
    return float(status.free) if known else float("inf")
