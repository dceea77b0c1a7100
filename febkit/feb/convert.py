"""The ladder of format versions: one step up or down at a time."""

from __future__ import annotations

from collections.abc import Callable

from febkit.model import InputError

from . import v12, v12_down, v20, v20_down, v25, v25_down, v30, v30_down
from .document import Tag

VERSIONS = ("1.2", "2.0", "2.5", "3.0", "4.0")
READ = ("1.0", "1.1", *VERSIONS)
_UP: dict[str, Callable[[Tag], None]] = {"1.2": v12.up, "2.0": v20.up, "2.5": v25.up, "3.0": v30.up}
_DOWN: dict[str, Callable[[Tag, list[str]], None]] = {
    "3.0": v25_down.down, "2.5": v20_down.down, "2.0": v12_down.down}


def up(root: Tag) -> None:
    """Raises a tree of any version to 4.0, in place."""
    version = root.need("version")
    if version not in READ:
        message = f'febio_spec version "{version}" is not known; known are {", ".join(READ)}'
        raise InputError(message, root.where)
    if version in ("1.0", "1.1"):
        root.attrs["version"] = "1.2"
    while root.attrs["version"] != "4.0":
        _UP[root.attrs["version"]](root)


def down(root: Tag, version: str) -> list[str]:
    """Lowers a 4.0 tree to ``version``, in place. Returns what that version cannot say."""
    if version not in VERSIONS:
        raise InputError(f'febio_spec version "{version}" is not written; known are {", ".join(VERSIONS)}')
    notes: list[str] = []
    while root.attrs["version"] != version:
        if root.attrs["version"] == "4.0":
            v30_down.down(root, notes, edges=version != "3.0")
        else:
            _DOWN[root.attrs["version"]](root, notes)
    return list(dict.fromkeys(notes))
