"""Entries of a TOML file, each read as what it must be, or refused by its name."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from febkit.model import InputError, Where
from febkit.model.values import near


def load(path: Path, what: str) -> tuple[dict[str, Any], Where]:
    """The tables of a TOML file, and where they stand. Raises InputError."""
    where = Where(str(path))
    try:
        return tomllib.loads(path.read_text(encoding="utf-8")), where
    except OSError as e:
        raise InputError(f"cannot open {what}: {e.strerror}", where) from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError) as e:
        raise InputError(f"not well-formed TOML: {e}", where) from None


def entry(where: Where, key: str, table: str = "") -> Where:
    """Where the file has an entry, first below the heading of its table; the file alone where it has none so spelt."""
    try:
        lines = Path(where.file).read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError):
        return where
    heads = [line.strip().strip("[] ") for line in lines]
    first = heads.index(table) if table in heads else 0
    for number, line in enumerate(lines[first:], first + 1):
        head, equals, _ = line.partition("=")
        if equals and head.strip().strip("\"'") == key:
            return Where(where.file, number)
    return where


class Entries:
    """A table of a file, which is ``what``: ``name`` is "" for the file itself. :meth:`only` refuses what it does not
    know."""

    def __init__(self, table: Mapping[str, Any], where: Where, name: str = "", what: str = "a study") -> None:
        self.given, self.where, self.name, self.what = table, where, name, what

    def only(self, known: Iterable[str]) -> None:
        known = sorted(known)
        for key in self.given:
            if key not in known:
                place = f"[{self.name}]" if self.name else self.what
                hint = near(key, known) or f"; it may have {', '.join(known)}"
                raise InputError(f"unknown entry {key!r} in {place}{hint}", self.at(key))

    def refuse(self, key: str, must: str) -> InputError:
        of = f" of [{self.name}]" if self.name else ""
        return InputError(f"{key}{of} must be {must}, not {self.given[key]!r}", self.at(key))

    def at(self, key: str) -> Where:
        """Where an entry stands: its first line below the table's heading."""
        return self.where if self.where.line else entry(self.where, key, self.name)

    def text(self, key: str, default: str) -> str:
        v = self.given.get(key, default)
        if not isinstance(v, str) or not v.strip():
            raise self.refuse(key, "a text")
        return v

    def choice(self, key: str, default: str, choices: Iterable[str]) -> str:
        v, choices = self.given.get(key, default), tuple(choices)
        if v not in choices:
            raise self.refuse(key, " or ".join(choices))
        return str(v)

    def flag(self, key: str, default: bool) -> bool:
        v = self.given.get(key, default)
        if not isinstance(v, bool):
            raise self.refuse(key, "true or false")
        return v

    def whole(self, key: str, default: int, least: int) -> int:
        v = self.given.get(key, default)
        if type(v) is not int or v < least:
            raise self.refuse(key, f"a whole number from {least} on")
        return v

    def positive(self, key: str, default: float) -> float:
        v = self.given.get(key, default)
        if isinstance(v, bool) or not isinstance(v, int | float) or not 0 < v < math.inf:
            raise self.refuse(key, "a number above 0")
        return float(v)

    def listed(self, key: str, default: list[Any]) -> list[Any]:
        """A list, or one thing that stands for a list of it."""
        v = self.given.get(key, default)
        if isinstance(v, Mapping) or v == []:
            raise self.refuse(key, "a list with something in it")
        return v if isinstance(v, list) else [v]

    def table(self, key: str) -> Entries:
        v = self.given.get(key, {})
        if not isinstance(v, Mapping):
            raise InputError(f"[{key}] must be a table, not {v!r}", self.at(key))
        return Entries(dict(v), self.where, key, self.what)
