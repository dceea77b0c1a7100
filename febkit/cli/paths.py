"""Files on the command line: those to read are there, those to write have a folder and an ending that says what."""

from __future__ import annotations

import os
import stat
from pathlib import Path
from typing import Any

import click

from . import exits


class Input(click.ParamType):
    """A file that is there and can be read; no folder, pipe or device, which could be waited for for ever."""

    name = "file"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Path:
        path = Path(value)
        try:
            mode = path.stat().st_mode
        except (FileNotFoundError, NotADirectoryError):
            raise exits.Refused(f"{path}: there is no such file{_near(path)}") from None
        except (OSError, ValueError) as e:
            raise exits.Refused(f"{path}: {getattr(e, 'strerror', None) or e}") from None
        if stat.S_ISDIR(mode):
            raise exits.Refused(f"{path} is a folder, and a file is wanted")
        if not stat.S_ISREG(mode):
            raise exits.Refused(f"{path} is a pipe or a device, and a file is wanted: save it as a file first")
        if not os.access(path, os.R_OK):
            raise exits.Refused(f"{path}: you may not read this file")
        return path


class Output(click.ParamType):
    """A file to write: its folder is there, and its ending is one of ``endings`` where there are any."""

    name = "file"

    def __init__(self, *endings: str) -> None:
        self.endings = endings

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Path:
        path = Path(value)
        if path.is_dir():
            raise exits.Refused(f"{path} is a folder: give the name of a file")
        if not path.parent.is_dir():
            raise exits.Refused(f"{path}: the folder {path.parent} does not exist")
        if self.endings and path.suffix.lower() not in self.endings:
            raise exits.Refused(f"{path}: give a name that ends in {' or '.join(self.endings)}")
        return path


INPUT = Input()


def _near(path: Path) -> str:
    """A file of the same folder whose name is much like it."""
    from difflib import get_close_matches

    try:
        names = os.listdir(path.parent)
    except OSError:
        return ""
    near = get_close_matches(path.name, names, 1, 0.8)
    return f"; did you mean {path.with_name(near[0])}?" if near else ""
