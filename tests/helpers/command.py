"""The installed ``febkit`` command, started as a user starts it: a process of its own."""

from __future__ import annotations

import os
import subprocess
import sys
import sysconfig
from collections.abc import Mapping
from pathlib import Path
from typing import Any

FEBKIT = Path(sysconfig.get_path("scripts")) / ("febkit.exe" if sys.platform == "win32" else "febkit")


def febkit(
    *args: str | Path, folder: Path, env: Mapping[str, str] | None = None, timeout: float = 300.0, **options: Any
) -> subprocess.CompletedProcess[str]:
    """Run ``febkit *args`` in ``folder``; ``env`` is added to this process's environment.

    Not an error by itself: look at ``returncode``, ``stdout`` and ``stderr``.
    """
    command = [str(FEBKIT), *(str(a) for a in args)]
    return subprocess.run(
        command, cwd=folder, env={**os.environ, **(env or {})}, capture_output=True, text=True, timeout=timeout,
        check=False, **options,
    )  # fmt: skip
