"""SIGTERM and SIGHUP end a run as Ctrl-C does: the log and the plotfile are closed, what was saved stays."""

from __future__ import annotations

import signal
from types import FrameType

from . import exits

_received: list[int] = []


def watch() -> None:
    """Turn both into KeyboardInterrupt where nothing else is done with them (nohup ignores SIGHUP).

    The second one of a kind ends the process at once.
    """
    for name in ("SIGTERM", "SIGHUP"):
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) is signal.SIG_DFL:
            signal.signal(number, _stop)


def _stop(number: int, frame: FrameType | None) -> None:
    signal.signal(number, signal.SIG_DFL)
    _received.append(number)
    raise KeyboardInterrupt


def exit_code() -> int:
    """That of the interruption: 130 for Ctrl-C, 143 for SIGTERM, 129 for SIGHUP."""
    return exits.signalled(_received[0]) if _received else exits.INTERRUPTED
