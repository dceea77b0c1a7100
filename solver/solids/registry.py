"""Which file holds which material: FEBio's type name -> module and class, so that only what is used is imported.

A new material is one file whose last line is ``register(Class, "type")`` and one line in ``tables.py``.
"""

from __future__ import annotations

from importlib import import_module
from keyword import iskeyword
from typing import Any, TypeVar

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


def known(table: str, febio_type: str) -> bool:
    return febio_type in tables().get(table, {})


def load(table: str, febio_type: str) -> Any:
    """The class of a material type; KeyError where there is none."""
    module, name = tables()[table][febio_type].split(":")
    return getattr(import_module(f".{module}", __package__), name)


def register(cls: T, febio_type: str, table: str = "solid") -> T:
    """Say at the foot of a file which FEBio type its class is; the table must agree."""
    here = f"{cls.__module__.removeprefix(f'{__package__}.')}:{cls.__name__}"
    listed = tables()[table].get(febio_type)
    if listed != here:
        raise LookupError(f"{table} '{febio_type}': the table says {listed}, not {here}")
    return cls
