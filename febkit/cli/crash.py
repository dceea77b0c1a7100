"""What happens when nobody foresaw it: one sentence, and a file that holds the traceback."""

from __future__ import annotations

import os
import sys
import tempfile
from traceback import format_exception

from . import exits, printing


def report(error: BaseException, args: list[str]) -> int:
    """Says where the traceback was written; the exit code."""
    text = _text(error, args)
    brief = " ".join(str(error).split())
    named = f"{type(error).__name__}: {brief}" if brief else type(error).__name__
    try:
        file, path = tempfile.mkstemp(".log", "febkit-crash-", text=True)
        with os.fdopen(file, "w", encoding="utf-8", errors="backslashreplace") as out:
            out.write(text)
    except OSError:
        print(text, file=sys.stderr)
        path = "the lines above this one"
    printing.fail(f"a fault of febkit itself ({_cut(named)}); please report it with what stands in {path}")
    return exits.UNFORESEEN


def _cut(text: str, most: int = 200) -> str:
    return text if len(text) <= most else text[: most - 3] + "..."


def _text(error: BaseException, args: list[str]) -> str:
    import platform

    from febkit._version import __version__

    lines = [f"febkit {__version__}, Python {platform.python_version()}, {platform.platform()}"]
    for name in ("numpy", "scipy", "numba", "lxml", "xarray", "meshio"):
        module = sys.modules.get(name)
        if module is not None:
            lines.append(f"{name} {getattr(module, '__version__', '?')}")
    lines += [f"arguments: {args!r}", "", *format_exception(error)]
    return "\n".join(lines)
