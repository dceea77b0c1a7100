"""Results: plotfiles, logs and data files as xarray datasets and tables. Imports nothing heavy by itself."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from .log import Log

__all__ = ["copy", "open", "open_all", "read_data", "read_log", "write"]

Path = str | os.PathLike[str]


def open(
    path: Path, *, chunks: Any = None, mesh: int | None = None, apart: bool = False, units: str | None = None
) -> xr.Dataset:
    """Results as a dataset; variables are read when touched.

    ``path`` is a plotfile (.xplt), an LS-DYNA database of FEBio 1 (.plt) or a NetCDF file (.nc) that such a
    dataset was saved to. ``chunks`` as in ``xarray.open_dataset``: "auto", {} or a mapping gives dask arrays.
    ``mesh`` picks a mesh where the file has several. ``apart`` keeps nodal values of domains apart
    (dimension ``domain_node``) instead of merging them by node, where the last domain of a shared node wins.
    ``units`` names the unit system ("mm-N-s", ...: :data:`febkit.units.SYSTEMS`) where the file does not;
    InputError where the file names another.
    """
    from . import accessor  # noqa: F401 (registers ds.febkit)

    ds = _opened(path, chunks, mesh, apart)
    if units is not None:
        from febkit.units import one, told

        from .dataset import name_units

        name_units(ds, one(ds.attrs.get("unit_system"), told(units), what=f"{path} and what was said of it"))
    return ds


def _opened(path: Path, chunks: Any, mesh: int | None, apart: bool) -> xr.Dataset:
    if os.fspath(path).lower().endswith((".nc", ".nc4", ".h5")):
        from .netcdf import open_netcdf

        return open_netcdf(path, chunks)
    if chunks is None:
        from .backend import open_plot

        return open_plot(path, mesh=mesh, apart=apart)
    import xarray as xr

    from .backend import PlotfileBackend

    return xr.open_dataset(path, engine=PlotfileBackend, chunks=chunks, mesh=mesh, apart=apart)


def held(data: bytes | bytearray) -> xr.Dataset:
    """The dataset of a plotfile's bytes. Raises InputError where its mesh changes."""
    every = held_all(data)
    if len(every) > 1:
        from febkit.model import InputError

        raise InputError("the mesh changes during the run: there is no one dataset of all its states")
    return every[0]


def held_all(data: bytes | bytearray) -> list[xr.Dataset]:
    """One dataset for each mesh of a plotfile's bytes, in order of time."""
    from . import accessor  # noqa: F401
    from .backend import used_meshes
    from .dataset import build
    from .xplt.reader import PlotFile
    from .xplt.source import Held

    f = PlotFile(Held(data))
    every = [build(f, mesh) for mesh in used_meshes(f) or [0]]
    for ds in every:
        ds.encoding.pop("source")
    return every


def open_all(path: Path, *, apart: bool = False) -> list[xr.Dataset]:
    """One dataset per mesh of a plotfile, in order of time."""
    from . import accessor  # noqa: F401
    from .backend import open_all as every

    return every(path, apart=apart)


def write(ds: xr.Dataset, path: Path, **options: Any) -> None:
    """Write a dataset as a plotfile (.xplt) or NetCDF (.nc), by the path's ending."""
    if os.fspath(path).lower().endswith((".nc", ".nc4", ".h5")):
        from .netcdf import write_netcdf

        write_netcdf(ds, path, **options)
    else:
        from .rewrite import write as plot

        plot(ds, path, **options)


def copy(source: Path, target: Path, **options: Any) -> None:
    """Rewrite a plotfile value for value; ``version=`` and ``compress=`` may differ."""
    from .rewrite import copy as whole

    whole(source, target, **options)


def read_log(path: Path) -> Log:
    """The log of a run: steps and iterations as tables, messages, data records, summary."""
    from .log import read_log as read

    return read(path)


def read_data(path: Path) -> pd.DataFrame:
    """A file of ``<logfile>`` data as a table: step, time, item and one column per quantity."""
    from .records import read_data as read

    return read(path)
