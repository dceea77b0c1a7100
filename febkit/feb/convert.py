"""The ladder of format versions: one step up or down at a time."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from febkit.model import InputError

from .document import Tag

VERSIONS = ("1.2", "2.0", "2.5", "3.0", "4.0")
READ = ("1.0", "1.1", *VERSIONS)
# version to leave -> the module that does it, imported when a file needs the step
_UP = {"1.2": "v12", "2.0": "v20", "2.5": "v25", "3.0": "v30"}
_DOWN = {"4.0": "v30_down", "3.0": "v25_down", "2.5": "v20_down", "2.0": "v12_down"}


def _step(name: str) -> Any:
    return import_module(f"{__package__}.{name}")


def up(root: Tag) -> None:
    """Raises a tree of any version to 4.0, in place."""
    version = root.need("version")
    if version not in READ:
        message = f'febio_spec version "{version}" is not known; known are {", ".join(READ)}'
        raise InputError(message, root.where)
    if version in ("1.0", "1.1"):
        root.attrs["version"] = "1.2"
    while root.attrs["version"] != "4.0":
        _step(_UP[root.attrs["version"]]).up(root)


def down(root: Tag, version: str) -> list[str]:
    """Lowers a 4.0 tree to ``version``, in place. Returns what that version cannot say."""
    if version not in VERSIONS:
        raise InputError(f'febio_spec version "{version}" is not written; known are {", ".join(VERSIONS)}')
    notes: list[str] = []
    while root.attrs["version"] != version:
        down = _step(_DOWN[root.attrs["version"]]).down
        if root.attrs["version"] == "4.0":
            down(root, notes, edges=version != "3.0")
        else:
            down(root, notes)
    return list(dict.fromkeys(notes))
