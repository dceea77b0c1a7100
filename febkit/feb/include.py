"""Other files that a model pulls in: <Include> and ``from=`` (versions 2.0 and later).

Only files inside the model's own folder are opened; anything else is refused. Their number and size are bounded in
all, as a few files that include each other twice would be read millions of times.
"""

from __future__ import annotations

from pathlib import Path
from stat import S_ISREG

from febkit.model import InputError

from .document import Tag, parse

MAX_FILES = 500  # all inclusions together
MAX_BYTES = 4 * 2**30  # and what they hold


def resolve(root: Tag, file: str) -> None:
    """Puts the sections of included files where they are asked for, in place."""
    folder = Path(file).resolve().parent if file else None
    _Includes(folder).resolve(root, [Path(file).resolve()] if file else [])


def contents(path: Path) -> bytes:
    """The bytes of a regular file; OSError for a pipe or a device, which may never end."""
    if not S_ISREG(path.stat().st_mode) and not path.is_dir():
        raise OSError(None, "it is no regular file")
    return path.read_bytes()


class _Includes:
    """Opens included files and counts them."""

    def __init__(self, folder: Path | None) -> None:
        self.folder, self.files, self.bytes = folder, 0, 0

    def resolve(self, root: Tag, opened: list[Path]) -> None:
        """``opened``: the files that this one is included by, itself last."""
        out: list[Tag] = []
        for tag in root.children:
            if tag.name == "Include":
                out += self._open(tag, tag.text.strip(), opened).children
            elif "from" in tag.attrs and root.name == "febio_spec":
                if not tag.empty:
                    raise InputError(f"<{tag.name} from=...> must be empty", tag.where)
                found = self._open(tag, tag.attrs["from"], opened).child(tag.name)
                if found is None:
                    raise InputError(f'"{tag.attrs["from"]}" has no <{tag.name}> section', tag.where)
                out.append(found)
            else:
                out.append(tag)
        root.children = out

    def _open(self, tag: Tag, name: str, opened: list[Path]) -> Tag:
        path = self._path(tag, name)
        if path in opened:
            raise InputError(f'"{name}" includes itself', tag.where)
        try:
            data = contents(path)
        except OSError as e:
            raise InputError(f'cannot open "{name}": {e.strerror}', tag.where) from None
        self.files, self.bytes = self.files + 1, self.bytes + len(data)
        if self.files > MAX_FILES or self.bytes > MAX_BYTES:
            raise InputError(f"more than {MAX_FILES} files or {MAX_BYTES >> 30} GB are included in all", tag.where)
        root = parse(data, str(path)).root
        if root.name != "febio_spec":
            raise InputError(f'"{name}" is no .feb file', tag.where)
        self.resolve(root, [*opened, path])
        return root

    def _path(self, tag: Tag, name: str) -> Path:
        if self.folder is None:
            raise InputError(f"<{tag.name}> needs a file on disk to find its includes", tag.where)
        if not name or "\0" in name:
            raise InputError(f"<{tag.name}> names no file", tag.where)
        path = (self.folder / name.replace("\\", "/")).resolve()
        if not path.is_relative_to(self.folder):
            raise InputError(f'"{name}" lies outside the folder of the model and is not opened', tag.where)
        return path
