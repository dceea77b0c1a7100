"""What verbs print: plain lines, warnings, failures and tables. Nothing is cut, nothing is read as markup."""

from __future__ import annotations

import os
import sys
import warnings
from contextlib import suppress
from typing import TYPE_CHECKING, Any, TextIO

import click

if TYPE_CHECKING:
    from collections.abc import Callable

    from febkit.metrics.tables import Table

STYLE: Callable[[Any], Any] = click.option(
    "--style", type=click.Choice(["text", "markdown", "csv"]), default="text", show_default=True,
    help="How tables are printed.",
)  # fmt: skip
# characters that steer a terminal, but tab and newline, as Python writes them
_CONTROL = {c: f"\\x{c:02x}" for c in (*range(32), *range(127, 160)) if c not in (9, 10)}


class Outlet:
    """A stream whose reader may leave (``febkit info m.xplt | head``): what is written afterwards goes nowhere.

    What a verb does, and its exit code, must not depend on who reads along.
    """

    def __init__(self, stream: TextIO, name: str) -> None:
        self._stream, self._name = stream, name

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def write(self, text: str) -> int:
        try:
            self._stream.write(text)
        except OSError as e:
            self._lost(e)
        return len(text)

    def flush(self) -> None:
        try:
            self._stream.flush()
        except OSError as e:
            self._lost(e)

    def _lost(self, e: OSError) -> None:
        """A full disk, unlike a reader that left, is told."""
        self._to_nowhere()
        if not isinstance(e, BrokenPipeError):
            raise OSError(e.errno, e.strerror, self._name) from None

    def _to_nowhere(self) -> None:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, self._stream.fileno())
        os.close(nowhere)
        with suppress(OSError):
            self._stream.flush()


def prepare() -> None:
    """Make stdout and stderr fit for names that are not UTF-8, for terminals that are ASCII, and for pipes."""
    for name in ("stdout", "stderr"):
        stream: Any = getattr(sys, name)
        if stream is None:  # closed by who started us: what is said goes nowhere
            stream = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115
        with suppress(AttributeError, ValueError, OSError):
            stream.reconfigure(errors="backslashreplace")
        setattr(sys, name, Outlet(stream, {"stdout": "standard output", "stderr": "standard error"}[name]))
    setattr(warnings, "showwarning", _showwarning)  # noqa: B010 (a library's warning is printed as our own are)


def _showwarning(message: Warning | str, *_: Any) -> None:
    """A library's warning without the place in its code."""
    warn(message)


def say(text: object = "", bold: str = "") -> None:
    """A line of the answer; ``bold`` is its beginning."""
    _line(sys.stdout, *([_styled(bold, sys.stdout, bold=True)] if bold else []), str(text))


def note(text: object) -> None:
    """A line beside the answer: what was written, what was assumed. On stderr: stdout may go to a program."""
    _line(sys.stderr, str(text))


def warn(text: object) -> None:
    """Something to look at; the verb goes on."""
    _line(sys.stderr, f"{_styled('warning:', sys.stderr, fg='yellow')} ", str(text))


def fail(text: object) -> None:
    """Why the verb ends."""
    _line(sys.stderr, "febkit: ", str(text))


def table(t: Table, style: str = "text") -> None:
    """A table; as text in bands of columns that a terminal is wide enough for, in files and pipes in one piece."""
    import shutil

    if style == "text":
        wide = shutil.get_terminal_size().columns if sys.stdout.isatty() else None
        print(_shown(t.text(wide)), flush=True)
    else:
        print(t.render(style), end="" if style == "csv" else "\n", flush=True)


def _line(stream: TextIO, *parts: str) -> None:
    """The last part is the text: what steers terminals is taken out of it."""
    *before, text = parts
    print("".join(before) + _shown(text), file=stream, flush=True)


def _shown(text: str) -> str:
    """Bytes of names that are not UTF-8, and what would steer a terminal, as Python writes them."""
    try:
        raw = text.encode("utf-8", "surrogateescape")
    except UnicodeEncodeError:
        raw = text.encode("utf-8", "backslashreplace")
    return raw.decode("utf-8", "backslashreplace").translate(_CONTROL)


def _styled(text: str, stream: TextIO, **style: Any) -> str:
    return click.style(text, **style) if stream.isatty() and not os.environ.get("NO_COLOR") else text
