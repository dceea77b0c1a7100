"""Which file holds which material: FEBio's type name -> module and class, so that only what is used is imported.

A new material is one file whose last line is ``register(Class, "type")`` and one line in ``tables.py``.
"""

from __future__ import annotations

from functools import lru_cache
from importlib import import_module
from keyword import iskeyword
from typing import Any, TypeVar

from ..registry import Registry

T = TypeVar("T", bound=type)


def tables() -> dict[str, dict[str, str]]:
    """table -> FEBio type -> "module:Class".

    Not a static import: the compiled kernels are kept under a hash of the files they import, and a new
    line in the table must not renew them all.
    """
    table: dict[str, dict[str, str]] = import_module(".tables", __package__).TABLES
    return table


def field_name(tag: str) -> str:
    """The record's field for a tag of the file."""
    name = tag.replace(" ", "_").replace("-", "_")
    return name + "_" if iskeyword(name) or name in ("density", "cdf") else name


def tag_name(field: str) -> str:
    """The file's tag for a field of a record."""
    return field.removesuffix("_")


@lru_cache(maxsize=None)
def _of(table: str) -> Registry[Any]:
    return Registry(__package__, {t: where.partition(":")[0] for t, where in tables().get(table, {}).items()})


def known(table: str, febio_type: str) -> bool:
    return _of(table).known(febio_type)


def load(table: str, febio_type: str) -> Any:
    """The class of a material type; KeyError where there is none."""
    return _of(table).load(febio_type)


def register(cls: T, febio_type: str, table: str = "solid") -> T:
    """Say at the foot of a file which FEBio type its class is; the table must agree."""
    listed = tables()[table].get(febio_type, "")
    if listed.partition(":")[2] != cls.__name__:
        raise LookupError(f"{table} '{febio_type}': the table says {listed!r}, not {cls.__name__}")
    _of(table).register(cls, febio_type)
    return cls
