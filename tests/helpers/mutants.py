"""Damaged models through reading, checking and lowering: how each ends, in what time and memory."""

from __future__ import annotations

import dataclasses
import math
import random
import re
import signal
import sys
import time
import traceback
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from febkit.feb import read_bytes
from febkit.feb.validation import require
from febkit.lower import lower
from febkit.model import InputError

from .mutate import mutate

SLOWEST = 5.0  # s for one small model
LARGEST = 1 << 30  # bytes that one may take
VALUES = (
    b"nan", b"inf", b"-inf", b"1e309", b"1e308", b"-1", b"0", b"1", b"2", b"-0.0", b"1e-320", b"99999999999999999999",
    b"2147483647", b"2147483648", b"4294967297", b"-2147483649", b"1.5", b"text", b"", b" ", b"1,2", b"1,2,3",
    b"1,2,3,4", b"0,0,0", b"1,0,0", b"nan,0,0", b"true", b"1_0", b"0x10", b"1e3", b"x^2", b"1/0", b"sqrt(-1)",
    b"X*t", b"\xc2\xb2", b"top", b"@surface:top", b"1:5", b"1:9999999", b"biphasic", b"math", b"map", b"9**9**9",
    b"<x/>", b"12",
)  # fmt: skip
_TEXT = re.compile(rb"(?<=>)[^<>]{0,80}(?=</)")
_QUOTED = re.compile(rb'(?<==")[^"<>]{0,80}(?=")')
_ATTRIBUTE = re.compile(rb'\s[\w-]+="[^"<>]{0,80}"')
_LEAF = re.compile(rb"<(\w+)[^<>]*>[^<>]{0,80}</\1>")


def damaged(data: bytes, rng: random.Random) -> bytes:
    """A copy with values, attributes or leaves replaced or missing, now and then damaged in any other way."""
    if rng.random() < 0.15:
        return mutate(data, rng)
    for _ in range(rng.choice((1, 1, 1, 1, 2, 3))):
        way, by = rng.choice(_WAYS)
        found = list(way.finditer(data))
        if found:
            m = rng.choice(found)
            new = b"" if by == "drop" else m.group() * 2 if by == "twice" else rng.choice(VALUES)
            if by == "other":
                new = rng.choice(found).group()
            data = data[: m.start()] + new + data[m.end() :]
    return data


_WAYS = (
    (_TEXT, "value"), (_TEXT, "value"), (_TEXT, "value"), (_TEXT, "other"), (_QUOTED, "value"), (_QUOTED, "other"),
    (_ATTRIBUTE, "drop"), (_LEAF, "drop"), (_LEAF, "other"), (_LEAF, "twice"),
)  # fmt: skip


class TooLong(BaseException):
    """Not an Exception: nothing on the way may catch it."""


@contextmanager
def watchdog(seconds: float) -> Iterator[None]:
    """Raises TooLong in the main thread after a time, where the system has alarms."""
    if not hasattr(signal, "setitimer"):
        yield
        return

    def ring(*_: object) -> None:
        raise TooLong

    before = signal.signal(signal.SIGALRM, ring)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


@contextmanager
def memory(most: int) -> Iterator[None]:
    """Allocations beyond ``most`` more bytes than now raise MemoryError, where the system can say so."""
    if not sys.platform.startswith("linux"):
        yield
        return
    import resource

    with open("/proc/self/statm") as f:
        now = int(f.read().split()[0]) * resource.getpagesize()
    before = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (now + most, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, before)


def not_finite(thing: Any, name: str = "problem", seen: set[int] | None = None) -> str:
    """The path to a number of a lowered problem that is not finite, or ""."""
    seen = set() if seen is None else seen
    if isinstance(thing, float):
        return "" if math.isfinite(thing) else name
    if isinstance(thing, np.ndarray):
        return "" if thing.dtype.kind != "f" or np.isfinite(thing).all() else name
    if id(thing) in seen:
        return ""
    seen.add(id(thing))
    parts: Iterable[tuple[str, Any]] = ()
    if isinstance(thing, (list, tuple)):
        parts = ((f"{name}[{k}]", x) for k, x in enumerate(thing))
    elif isinstance(thing, dict):
        parts = ((f"{name}[{k!r}]", x) for k, x in thing.items())
    elif dataclasses.is_dataclass(thing):
        fields = (f.name for f in dataclasses.fields(thing) if f.name != "origin")  # the model as the file has it
        parts = ((f"{name}.{n}", getattr(thing, n, None)) for n in fields)
    return next(filter(None, (not_finite(x, n, seen) for n, x in parts)), "")


def attempt(data: bytes) -> str:
    """How a model ends: "refused" or "lowered"; raises what no user must see."""
    try:
        model = read_bytes(data, "mutant.feb")
        require(model)
        problem = lower(model)
    except InputError as e:
        text = str(e)
        if not e.message or len(e.message) > 4000:
            raise AssertionError(f"a message of {len(e.message)} letters") from None
        return "refused" if text.startswith("mutant.feb") else "refused without a place"
    bad = not_finite(problem)
    if bad:
        raise AssertionError(f"{bad} is not finite")
    return "lowered"


@dataclass
class Report:
    """Counts of endings, and the mutants that must not be: (what, mutant)."""

    ends: Counter[str] = field(default_factory=Counter)
    faults: list[tuple[str, bytes]] = field(default_factory=list)
    slowest: float = 0.0


def run(originals: Sequence[bytes], count: int, seed: int) -> Report:
    """``count`` mutants of the originals in turn."""
    rng, report = random.Random(seed), Report()
    for k in range(count):
        data = damaged(originals[k % len(originals)], rng)
        start = time.perf_counter()
        try:
            with watchdog(SLOWEST), memory(LARGEST):
                end = attempt(data)
        except TooLong:
            end = "too long"
        except MemoryError:
            end = "too large"
        except Exception as e:
            last = traceback.extract_tb(e.__traceback__)[-1]
            end = f"{type(e).__name__}: {str(e)[:120]} ({last.filename.rsplit('/', 2)[-1]}:{last.lineno})"
        report.slowest = max(report.slowest, time.perf_counter() - start)
        if end in ("refused", "lowered"):
            report.ends[end] += 1
        else:
            report.ends["fault"] += 1
            report.faults.append((end, data))
    return report
