"""Other files that a model pulls in: <Include> and ``from=`` (versions 2.0 and later).

Only files inside the model's own folder are opened; anything else is refused.
"""

from __future__ import annotations

from pathlib import Path

from febkit.model import InputError

from .document import Tag, parse

MAX_FILES = 100


def resolve(root: Tag, file: str) -> None:
    """Puts the sections of included files where they are asked for, in place."""
    folder = Path(file).resolve().parent if file else None
    _resolve(root, folder, [Path(file).resolve()] if file else [])


def _resolve(root: Tag, folder: Path | None, opened: list[Path]) -> None:
    out: list[Tag] = []
    for tag in root.children:
        if tag.name == "Include":
            other = _open(tag, tag.text.strip(), folder, opened)
            out += other.children
        elif "from" in tag.attrs and root.name == "febio_spec":
            if not tag.empty:
                raise InputError(f'<{tag.name} from=...> must be empty', tag.where)
            other = _open(tag, tag.attrs["from"], folder, opened)
            found = other.child(tag.name)
            if found is None:
                raise InputError(f'"{tag.attrs["from"]}" has no <{tag.name}> section', tag.where)
            out.append(found)
        else:
            out.append(tag)
    root.children = out


def _open(tag: Tag, name: str, folder: Path | None, opened: list[Path]) -> Tag:
    if folder is None:
        raise InputError(f"<{tag.name}> needs a file on disk to find its includes", tag.where)
    if not name or "\0" in name:
        raise InputError(f"<{tag.name}> names no file", tag.where)
    path = (folder / name.replace("\\", "/")).resolve()
    if not path.is_relative_to(folder):
        raise InputError(f'"{name}" lies outside the folder of the model and is not opened', tag.where)
    if path in opened or len(opened) > MAX_FILES:
        raise InputError(f'"{name}" includes itself', tag.where)
    try:
        data = path.read_bytes()
    except OSError as e:
        raise InputError(f'cannot open "{name}": {e.strerror}', tag.where) from None
    root = parse(data, str(path)).root
    if root.name != "febio_spec":
        raise InputError(f'"{name}" is no .feb file', tag.where)
    _resolve(root, folder, [*opened, path])
    return root
