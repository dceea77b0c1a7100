"""``xr.open_dataset("run.xplt")`` and ``febkit.results.open``."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from xarray.backends import BackendEntrypoint

from febkit.model import InputError, Where

from . import accessor  # noqa: F401 (registers ds.febkit for those who open with xarray)

if TYPE_CHECKING:
    import xarray as xr

    from .xplt.reader import PlotFile


class PlotfileBackend(BackendEntrypoint):
    """FEBio plotfiles (.xplt), and LS-DYNA databases (.plt) that FEBio 1 wrote."""

    description = "Open FEBio plotfiles (.xplt, .plt)"
    url = "https://febio.org"
    open_dataset_parameters = ("filename_or_obj", "drop_variables", "mesh", "apart")

    def guess_can_open(self, filename_or_obj: Any) -> bool:
        try:
            return str(os.fspath(filename_or_obj)).lower().endswith((".xplt", ".plt"))
        except TypeError:
            return False

    def open_dataset(  # type: ignore[override]
        self,
        filename_or_obj: str | os.PathLike[str],
        *,
        drop_variables: str | Iterable[str] | None = None,
        mesh: int | None = None,
        apart: bool = False,
    ) -> xr.Dataset:
        ds = open_plot(filename_or_obj, mesh=mesh, apart=apart)
        if drop_variables is None:
            return ds
        names = [drop_variables] if isinstance(drop_variables, str) else list(drop_variables)
        return ds.drop_vars(names, errors="ignore")


def open_plot(path: str | os.PathLike[str], *, mesh: int | None = None, apart: bool = False) -> xr.Dataset:
    """The dataset of a plotfile; of one of its meshes where the mesh changes."""
    if str(path).lower().endswith(".plt"):
        from .plt import open_plt

        return open_plt(path)
    from . import dataset
    from .xplt.reader import PlotFile

    f = PlotFile(path)
    try:
        say_unread(f)
        return dataset.build(f, _only_mesh(f, path) if mesh is None else mesh, apart)
    except BaseException:
        f.close()
        raise


def _only_mesh(f: PlotFile, path: str | os.PathLike[str]) -> int:
    used = used_meshes(f) or [0]
    if len(used) > 1:
        raise InputError(
            f"the mesh changes {len(used) - 1} times: give mesh=0 to {f.n_meshes - 1}, or use"
            " febkit.results.open_all for one dataset per mesh; febkit convert FILE OUT.nc makes a file of each",
            Where(str(path)),
        )
    return used[0]


def say_unread(f: PlotFile) -> None:
    """Warn of bytes behind the last complete state."""
    unread = f.container.unread()
    if unread:
        warnings.warn(unread, stacklevel=4)


def used_meshes(f: PlotFile) -> list[int]:
    """Meshes that states live on, in order."""
    return list(dict.fromkeys(max(s.mesh, 0) for s in f.states))


def open_all(path: str | os.PathLike[str], *, apart: bool = False) -> list[xr.Dataset]:
    """One dataset per mesh, in order of time."""
    if str(path).lower().endswith(".plt"):
        return [open_plot(path)]
    from . import dataset
    from .xplt.reader import PlotFile

    f = PlotFile(path)
    try:
        say_unread(f)
        many = [dataset.build(f, i, apart) for i in used_meshes(f) or [0]]
    except BaseException:
        f.close()
        raise
    last = _Last(f, len(many))
    for ds in many:
        ds.set_close(last)
    return many


@dataclass(slots=True)
class _Last:
    """Closes a file once everyone who shares it has let go of it."""

    file: PlotFile
    sharing: int

    def __call__(self) -> None:
        self.sharing -= 1
        if self.sharing == 0:
            self.file.close()
