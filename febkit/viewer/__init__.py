"""Results in a browser page or a notebook cell: time, variables, deformation, parts, cuts, picking."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from .stage import Show, Stage

if TYPE_CHECKING:
    import xarray as xr

    from febkit.model import Model

    from .server import View

__all__ = ["Show", "Stage", "view"]


def view(
    results: xr.Dataset | str | os.PathLike[str],
    variable: str | None = None,
    *,
    model: Model | None = None,
    units: str | None = None,
    port: int = 0,
    height: int = 640,
) -> View:
    """Open a viewer of a dataset or of the plotfile of this path; a notebook shows what is given back.

    variable   what is drawn first, as :func:`febkit.plots.scene` takes it
    model      the model of the run, where fields need it; ``units`` of a result that names none
    port       where the page is served, on this machine alone; 0 for any that is free. ``height`` in a notebook

    A plotfile that grows is followed: states appear as they are written. The viewer lives until ``.stop()`` or the
    end of the program. Raises InputError where pyvista or trame is missing.
    """
    from .server import View

    return View(Stage(results, Show(variable or ""), model=model, units=units), port, height)
