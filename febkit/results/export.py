"""Converts results files: .xplt and .plt to .vtu/.pvd series, .nc and .xplt; .nc back to .xplt."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from febkit.files import keep_apart, may_write
from febkit.model import InputError, Where

if TYPE_CHECKING:
    import xarray as xr

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
    if deformed and b not in (".pvd", ".vtu"):
        raise InputError(f"only .pvd and .vtu have deformed places: {b} keeps the displacement beside the mesh",
                         Where(os.fspath(target)))
    keep_apart([("target", target, None)], [("source", source, None)])
    may_write(target, overwrite or b == ".vtu")
    if a == b == ".xplt" and variables is None:
        copy(source, target, compress=compress, overwrite=overwrite)
        return [Path(target)]
    many = [open_one(source)] if a == ".nc" else open_all(source, apart=b in (".nc", ".xplt"))
    if b in (".pvd", ".vtu"):
        from .vtk import write_series

        if variables is not None:
            variables = tuple(_names(many[0], variables))
        return write_series(many, target, variables=variables, deformed=deformed, progress=progress,
                            overwrite=overwrite)
    out = []
    for i, ds in enumerate(many):
        path = Path(target) if i == 0 else Path(target).with_stem(f"{Path(target).stem}_mesh{i + 1}")
        kept = ds if variables is None else _only(ds, variables)
        how: dict[str, Any] = {"compress": int(bool(compress)) if b == ".nc" else compress, "overwrite": overwrite}
        write(kept, path, **how)
        out.append(path)
    return out


def _only(ds: xr.Dataset, variables: tuple[str, ...]) -> xr.Dataset:
    names = _names(ds, variables)
    return ds.drop_vars([n for n in ds.data_vars if n not in names])


def _names(ds: xr.Dataset, variables: tuple[str, ...]) -> list[str]:
    """Variables by their name in the dataset or in FEBio."""
    from difflib import get_close_matches

    from .dataset import variable_name

    out = []
    for v in variables:
        name = v if v in ds.data_vars else variable_name(v)
        if name not in ds.data_vars:
            near = get_close_matches(name, map(str, ds.data_vars), 1)
            meant = f'did you mean "{near[0]}"?' if near else f"there are {', '.join(map(str, ds.data_vars))}"
            raise InputError(f'no variable "{v}"; {meant}', Where(str(ds.attrs.get("source", ""))))
        out.append(name)
    return out
