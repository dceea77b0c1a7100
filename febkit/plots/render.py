"""A quantity on the deformed mesh in three dimensions, whole or cut open, with arrows: drawn by pyvista, labelled by
matplotlib."""

from __future__ import annotations

import inspect
import os
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from febkit.metrics.fields import element_fields
from febkit.metrics.selection import select_cells
from febkit.model import InputError

from . import canvas
from .camera import VIEWS, Camera
from .quantity import Quantity, clock, quantity, time_index

if TYPE_CHECKING:
    import xarray as xr

    from febkit.model import Model

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
AXES = "xyz"
RASTER = 20  # arrows along the longest side of what is shown
FINER = 2  # pixels of the rendered picture to one of the figure
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


@dataclass(frozen=True, slots=True, eq=False)
class Shot:
    """What a scene shows, the same at all times."""

    ds: xr.Dataset
    quantity: Quantity
    rows: Ints
    plane: Plane | None = None
    arrows: str | None = None
    model: Model | None = None
    edges: bool = True
    scale: float = 1.0
    cmap: Any = None

    def at(self, t: int) -> tuple[Any, Any]:
        """The outer surface at a state, deformed and coloured, and the face of the cut or None."""
        pv = load()
        body = grid(pv, self.ds, t, self.rows, self.scale)
        colour(body, self.quantity, t)
        if self.arrows is not None:
            _vector(body, self.ds, self.arrows, t, self.model)
        return _opened(body, self.plane)


def shot(
    ds: xr.Dataset,
    variable: str = "displacement:magnitude",
    plane: Plane | str | None = None,
    parts: Sequence[str] | None = None,
    arrows: str | None = None,
    model: Model | None = None,
    edges: bool = True,
    colours: str | None = None,
    scale: float = 1.0,
) -> Shot:
    """See :func:`scene`."""
    load()
    cut = Plane.parse(plane) if isinstance(plane, str) else plane
    every = np.arange(ds.sizes["element"])
    rows = every if parts is None else np.sort(select_cells(ds, list(parts), split=False).rows)
    q = quantity(ds, variable, model)
    if q.place not in ("node", "element", "domain"):
        raise InputError(f"{q.name} lives on neither nodes nor elements")
    return Shot(ds, q, rows, cut, arrows, model, edges, scale, canvas.colour_map(colours))


def scene(
    ds: xr.Dataset,
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
    *,
    camera: Camera | str | None = None,
    zoom: float = 1.0,
    colours: str | None = None,
    scale: float = 1.0,
) -> Any:
    """A figure of ``variable`` on the deformed mesh, drawn without a display.

    variable   a plot variable, "name:component" or "name:first" (principal values) of it, or an element field
               (:func:`.quantity.quantity`; ``model`` as there)
    time       the last by default
    plane      a plane of the reference configuration that cuts the body open, in its deformed place: the
               half behind it is shown. The whole body by default
    parts      parts or element sets shown, globs too
    arrows     a vector variable ("fluid flux"): lengths by the root of its size; on a cut, what lies in it
    limits     ends of the colours; 1 % and 99 % quantiles of what is seen by default
    camera     "iso", an axis to look from ("x", "-z"), or azimuth and elevation in degrees ("30,20"); by default
               somewhat aside of the cut. ``zoom`` above 1 is nearer
    colours    a colour map of matplotlib
    scale      displacements are drawn so many times as large
    size       pixels at 150 to the inch

    Raises InputError where pyvista is missing or nothing can be rendered here.
    """
    s = shot(ds, variable, plane, parts, arrows, model, edges, colours, scale)
    at = time_index(ds, time)
    shell, face = s.at(at)
    ends = limits or limits_of(seen(shell, face))
    view = Camera.of(camera, s.plane.axis if s.plane else None, zoom).onto(shell)
    words = "\n".join(w for w in (title, clock(ds, at)) if w)
    with canvas.style():
        return _page(s, shell, face, ends, view, size, words)


