"""A variable on the deformed mesh in three dimensions, whole or cut open, with arrows, by pyvista."""

from __future__ import annotations

import inspect
import os
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from textwrap import wrap
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from febkit.files import written
from febkit.metrics.fields import COMPONENTS, FIELDS, element_fields
from febkit.metrics.selection import select_cells
from febkit.metrics.summary import scalar_of
from febkit.model import InputError

if TYPE_CHECKING:
    import xarray as xr

    from febkit.model import Model

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
AXES = "xyz"
COLOURS = "viridis"
RASTER = 20  # arrows along the longest side of what is shown
# where each plane is looked at from, and which way is up: x-z and y-z upright, x-y as on paper
VIEWS = {"x": ((1, 0, 0), (0, 0, 1)), "y": ((0, -1, 0), (0, 0, 1)), "z": ((0, 0, 1), (0, 1, 0))}
# meshio's names of cells -> VTK's numbers
VTK = {
    "hexahedron": 12, "wedge": 13, "tetra": 10, "pyramid": 14, "quad": 9, "triangle": 5, "line": 3,
    "hexahedron20": 25, "tetra10": 24, "hexahedron27": 29, "wedge15": 26, "pyramid13": 27,
    "triangle6": 22, "quad8": 23, "quad9": 28, "line3": 21,
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Plane:
    """The material plane ``axis`` = ``at`` of the reference configuration."""

    axis: str
    at: float

    @classmethod
    def parse(cls, text: str) -> Plane:
        """ "x=0", "z = 0.5"."""
        axis, _, at = (s.strip() for s in text.partition("="))
        try:
            if axis not in VIEWS:
                raise ValueError
            return cls(axis, float(at))
        except ValueError:
            raise InputError(f'{text!r} is no plane: write "x=0", "y=0.5" or "z=1"') from None


def scene(
    ds: xr.Dataset,
    path: str | os.PathLike[str],
    variable: str = "displacement:magnitude",
    time: float | None = None,
    plane: Plane | str | None = None,
    parts: Sequence[str] | None = None,
    arrows: str | None = None,
    model: Model | None = None,
    limits: tuple[float, float] | None = None,
    edges: bool = True,
    size: tuple[int, int] = (1200, 900),
    title: str = "",
) -> None:
    """Draw ``variable`` on the deformed mesh without a display and write ``path`` (PNG).

    variable   a plot variable, "name:component" of vectors and tensors (else magnitude, effective value), or
               one of the element fields of :data:`febkit.metrics.FIELDS` (``model`` as there)
    time       the last by default
    plane      a plane of the reference configuration that cuts the body open, in its deformed place: the
               half behind it is shown. The whole body by default
    parts      parts or element sets shown, globs too
    arrows     a vector variable ("fluid flux"): lengths by the root of its size; on a cut, what lies in it

    Raises InputError where pyvista is missing or nothing can be rendered here.
    """
    pv = _pyvista()
    at = _time_index(ds, time)
    cut = Plane.parse(plane) if isinstance(plane, str) else plane
    rows = (
        np.arange(ds.sizes["element"])
        if parts is None
        else np.sort(select_cells(ds, list(parts), split=False).rows)
    )
    body = _grid(pv, ds, at, rows)
    label = _colour(body, ds, variable, at, model)
    if arrows is not None:
        _vector(body, ds, _known(arrows), at, model)
    shell, face = _opened(body, cut)
    with pv.vtk_verbosity("off"):  # of how it looks for a display
        plotter = pv.Plotter(off_screen=True, window_size=list(size), lighting="light kit")
        _paint(plotter, shell, face, label, limits or _limits(shell, face), edges)
        if arrows is not None:
            _arrows(plotter, pv, face if face is not None else shell, cut)
        _finish(plotter, shell, cut, f"{title}\n" * bool(title) + _clock(ds, at))
        _write(plotter, path)


def _pyvista() -> Any:
    from importlib import import_module

    try:
        pv = import_module("pyvista")
        version = import_module("vtkmodules.vtkCommonCore").vtkVersion.GetVTKVersion()
    except ModuleNotFoundError:
        raise InputError('scenes need pyvista: pip install "febkit[scenes]"') from None
    except ImportError as e:
        raise InputError(f"pyvista does not load here ({e}): install the system's OpenGL libraries") from None
    # VTK before 9.4 ends the whole process where it finds no display
    old = tuple(int(v) for v in version.split(".")[:2]) < (9, 4)
    if old and sys.platform == "linux" and not os.environ.get("DISPLAY"):
        raise InputError(
            f"VTK {version} cannot render without a display: upgrade vtk to 9.4 or later, or use xvfb-run"
        )
    return pv


def _known(name: str) -> str:
    """The dataset's name of FEBio's variable, its component kept."""
    from febkit.results.dataset import variable_name

    head, colon, word = name.partition(":")
    return variable_name(head) + colon + word


def _time_index(ds: xr.Dataset, time: float | None) -> int:
    t = np.asarray(ds["time"].values, dtype=float)
    if time is None:
        return len(t) - 1
    k = int(np.abs(t - time).argmin())
    if abs(t[k] - time) > 1e-3 * max(abs(time), 1e-3):
        raise InputError(f"no state at t = {time:g}; the nearest is {t[k]:g}")
    return k


def _clock(ds: xr.Dataset, at: int) -> str:
    return f"t = {float(ds['time'].values[at]):g} {ds['time'].attrs.get('units', '')}".rstrip()


def _grid(pv: Any, ds: xr.Dataset, at: int, rows: Ints) -> Any:
    """Reference mesh of these elements with displacements "u", and its "node", "row" and "part"."""
    from febkit.results.vtk import cells

    shown = np.zeros(ds.sizes["element"], dtype=bool)
    shown[rows] = True
    blocks: dict[int, list[NDArray[Any]]] = {}
    order: dict[int, list[Ints]] = {}
    for (kind, conn), where in zip(*cells(ds)):
        mine = np.arange(where.start, where.stop)[shown[where]]
        if len(mine):
            blocks.setdefault(VTK[kind], []).append(conn[shown[where]])
            order.setdefault(VTK[kind], []).append(mine)
    if not blocks:
        raise InputError("there is no element to show")
    joined = {k: np.concatenate(c).astype(np.int64) for k, c in blocks.items()}
    nodes = np.unique(np.concatenate([c.ravel() for c in joined.values()]))
    X = np.asarray(ds["X"].values, dtype=float)[nodes]
    grid = pv.UnstructuredGrid({k: np.searchsorted(nodes, c) for k, c in joined.items()}, X)
    u = ds["displacement"][at].values[nodes] if "displacement" in ds else np.zeros(X.shape)
    grid.point_data["u"] = np.nan_to_num(np.asarray(u, dtype=float))
    grid.point_data["node"] = nodes
    grid.cell_data["row"] = np.concatenate([r for rs in order.values() for r in rs])
    grid.cell_data["part"] = np.asarray(ds["part"].values)[grid.cell_data["row"]]
    return grid


def _colour(body: Any, ds: xr.Dataset, variable: str, at: int, model: Model | None) -> str:
    """Put the scalar "colour" on the body's points or cells; its label."""
    name, _, word = _known(variable).partition(":")
    if name not in ds.data_vars and name in FIELDS and name not in COMPONENTS:
        body.cell_data["colour"], units = _field(ds, name, at, body.cell_data["row"], model)
    elif name not in ds.data_vars:
        raise InputError(f"the result has no {name!r}; it has {', '.join(map(str, ds.data_vars))}")
    else:
        v = ds[name].isel(time=at)
        units = str(ds[name].attrs.get("units", ""))
        if not word and "voigt" in v.dims:
            word = "effective"
        elif not word and "xyz" in v.dims:
            word = "magnitude"
        if v.dims[:1] == ("node",):
            body.point_data["colour"] = scalar_of(name, word, v, _at_nodes(v, body))
        else:
            body.cell_data["colour"] = scalar_of(name, word, v, _by_element(ds, v, body.cell_data["row"]))
    text = f"{name.replace('_', ' ')}{', ' + word if word else ''}"
    return f"{text} ({units})" if units and units != "1" else text


def _at_nodes(v: xr.DataArray, body: Any) -> Floats:
    return np.asarray(np.asarray(v.values, dtype=float)[body.point_data["node"]])


def _by_element(ds: xr.Dataset, v: xr.DataArray, rows: Ints) -> Floats:
    """(e, ...) of element, element-node and domain values; those at nodes of elements by their mean."""
    a = np.asarray(v.values, dtype=float)
    if v.dims[:1] == ("domain",):
        return np.asarray(a[np.asarray(ds["part"].values)[rows]])
    if v.dims[:1] != ("element",):
        raise InputError(f"{v.name} lives on neither nodes nor elements")
    return np.asarray(np.nanmean(a[rows], axis=1) if "local" in v.dims else a[rows])


def _field(ds: xr.Dataset, name: str, at: int, rows: Ints, model: Model | None) -> tuple[Floats, str]:
    """An element field of the metrics at these rows, and its units."""
    f = element_fields(ds.isel(time=[at]), {"shown": np.sort(rows)}, model, [name])
    if name not in f:
        raise InputError(f"{name} cannot be had from this result without its model")
    where = np.searchsorted(f["element_row"].values, rows)
    return np.asarray(f[name].values[0, where]), str(f[name].attrs.get("units", ""))


def _vector(body: Any, ds: xr.Dataset, name: str, at: int, model: Model | None) -> None:
    """Put the vector "arrow" on the body's points or cells."""
    if name == "fluid_flux" and name not in ds.data_vars:
        body.cell_data["arrow"] = _field(ds, name, at, body.cell_data["row"], model)[0]
        return
    v = ds[name].isel(time=at) if name in ds.data_vars else None
    if v is None or v.dims[-1:] != ("xyz",):
        vectors = [str(n) for n in ds.data_vars if ds[n].dims[-1] == "xyz"]
        raise InputError(f"{name!r} is no vector of this result; it has {', '.join(vectors) or 'none'}")
    if v.dims[0] == "node":
        body.point_data["arrow"] = _at_nodes(v, body)
    else:
        body.cell_data["arrow"] = _by_element(ds, v, body.cell_data["row"])


def _opened(body: Any, cut: Plane | None) -> tuple[Any, Any]:
    """Deformed outer surface of the body, or of the half behind the cut, and the cut's polygons or None."""
    shell = _surface(body)
    if cut is None:
        return _moved(shell), None
    k = AXES.index(cut.axis)
    low, high = np.asarray(body.bounds).reshape(3, 2)[k]
    if not low <= cut.at <= high:
        say = f"the plane {cut.axis} = {cut.at:g} misses the body: it lies in {low:g} to {high:g}"
        raise InputError(say)
    towards = np.array(VIEWS[cut.axis][0], dtype=float)
    # just behind the plane: where element faces lie in it, those of the half that is kept are cut
    nudge = 1e-6 * (high - low)
    at = min(max(cut.at - nudge * towards[k], low + nudge), high - nudge)
    origin = np.zeros(3)
    origin[k] = at
    face = body.slice(normal=towards, origin=origin)
    if not face.n_cells:
        raise InputError(f"the plane {cut.axis} = {cut.at:g} cuts none of the elements shown")
    half = shell.clip(normal=towards, origin=origin, invert=True)
    return _moved(half) if half.n_cells else _moved(face.copy()), _moved(face)


def _surface(mesh: Any) -> Any:
    """Outer facets; newer pyvista asks which way they are found."""
    new = "algorithm" in inspect.signature(mesh.extract_surface).parameters
    return mesh.extract_surface(**({"algorithm": "dataset_surface"} if new else {}))


def _moved(mesh: Any) -> Any:
    mesh.points = np.asarray(mesh.points, dtype=float) + mesh.point_data["u"]
    return mesh


def _limits(shell: Any, face: Any) -> tuple[float, float]:
    """1 % and 99 % quantiles of what is seen."""
    seen = [np.asarray(m["colour"]) for m in (shell, face) if m is not None]
    v = np.concatenate(seen)
    v = v[np.isfinite(v)]
    if not len(v):
        raise InputError("the variable has no value on what is shown")
    low, high = (float(q) for q in np.quantile(v, [0.01, 0.99]))
    return (low, high) if high > low else (low, low + max(abs(low), 1e-30) * 1e-3)


def _paint(plotter: Any, shell: Any, face: Any, label: str, limits: tuple[float, float], edges: bool) -> None:
    bar = {
        "title": "\n".join(wrap(label, 18)) + "\n", "vertical": True, "height": 0.7, "width": 0.05, "position_x": 0.87,
        "position_y": 0.14, "fmt": "%.4g", "n_labels": 6, "color": "black", "title_font_size": 18,
        "label_font_size": 16,
    }  # fmt: skip
    style = {
        "scalars": "colour", "cmap": COLOURS, "clim": list(limits), "nan_color": "lightgrey",
        "show_edges": edges, "edge_color": "#404040", "line_width": 0.5,
    }  # fmt: skip
    plotter.add_mesh(
        shell, **style, edge_opacity=0.35, show_scalar_bar=face is None, scalar_bar_args=bar, ambient=0.3
    )
    if face is None:
        return
    # lit evenly: its colours are those of the bar
    plotter.add_mesh(face, **style, edge_opacity=0.5, lighting=False, scalar_bar_args=bar)
    for part in np.unique(face.cell_data["part"]):
        piece = _surface(face.extract_cells(np.flatnonzero(face.cell_data["part"] == part)))
        border = piece.extract_feature_edges(
            boundary_edges=True, feature_edges=False, manifold_edges=False, non_manifold_edges=False
        )
        if border.n_cells:
            plotter.add_mesh(border, color="black", line_width=2.5, lighting=False)


def _arrows(plotter: Any, pv: Any, on: Any, cut: Plane | None) -> None:
    """An arrow in each cube of a raster over what is shown; the longest spans one."""
    cells = on if "arrow" in on.cell_data else on.point_data_to_cell_data()
    centre, v = np.asarray(cells.cell_centers().points), np.array(cells.cell_data["arrow"], dtype=float)
    if cut is not None:
        v[:, AXES.index(cut.axis)] = 0
    ok = np.isfinite(v).all(axis=1)
    centre, v = centre[ok], v[ok]
    if not len(v):
        return
    low, high = centre.min(axis=0), centre.max(axis=0)
    step = max(float((high - low).max()) / RASTER, 1e-30)
    box = np.floor((centre - low) / step).astype(int)
    _, cube = np.unique(box, axis=0, return_inverse=True)
    middle = np.linalg.norm((centre - low) / step - box - 0.5, axis=1)
    order = np.lexsort((middle, cube.ravel()))
    pick = order[np.unique(cube.ravel()[order], return_index=True)[1]]
    norm = np.linalg.norm(v[pick], axis=1)
    pick, norm = pick[norm > 1e-3 * norm.max()], norm[norm > 1e-3 * norm.max()]
    if not len(pick):
        return
    length = step * np.sqrt(norm / norm.max())
    start = centre[pick] - 0.5 * v[pick] * (length / norm)[:, None]
    if cut is not None:
        start += 0.15 * step * np.array(VIEWS[cut.axis][0])
    points = pv.PolyData(start)
    points["direction"], points["length"] = v[pick] / norm[:, None], length
    shape = pv.Arrow(tip_length=0.4, tip_radius=0.16, shaft_radius=0.055)
    glyphs = points.glyph(orient="direction", scale="length", geom=shape)
    # white with a dark rim shows on every colour
    rim = {"color": "black", "line_width": 1.5}
    plotter.add_mesh(glyphs, color="white", ambient=0.6, silhouette=rim, show_scalar_bar=False)


def _finish(plotter: Any, shell: Any, cut: Plane | None, text: str) -> None:
    """Background, text, axes; the camera a little aside of the cut's normal."""
    plotter.set_background("white")
    plotter.add_text(text.strip(), position="upper_left", font_size=12, color="black")
    plotter.add_axes(color="black", line_width=3)
    normal, up = (np.array(v, dtype=float) for v in VIEWS[cut.axis if cut else "y"])
    right = np.cross(up, normal)
    aside = (0.25, 0.2) if cut else (0.7, 0.5)
    middle, reach = np.asarray(shell.center), float(shell.length)
    place = middle + 3 * reach * (normal + aside[0] * right + aside[1] * up)
    plotter.camera_position = [tuple(place), tuple(middle), tuple(up)]
    plotter.enable_parallel_projection()
    plotter.reset_camera()
    # room for the colour bar
    plotter.camera.window_center = (0.14, 0.0)
    plotter.camera.zoom(1.1)
    plotter.enable_anti_aliasing("ssaa")


def _write(plotter: Any, path: str | os.PathLike[str]) -> None:
    try:
        with written(path) as part:
            image = plotter.screenshot(os.fspath(part), return_img=True)
            if image is None or not np.ptp(image):
                raise InputError("the picture came out empty: there is no OpenGL (EGL or OSMesa) to render with")
    except (RuntimeError, AttributeError) as e:
        raise InputError(f"nothing can be rendered here: {e}") from None
    finally:
        plotter.close()
