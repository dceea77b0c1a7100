"""How values are spelt in a .feb file: numbers, integers, flags, choices, ids, and the errors where they are not.

All readers take the text, what it is the text of (``"<E>"``) and the place, and raise InputError with both.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from typing import TypeVar

from .source import InputError, Where

T = TypeVar("T")
LARGEST = 2**31 - 1  # of integers and ids: FEBio keeps them, and plotfiles store them, in 32 bits
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?", re.ASCII)
_NOT_FINITE = re.compile(r"[+-]?(?:nan|inf|infinity)", re.IGNORECASE)
TRUE, FALSE = frozenset(("true", "yes", "on")), frozenset(("", "false", "no", "off"))


def shown(text: str) -> str:
    """A value in quotes, cut to a length that a message bears."""
    text = text.strip()
    return repr(text if len(text) <= 60 else text[:57] + "...")


def near(word: str, known: Iterable[str]) -> str:
    """``; did you mean "..."?`` where a known word is close, else nothing."""
    from difflib import get_close_matches

    close = get_close_matches(word, list(known), 1, 0.75)
    return f'; did you mean "{close[0]}"?' if close else ""


def spells_number(text: str) -> bool:
    """True for what FEBio takes as a number rather than a formula, ``nan`` and ``inf`` among it."""
    t = text.strip()
    return _NUMBER.fullmatch(t) is not None or _NOT_FINITE.fullmatch(t) is not None


def number(text: str, what: str, where: Where | None) -> float:
    """A finite number."""
    t = text.strip()
    if _NUMBER.fullmatch(t) is not None:
        v = float(t)
        if math.isfinite(v):
            return v
        raise InputError(f"{what} must be a number that a double holds (up to 1.8e308), not {shown(t)}", where)
    finite = "finite " if _NOT_FINITE.fullmatch(t) is not None else ""
    raise InputError(f"{what} must be a {finite}number, not {shown(t)}", where)


def numbers(text: str, n: int | None, what: str, where: Where | None) -> tuple[float, ...]:
    """Finite numbers with commas or blanks between, ``n`` of them where that is said."""
    words = text.replace(",", " ").split()
    if n is not None and len(words) != n:
        raise InputError(f"{what} must be {n} numbers, not {len(words)} ({shown(text)})", where)
    return tuple(number(w, what, where) for w in words)


def integer(text: str, what: str, where: Where | None, least: int = -LARGEST) -> int:
    """A whole number of 32 bits, written with or without a decimal point."""
    v = number(text, what, where)
    if v != int(v):
        raise InputError(f"{what} must be an integer, not {shown(text)}", where)
    if not least <= v <= LARGEST:
        size = f"at least {least}" if v < least else f"at most {LARGEST}"
        raise InputError(f"{what} must be {size}, not {shown(text)}", where)
    return int(v)


def flag(text: str, what: str, where: Where | None) -> bool:
    """0 or 1, or a word (true, false, yes, no, on, off); other numbers count by their whole part, as in FEBio."""
    t = text.strip().lower()
    if t in TRUE or t in FALSE:
        return t in TRUE
    if _NUMBER.fullmatch(t) is None:
        raise InputError(f"{what} must be 0 or 1, not {shown(text)}", where)
    return int(number(t, what, where)) != 0


def choice(text: str, names: Mapping[str, T], what: str, where: Where | None) -> T:
    """What a word stands for; names are in lower case, capitals and blanks around do not count."""
    t = text.strip().lower()
    if t not in names:
        said = ", ".join(k for k in names if not k.isdigit())
        raise InputError(f"{what} must be one of {said}, not {shown(text)}{near(t, names)}", where)
    return names[t]


def label(text: str, what: str, where: Where | None) -> int:
    """The id of something: a whole number of 32 bits."""
    t = text.strip()
    if not re.fullmatch(r"[+-]?\d{1,18}", t, re.ASCII):
        raise InputError(f"{what} must be an id, a whole number, not {shown(text)}", where)
    v = int(t)
    if abs(v) > LARGEST:
        raise InputError(f"{what} is {t}: ids go up to {LARGEST}", where)
    return v
