"""Where the records of <logfile> go: names of files that a model, which may come from elsewhere, asks for."""

from __future__ import annotations

from pathlib import Path

from febkit.files import real

from .model import LogEntry, Model
from .source import InputError


def data_files(model: Model, folder: Path, stem: str, anywhere: bool = False) -> list[Path]:
    """The file of each record of <logfile>, named after ``stem`` and the record where the model gives none.

    They lie in ``folder`` or below it, wherever the model would have them; any place where ``anywhere``. Raises
    InputError for another place.
    """
    return [data_file(e, n, folder, stem, anywhere) for n, e in enumerate(model.output.log, start=1)]


def data_file(entry: LogEntry, number: int, folder: Path, stem: str, anywhere: bool = False) -> Path:
    """The file of the record of this number, counted from 1."""
    name = entry.file or f"{stem}_{entry.kind}_{number}.txt"
    if "\0" in name:
        raise InputError(f"<{entry.kind}> names no file", entry.where)
    path = folder / name.replace("\\", "/")
    if not anywhere and not real(path).is_relative_to(real(folder)):
        raise InputError(f'file="{name}" lies outside the folder of the log ({real(folder)}): such files are written '
                         "with --data-anywhere only", entry.where)  # fmt: skip
    return path