def _page(
    s: Shot, shell: Any, face: Any, ends: tuple[float, float], view: Camera, size: tuple[int, int], words: str
) -> Any:
    """The picture with its colour bar, title, axes and a bar that says how long a length is."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    figure = canvas.blank(size[0] / canvas.DPI, size[1] / canvas.DPI, layout=None)
    wide = 1.25 / figure.get_figwidth()  # inches for the bar, its numbers and its label
    top = 0.2 * (1 + words.count("\n")) / figure.get_figheight() + 0.02
    box = (0.0, 0.0, max(1 - wide, 0.3), 1 - top)
    pixels = [max(round(FINER * n * f), 16) for n, f in zip(size, box[2:])]
    image = render(s, shell, face, ends, view, (pixels[0], pixels[1]))
    ax = figure.add_axes(box)
    ax.imshow(image, interpolation="antialiased", aspect="equal")
    ax.set_axis_off()
    view.triad(ax, image.shape)
    view.ruler(ax, image.shape, canvas.pretty(canvas.unit_of(s.ds["X"])))
    bar = figure.add_axes((box[2] + 0.12 / figure.get_figwidth(), 0.12, 0.16 / figure.get_figwidth(), 0.74 * (1 - top)))
    values = seen(shell, face)
    slack = 1e-6 * (ends[1] - ends[0])
    low, high = float(np.nanmin(values)) < ends[0] - slack, float(np.nanmax(values)) > ends[1] + slack
    beyond = "both" if low and high else "min" if low else "max" if high else "neither"
    figure.colorbar(ScalarMappable(Normalize(*ends), s.cmap), cax=bar, extend=beyond, label=s.quantity.label)
    bar.tick_params(labelsize=8)
    bar.ticklabel_format(scilimits=(-3, 4))
    figure.text(0.02, 0.985, words, ha="left", va="top", fontsize=10)
    return figure


def render(
    s: Shot, shell: Any, face: Any, ends: tuple[float, float], view: Camera, size: tuple[int, int]
) -> NDArray[np.uint8]:
    """(height, width, 3) picture of the mesh alone."""
    pv = load()
    with pv.vtk_verbosity("off"):  # of how it looks for a display
        try:
            plotter = pv.Plotter(off_screen=True, window_size=list(size), lighting="light kit")
            plotter.set_background("white")
            _paint(plotter, shell, face, s, ends)
            if s.arrows is not None:
                _arrows(plotter, pv, face if face is not None else shell, s.plane)
            view.aim(plotter)
            image = plotter.screenshot(None, return_img=True)
        except (RuntimeError, AttributeError) as e:
            raise InputError(f"nothing can be rendered here: {e}") from None
        plotter.close()
    if image is None or not np.ptp(image):
        raise InputError("the picture came out empty: there is no OpenGL (EGL or OSMesa) to render with")
    return np.asarray(image)[..., :3]


def load() -> Any:
    """pyvista. Raises InputError where it is missing or cannot render."""
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


def grid(pv: Any, ds: xr.Dataset, at: int, rows: Ints, scale: float = 1.0) -> Any:
    """Reference mesh of these elements with ``scale`` times the displacements "u", and its "node", "row" and "part"."""
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
    mesh = pv.UnstructuredGrid({k: np.searchsorted(nodes, c) for k, c in joined.items()}, X)
    u = ds["displacement"][at].values[nodes] if "displacement" in ds else np.zeros(X.shape)
    mesh.point_data["u"] = scale * np.nan_to_num(np.asarray(u, dtype=float))
    mesh.point_data["node"] = nodes
    mesh.cell_data["row"] = np.concatenate([r for rs in order.values() for r in rs])
    mesh.cell_data["part"] = np.asarray(ds["part"].values)[mesh.cell_data["row"]]
    return mesh


def colour(body: Any, q: Quantity, t: int) -> None:
    """Put the quantity as "colour" on the body's points or cells."""
    if q.place == "node":
        body.point_data["colour"] = q.state(t, np.asarray(body.point_data["node"]))
    elif q.place == "domain":
        body.cell_data["colour"] = q.state(t)[np.asarray(body.cell_data["part"])]
    else:
        body.cell_data["colour"] = q.state(t, np.asarray(body.cell_data["row"]))


