"""What the viewer shows: a mesh in a pyvista plotter, changed by settings; no page and no server."""

from __future__ import annotations

import os
import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from febkit.files import stamp
from febkit.model import InputError
from febkit.plots import render
from febkit.plots.camera import Camera
from febkit.plots.quantity import PLACES, Quantity, clock, quantity, words

if TYPE_CHECKING:
    import xarray as xr

    from febkit.model import Model

_SAMPLED = 11  # states that the colours of the whole run are taken from
_EDGES_UP_TO = 50_000  # elements
_KINEMATIC = ("effective_strain", "max_shear_strain", "principal_strain", "volume")  # of displacements alone


@dataclass(frozen=True, slots=True)
class Show:
    """Settings. ``cut`` is an axis or "", ``at`` its share of the body's extent; ``parts`` None for all;
    ``fit``: colours span this state, not the run."""

    variable: str = ""
    t: int = -1
    scale: float = 1.0
    parts: tuple[str, ...] | None = None
    cut: str = ""
    at: float = 0.5
    edges: bool = True
    fit: bool = False
    colours: str = "viridis"


class Stage:
    """A plotter and the result in it."""

    def __init__(
        self, results: xr.Dataset | str | os.PathLike[str], show: Show = Show(), *, model: Model | None = None,
        units: str | None = None,
    ) -> None:  # fmt: skip
        render.load()
        self.path = None if hasattr(results, "data_vars") else Path(results)
        self.model, self.units = model, units
        self.ds: xr.Dataset = results if self.path is None else self._open()  # type: ignore[assignment]
        self._stamp = stamp(self.path) if self.path else None
        if not self.ds.sizes["time"] and self.path is None:
            raise InputError("the result holds no state")
        few = self.ds.sizes["element"] < _EDGES_UP_TO
        self.show = replace(show, variable=show.variable or self._first(), edges=few)
        self.quantity: Quantity = quantity(self.ds, self.show.variable, model)
        self._ends: dict[str, tuple[float, float]] = {}
        self._plotter: Any = None
        self._shown: dict[int, Any] = {}  # actor's address -> mesh

    def _open(self) -> xr.Dataset:
        from febkit.results import open as open_results

        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # a file that a run is writing ends in the midst of a state
            return open_results(str(self.path), units=self.units)

    def _first(self) -> str:
        names = self.variables()
        return next((n for n in ("effective_fluid_pressure", "stress", "displacement") if n in names), names[0])

    @property
    def name(self) -> str:
        return self.path.name if self.path else str(self.ds.attrs.get("title", "")) or "result"

    def variables(self) -> list[str]:
        """Variables and fields that can be drawn on nodes or elements."""
        found = []
        for n, v in self.ds.data_vars.items():
            lives = {d for d in v.dims if d in PLACES}
            if "time" in v.dims and v.dtype.kind == "f" and lives & {"node", "element", "domain"}:
                found.append(str(n))
        if "displacement" in self.ds:
            found += [f for f in _KINEMATIC if f not in found]
        if not found:
            raise InputError("the result holds no variable on nodes or elements")
        return found

    def components(self, name: str) -> list[str]:
        """What may follow "name:"; [] of scalars."""
        if name in self.ds.data_vars:
            return words(self.ds[name])
        return ["first", "second", "third"] if name == "principal_strain" else []

    def parts(self) -> list[str]:
        from febkit.metrics.selection import part_names

        return list(dict.fromkeys(part_names(self.ds)))

    @property
    def t(self) -> int:
        """The state shown."""
        n = self.ds.sizes["time"]
        return min(self.show.t if self.show.t >= 0 else n + self.show.t, n - 1)

    @property
    def clock(self) -> str:
        return clock(self.ds, self.t) if self.ds.sizes["time"] else "no state yet"

    def times(self) -> list[float]:
        return [float(t) for t in self.ds["time"].values]

    def grew(self) -> bool:
        """Whether the file has changed; if so it is read again, and the last state shown stays the last."""
        if self.path is None or stamp(self.path) == self._stamp:
            return False
        before, now = self.ds, stamp(self.path)
        try:
            self.ds = self._open()
        except (InputError, OSError):  # no complete header yet: once more in a while
            return False
        self._stamp = now
        last = before.sizes["time"] and self.show.t in (-1, before.sizes["time"] - 1)
        before.close()
        self._ends.clear()
        self.quantity = quantity(self.ds, self.show.variable, self.model)
        if last:
            self.show = replace(self.show, t=-1)
        return True

    def set(self, **changes: Any) -> None:
        """Change settings. Raises InputError, with all as before, where a variable or colour map is unknown."""
        show = replace(self.show, **changes)
        if show.variable != self.show.variable:
            self.quantity = quantity(self.ds, show.variable, self.model)
        self.show = show

    @property
    def plotter(self) -> Any:
        """The plotter, made in the thread that draws."""
        if self._plotter is None:
            pv = render.load()
            try:
                with pv.vtk_verbosity("off"):  # of how it looks for a display
                    self._plotter = pv.Plotter(off_screen=True, window_size=[900, 700], lighting="light kit")
                    self._plotter.set_background("white")
                    self._plotter.add_axes(color="black", line_width=3)
                    self._plotter.render_window.Render()
            except (RuntimeError, AttributeError) as e:
                raise InputError(f"nothing can be rendered here: {e}") from None
        return self._plotter

    def draw(self) -> str:
        """Bring the plotter up to the settings; what cannot be shown, in words, or ""."""
        p = self.plotter
        shell, face, said = None, None, ""
        try:
            if not self.ds.sizes["time"]:
                raise InputError("no state yet")
            shell, face = self._shot().at(self.t)
            ends = self._limits(shell, face)
        except InputError as e:
            said = str(e)
        for name in ("shell", "face"):
            p.remove_actor(name, render=False)
        for title in list(p.scalar_bars.keys()):
            p.remove_scalar_bar(title, render=False)
        self._shown = {}
        if said:
            return said
        self._add("shell", shell, ends, face is None, ambient=0.3)
        if face is not None:
            self._add("face", face, ends, True, lighting=False)
        return ""

    def _add(self, name: str, mesh: Any, ends: tuple[float, float], bar: bool, **look: Any) -> None:
        actor = self.plotter.add_mesh(
            mesh, name=name, scalars="colour", cmap=self.show.colours, clim=list(ends), nan_color="lightgrey",
            show_edges=self.show.edges, edge_color="#404040", edge_opacity=0.4, line_width=1, show_scalar_bar=bar,
            reset_camera=False, render=False, scalar_bar_args={
                "title": "\n".join(wrap(self.quantity.label, 18)) + "\n", "color": "black", "vertical": True,
                "position_x": 0.86, "position_y": 0.12, "height": 0.7, "width": 0.06, "fmt": "%.4g", "n_labels": 6,
                "title_font_size": 16, "label_font_size": 14,
            }, **look,
        )  # fmt: skip
        self._shown[actor.memory_address] = mesh

    def _shot(self) -> render.Shot:
        s = self.show
        parts = self.parts() if s.parts is None else [p for p in self.parts() if p in s.parts]
        if not parts:
            raise InputError("no part is shown: tick one")
        chosen = None if s.parts is None or not self.parts() else parts
        shot = render.shot(self.ds, s.variable, None, chosen, None, self.model, s.edges, s.colours, s.scale)
        return replace(shot, plane=self._plane(shot.rows)) if s.cut else shot

    def _plane(self, rows: NDArray[np.int64]) -> render.Plane:
        conn = self.ds["connectivity"].values[rows]
        x = self.ds["X"].values[np.unique(conn[conn >= 0]), "xyz".index(self.show.cut)]
        return render.Plane(self.show.cut, float(x.min() + self.show.at * (x.max() - x.min())))

    def _limits(self, shell: Any, face: Any) -> tuple[float, float]:
        if self.show.fit:
            return render.limits_of(render.seen(shell, face))
        key = self.show.variable
        if key not in self._ends:
            n = self.ds.sizes["time"]
            states = np.unique(np.linspace(0, n - 1, min(n, _SAMPLED)).round().astype(int))
            self._ends[key] = render.limits_of(np.concatenate([self.quantity.state(int(t)) for t in states]))
        return self._ends[key]

    def look(self, camera: str | None = None) -> None:
        """Aim the camera at what is shown."""
        meshes = list(self._shown.values())
        if meshes:
            Camera.of(camera, self.show.cut or None, 0.85).onto(*meshes).aim(self.plotter)
            self.plotter.camera.window_center = (0.12, 0.0)

    def pick(self, x: float, y: float) -> dict[str, Any] | None:
        """What is seen at a pixel (from the lower left): element and nearest node by id, and the value; or None.

        {"element", "node", "part", "value", "text"}
        """
        from vtkmodules.vtkRenderingCore import vtkCellPicker

        picker = vtkCellPicker()
        picker.SetTolerance(1e-4)
        if not picker.Pick(x, y, 0, self.plotter.renderer) or picker.GetActor() is None:
            return None
        mesh = self._shown.get(picker.GetActor().GetAddressAsString(""))
        if mesh is None:
            return None
        row = int(mesh.cell_data["row"][picker.GetCellId()])
        return self._said(row, np.array(picker.GetPickPosition()))

    def _said(self, row: int, place: NDArray[np.float64]) -> dict[str, Any]:
        ds, q = self.ds, self.quantity
        nodes = ds["connectivity"].values[row]
        nodes = nodes[nodes >= 0]
        x = ds["X"].values[nodes].astype(float)
        if "displacement" in ds:
            x = x + self.show.scale * ds["displacement"].isel(time=self.t, node=nodes).values
        node = int(nodes[np.linalg.norm(x - place, axis=1).argmin()])
        part = int(ds["part"].values[row])
        at = {"node": node, "element": row, "domain": part}[q.place]
        value = float(q.state(self.t, np.array([at]))[0])
        ids = {"element": int(ds["element_id"].values[row]), "node": int(ds["node_id"].values[node])}
        names = self.parts()
        unit = "" if q.units in ("", "1") else f" {q.units}"
        name = names[part] if part < len(names) else ""
        first, second = ("node", "element") if q.place == "node" else ("element", "node")
        here = f"{first} {ids[first]} ({second} {ids[second]}{', ' + name if name else ''})"
        text = f"{here}: {q.text} = {value:.6g}{unit}"
        return {**ids, "part": name, "value": value, "text": text}

    def close(self) -> None:
        if self._plotter is not None:
            self._plotter.close()
            self._plotter = None
        if self.path is not None:
            self.ds.close()


def of_names(names: Sequence[str]) -> list[dict[str, str]]:
    """Entries of a list on the page: FEBio's names, underscores as spaces."""
    return [{"title": n.replace("_", " "), "value": n} for n in names]
