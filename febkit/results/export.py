"""Converts results files: .xplt and .plt to .vtu/.pvd series, .nc and .xplt; .nc back to .xplt."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

from febkit.files import keep_apart, may_write
from febkit.model import InputError, Where

SOURCES = (".xplt", ".plt", ".nc")
TARGETS = (".pvd", ".vtu", ".nc", ".xplt")

Progress = Callable[[int, int], None]


def export(
    source: str | os.PathLike[str],
    target: str | os.PathLike[str],
    *,
    variables: tuple[str, ...] | None = None,
    deformed: bool = False,
    compress: bool | None = None,
    progress: Progress | None = None,
    overwrite: bool = True,
) -> list[Path]:
    """Convert by the files' endings; the files written, the one to open first.

    Raises InputError where the target is the source, or exists and ``overwrite`` is False.
    """
    from . import copy, open_all, write
    from . import open as open_one

    a, b = Path(source).suffix.lower(), Path(target).suffix.lower()
    if a not in SOURCES or b not in TARGETS:
        raise InputError(f"results are converted from {', '.join(SOURCES)} to {', '.join(TARGETS)}",
                         Where(os.fspath(target)))
    keep_apart([("target", target, None)], [("source", source, None)])
    may_write(target, overwrite or b == ".vtu")
    if a == b == ".xplt":
        copy(source, target, compress=compress, overwrite=overwrite)
        return [Path(target)]
    many = [open_one(source)] if a == ".nc" else open_all(source, apart=b in (".nc", ".xplt"))
    if b in (".pvd", ".vtu"):
        from .vtk import write_series

        return write_series(many, target, variables=variables, deformed=deformed, progress=progress,
                            overwrite=overwrite)
    out = []
    for i, ds in enumerate(many):
        path = Path(target) if i == 0 else Path(target).with_stem(f"{Path(target).stem}_mesh{i + 1}")
        kept = ds if variables is None else ds.drop_vars([n for n in ds.data_vars if n not in variables])
        how: dict[str, Any] = {"compress": int(bool(compress)) if b == ".nc" else compress, "overwrite": overwrite}
        write(kept, path, **how)
        out.append(path)
    return out
