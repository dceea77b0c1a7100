"""Momentum supplies to the fluid by FEBio's type names; a file is read when its type is first asked for."""

from __future__ import annotations

from typing import Any

from ..registry import Registry

TYPES = {"active-const-supply": "constant"}
_all: Registry[Any] = Registry(__name__, TYPES)
register, known, load = _all.register, _all.known, _all.load