def _vector(body: Any, ds: xr.Dataset, text: str, at: int, model: Model | None) -> None:
    """Put the vector "arrow" on the body's points or cells."""
    from febkit.results.dataset import variable_name
    from febkit.results.mesh import local_mean

    name = variable_name(text)
    rows = np.asarray(body.cell_data["row"])
    if name == "fluid_flux" and name not in ds.data_vars:
        f = element_fields(ds.isel(time=[at]), {"shown": np.sort(rows)}, model, [name])
        if name not in f:
            raise InputError("the fluid flux cannot be had from this result without its model")
        body.cell_data["arrow"] = f[name].values[0, np.searchsorted(f["element_row"].values, rows)]
        return
    v = ds[name].isel(time=at) if name in ds.data_vars else None
    if v is None or v.dims[-1:] != ("xyz",) or v.dims[0] not in ("node", "element"):
        vectors = [str(n) for n in ds.data_vars if ds[n].dims[-1] == "xyz"]
        raise InputError(f"{text!r} is no vector of this result; it has {', '.join(vectors) or 'none'}")
    a = np.asarray(v.values, dtype=float)
    if v.dims[0] == "node":
        body.point_data["arrow"] = a[np.asarray(body.point_data["node"])]
    else:
        body.cell_data["arrow"] = local_mean(a[rows]) if "local" in v.dims else a[rows]


def _opened(body: Any, cut: Plane | None) -> tuple[Any, Any]:
    """Deformed outer surface of the body, or of the half behind the cut, and the cut's polygons or None."""
    shell = surface(body)
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


def surface(mesh: Any) -> Any:
    """Outer facets; newer pyvista asks which way they are found."""
    new = "algorithm" in inspect.signature(mesh.extract_surface).parameters
    return mesh.extract_surface(**({"algorithm": "dataset_surface"} if new else {}))


def _moved(mesh: Any) -> Any:
    mesh.points = np.asarray(mesh.points, dtype=float) + mesh.point_data["u"]
    return mesh


def seen(shell: Any, face: Any) -> Floats:
    """All values on what is shown."""
    return np.concatenate([np.asarray(m["colour"], dtype=float) for m in (shell, face) if m is not None])


def limits_of(values: Floats) -> tuple[float, float]:
    """1 % and 99 % quantiles."""
    from .section import widened

    v = values[np.isfinite(values)]
    if not len(v):
        raise InputError("the variable has no value on what is shown")
    low, high = (float(q) for q in np.quantile(v, [0.01, 0.99]))
    return (low, high) if high - low > 1e-9 * max(abs(low), abs(high)) else widened(low)


def _paint(plotter: Any, shell: Any, face: Any, s: Shot, ends: tuple[float, float]) -> None:
    style = {
        "scalars": "colour", "cmap": s.cmap, "clim": list(ends), "nan_color": "lightgrey", "show_scalar_bar": False,
        "show_edges": s.edges, "edge_color": "#404040", "line_width": 0.5 * FINER,
    }  # fmt: skip
    plotter.add_mesh(shell, **style, edge_opacity=0.35, ambient=0.3)
    if face is None:
        return
    # lit evenly: its colours are those of the bar
    plotter.add_mesh(face, **style, edge_opacity=0.5, lighting=False)
    for part in np.unique(face.cell_data["part"]):
        piece = surface(face.extract_cells(np.flatnonzero(face.cell_data["part"] == part)))
        border = piece.extract_feature_edges(
            boundary_edges=True, feature_edges=False, manifold_edges=False, non_manifold_edges=False
        )
        if border.n_cells:
            plotter.add_mesh(border, color="black", line_width=1.5 * FINER, lighting=False)


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
    step = max(float((high - low).max()) * max(1 / RASTER, 0.7 / len(centre) ** 0.5), 1e-30)
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
    # dark with a light rim: seen on every colour, and on white
    rim = {"color": "white", "line_width": 1.0 * FINER}
    plotter.add_mesh(glyphs, color="black", lighting=False, silhouette=rim, show_scalar_bar=False)
