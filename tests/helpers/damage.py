"""What may happen to a file of machine code."""

from __future__ import annotations

import random
from collections.abc import Callable


def _flip(data: bytes) -> bytes:
    at = random.Random(len(data)).randrange(len(data))
    return data[:at] + bytes([data[at] ^ 0x10]) + data[at + 1 :]


WAYS: dict[str, Callable[[bytes], bytes]] = {
    "empty": lambda data: b"",
    "cut": lambda data: data[: len(data) // 2],
    "no end": lambda data: data[:-1],
    "zeros": lambda data: bytes(len(data)),
    "one bit": _flip,
}
