"""Writes the states of a run to a plotfile."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from febkit._version import __version__
from febkit.model import Model
from febkit.model.elements import ALIASES
from febkit.model.species import solid_bound, solutes
from febkit.results.variables import VARIABLES
from febkit.results.xplt.records import PlotDomain, PlotMesh, PlotSurface, PlotVariable
from febkit.results.xplt.writer import PlotWriter
from febkit.solver.finite import NotFinite, whole
from febkit.solver.result import Result
from febkit.solver.run import Listener, Run

from . import plot
from .plot.asked import Asked

if TYPE_CHECKING:
    from os import PathLike

    from febkit.files import Buffer, Mark

Floats = NDArray[np.float64]
_NAME = f"febkit {__version__}"
SOFTWARE = _NAME + " " * (-len(_NAME) % 4)  # pyfebio's reader takes the name as words of four bytes


def plot_mesh(model: Model) -> PlotMesh:
    """The mesh section of a model: its domains in the order of <MeshDomains>."""
    ids = {m.name: m.id or k + 1 for k, m in enumerate(model.materials)}
    domains = []
    for d in model.domains:
        b = model.mesh.block(d.block)
        name = d.block if d.kind == "solid" else None
        domains.append(PlotDomain(ALIASES.get(b.type, b.type), ids.get(d.material, 0), name, b.ids, b.conn))
    domains += _springs(model, len(model.materials))
    return PlotMesh(
        model.mesh.node_ids,
        model.mesh.X,
        domains,
        [PlotSurface(s.name, dict(s.facets)) for s in model.mesh.surfaces.values()],
        {n: s.nodes for n, s in model.mesh.node_sets.items()},
        {n: s.elements for n, s in model.mesh.element_sets.items()},
        [(ids[m.name], m.name or "") for m in model.materials],
    )


def _springs(model: Model, materials: int) -> list[PlotDomain]:
    """A domain for each set of <Discrete>: FEBio numbers its elements after all others, its materials likewise."""
    last = max((int(b.ids.max(initial=0)) for b in model.mesh.blocks), default=0)
    kinds = [str(c.id or k) for k, c in enumerate((c for c in model.discrete if c.tag == "discrete_material"), 1)]
    out = []
    for c in model.discrete:
        if c.tag == "discrete":
            name, kind = c.attrs.get("discrete_set", ""), c.attrs.get("dmat", "")
            pairs = np.asarray(model.mesh.discrete_sets[name].pairs, np.int64)
            ids = last + 1 + np.arange(len(pairs))
            last += len(pairs)
            out.append(PlotDomain("line2", materials + 1 + kinds.index(kind), name, ids, pairs))
    return out


def single(values: Floats, name: str) -> NDArray[np.float32]:
    """Values as a plotfile holds them. Raises NotFinite where some are not finite, or too large for it."""
    with np.errstate(over="ignore"):
        out = np.asarray(values, np.float32)
    if not whole(out):
        worst = np.asarray(values)[~np.isfinite(out)].flat[0]
        raise NotFinite(f'the plot variable "{name}" is {worst:g} somewhere, which a plotfile cannot hold')
    return out


class PlotListener(Listener):
    """Writes what <plotfile> asks for; variables febkit does not compute are named once by ``warn``.

    An earlier file in its place stays until a state that was solved stands in the new one.
    """

    what = "plotfile"

    def __init__(
        self, model: Model, path: str | PathLike[str] | Buffer, warn: Callable[[str], None], mark: Mark | None = None
    ) -> None:
        self.model = model
        self.asked: list[tuple[Asked, plot.Give]] = []
        self.variables: list[PlotVariable] = []
        mixture = bool(solutes(model))
        for v in dict.fromkeys(map(Asked.of, model.output.plot)):
            give = plot.find(v.name, mixture) if v.name in VARIABLES else None
            if v.more and v.name not in plot.told:
                give = None
            record = None if give is None else self._variable(v)
            if give is None or record is None:
                warn(f'plot variable "{v.label}" is not computed by febkit and is left out')
            else:
                self.asked.append((v, give))
                self.variables.append(record)
        spec = model.output.plot_spec
        compress = spec is not None and spec.bool("compression")
        self.mesh = plot_mesh(model)
        self.writer = PlotWriter(
            path, self.mesh, self.variables, compress=compress, software=SOFTWARE, units=model.units, live=False,
            mark=mark,
        )  # fmt: skip
        self.states = 0
        self.view: plot.View | None = None
        self._meant = self._written = model.mesh  # the mesh of the next state, and that of the file's last section

    def _variable(self, asked: Asked) -> PlotVariable | None:
        """The record of a variable; arrays over solutes and solid-bound molecules have the names of these."""
        kind, known = plot.ARRAYS.get(asked.name), VARIABLES[asked.name]
        if asked.name in plot.FILES["maps"]:
            from .plot.maps import storage

            found = storage(known, asked.more, self.model)
            return None if found is None else replace(found, name=asked.label)
        if kind is None and asked.name not in plot.PARTS:
            return replace(known, name=asked.label)
        names = plot.PARTS.get(asked.name) or tuple(
            s.name for s in (solutes if kind == "solute" else solid_bound)(self.model)
        )
        return replace(known, name=asked.label, n=len(names), array_names=names)

    def remeshed(self, run: Run) -> None:
        self.model = run.problem.origin
        self._meant, self.view = self.model.mesh, None

    def save(self, run: Run, status: int) -> None:
        if self._meant is not self._written:
            self.mesh, self._written = plot_mesh(self.model), self._meant
            self.writer.mesh(self.mesh)
        if self.view is None:
            self.view = plot.View(run, self.model, self.mesh)
        self.write(run, self.values(self.view), status)

    def values(self, view: plot.View) -> list[dict[int, Floats]]:
        """What is asked for, by region, at the present state of the view's run."""
        view.renew()
        return [self._values(view, k) for k in range(len(self.asked))]

    def write(self, run: Run, values: list[dict[int, Floats]], status: int) -> None:
        """Add a state of these values."""
        data: dict[str | int, Any] = {
            k: {region: single(v, asked.name) for region, v in found.items()}
            for k, ((asked, _), found) in enumerate(zip(self.asked, values))
        }
        self.writer.state(run.state.time, data, status)
        self.states += 1
        if run.totals.steps or not self.writer.output.replaces:
            self.writer.output.place()

    def marks(self) -> list[Mark | None]:
        """How far the file stands."""
        return [self.writer.output.mark()]

    def _values(self, view: plot.View, k: int) -> dict[int, Floats]:
        """Values of a variable by region."""
        asked, give = self.asked[k]
        section = self.variables[k].section
        if section in ("node", "global"):
            v = give(view, *asked.more)
            return {} if v is None else {0: v[: len(self.mesh.X)] if section == "node" else v}
        out: dict[int, Floats] = {}
        chosen = asked.surface if section == "surface" else asked.part
        regions: list[Any] = view.faces if section == "surface" else view.parts
        for number, region in enumerate(regions, start=1):
            if chosen is None or region.name == chosen:
                v = give(region, *asked.more)
                if v is not None:
                    out[number] = v
        return out

    def end(self, run: Run, result: Result) -> None:
        if result.converged:
            self.writer.close()
        else:
            self._stop()

    def __exit__(self, *_: object) -> None:
        self._stop()

    def _stop(self) -> None:
        """End the file of a run that did not come to its end."""
        if self.states and not self.writer.output.replaces:
            self.writer.close()
        else:
            self.writer.discard()
