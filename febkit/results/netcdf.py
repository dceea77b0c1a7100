"""Datasets of results to NetCDF and back, without loss."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
import xarray as xr

from febkit.files import written
from febkit.model import InputError, Where

_LISTS = ("parts", "element_types", "materials", "names", "febio_array_names")
_NUMBERS = ("part_materials", "part_sizes", "part_named", "material_ids", "sizes", "widths", "febio_regions",
            "flag_values", "flag_masks")


def write_netcdf(ds: xr.Dataset, path: str | os.PathLike[str], compress: int = 0,
                 overwrite: bool = True) -> None:
    """Write state by state where the data are lazy; ``compress`` 1-9 packs floats."""
    out = ds
    encoding: dict[Any, dict[str, Any]] = {}
    for name, v in out.variables.items():
        if v.dtype.kind == "f":
            # float data keep their NaN and get no fill value of another kind
            encoding[name] = {"_FillValue": None}
            if compress:
                encoding[name] |= {"zlib": True, "complevel": compress}
    save(out, path, overwrite, engine="netcdf4", encoding=encoding)


def save(ds: xr.Dataset, path: str | os.PathLike[str], overwrite: bool = True, **options: Any) -> None:
    """Write a dataset as it is: whole, or not at all. Raises InputError where the file exists and ``overwrite`` is
    False."""
    with written(path, overwrite) as part:
        try:
            ds.to_netcdf(part, **options)
        except RuntimeError as e:  # what the library makes of a full disk
            raise unwritten(path, e) from None


def unwritten(path: str | os.PathLike[str], e: RuntimeError) -> InputError:
    """What to say where the library cannot write a file."""
    return InputError(f"the file cannot be written: {e}; is the disk full?", Where(os.fspath(path)))


def opened(path: str | os.PathLike[str], chunks: Any = None) -> xr.Dataset:
    """A NetCDF file as it is. Raises InputError where it is none."""
    try:
        return xr.open_dataset(path, engine="netcdf4", chunks=chunks)
    except (FileNotFoundError, PermissionError, IsADirectoryError):
        raise
    except (OSError, ValueError):  # what the library says of it begins with a number of its own
        raise InputError("not a NetCDF file, or one that was cut short", Where(os.fspath(path))) from None


def open_netcdf(path: str | os.PathLike[str], chunks: Any = None) -> xr.Dataset:
    """Read back, with lists of names and numbers as lists again."""
    ds = opened(path, chunks)
    for attrs in (ds.attrs, *(v.attrs for v in ds.variables.values())):
        for key in _LISTS:
            if isinstance(attrs.get(key), str):
                attrs[key] = [attrs[key]]
        for key in _NUMBERS:
            if key in attrs:
                attrs[key] = [int(x) for x in np.atleast_1d(attrs[key])]
    for v in ds.variables.values():
        v.encoding.clear()
    return ds
