"""Files below a folder that this process holds open, whatever else it has opened or closes meanwhile."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

PROC = Path("/proc/self/fd")
listed = pytest.mark.skipif(not PROC.is_dir(), reason="reads descriptors where /proc lists them")


def held(folder: Path) -> list[str]:
    """Where this process's descriptors lead, those below ``folder``; one that leads to a removed file counts too."""
    found = []
    for fd in os.listdir(PROC):
        try:
            found.append(os.readlink(PROC / fd))
        except OSError:  # that of the listing itself, or closed since
            continue
    return sorted(p for p in found if Path(p).is_relative_to(folder.resolve()))
