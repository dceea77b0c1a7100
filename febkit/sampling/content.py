"""The content of a model as an address: the same wherever it lies, another once anything of its meaning is edited."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from hashlib import sha256
from typing import Any

import numpy as np

from febkit.model import Where

_PLACES = ("file", "document")  # of a model: where it was read, and its text


def address(model: Any) -> str:
    """Of a model, or of a list of parts of one."""
    h = sha256()
    _feed(h, model)
    return h.hexdigest()[:32]


def _feed(h: Any, value: Any) -> None:
    if isinstance(value, np.ndarray):
        h.update(f"array {value.dtype.str} {value.shape} ".encode())
        h.update(value.tobytes())
    elif is_dataclass(value) and not isinstance(value, type):
        h.update(f"{type(value).__name__} ".encode())
        for f in fields(value):
            if f.name not in _PLACES and not isinstance(getattr(value, f.name), Where):
                h.update(f"{f.name} ".encode())
                _feed(h, getattr(value, f.name))
    elif isinstance(value, Mapping):
        for k in value:
            h.update(f"{k!r}: ".encode())
            _feed(h, value[k])
    elif isinstance(value, (tuple, list)):
        h.update(f"{len(value)} of ".encode())
        for v in value:
            _feed(h, v)
    else:
        h.update(f"{value!r} ".encode())
