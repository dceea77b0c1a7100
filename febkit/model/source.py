"""Where a piece of a model came from, and errors that say so."""

from __future__ import annotations

from collections.abc import Sequence

from febkit.record import value_record


@value_record
class Where:
    """A place in an input file: its name and line (0 where unknown)."""

    file: str = ""
    line: int = 0

    def __str__(self) -> str:
        return f"{self.file}:{self.line}" if self.line else self.file


class InputError(ValueError):
    """Bad input: what is wrong, where, and what to do. The CLI turns it into exit code 2."""

    def __init__(self, message: str, where: Where | None = None) -> None:
        self.where = where
        self.message = message
        super().__init__(f"{where}: {message}" if where and str(where) else message)


class UnsupportedError(InputError):
    """A feature that febkit does not solve, refused by name before anything is solved."""


def together(found: Sequence[InputError]) -> InputError:
    """One error that says the first of several and lists the others, a dozen at most."""
    more = [f"  {e}" for e in found[1:12]]
    if len(found) > 12:
        more.append(f"  and {len(found) - 12} more")
    text = "\n".join([found[0].message, *(["also:", *more] if more else [])])
    return type(found[0])(text, found[0].where)
