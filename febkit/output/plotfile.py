"""Writes the states of a run to a plotfile."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from febkit.model import Model
from febkit.model.species import solid_bound, solutes
from febkit.results.variables import VARIABLES
from febkit.results.xplt.records import PlotDomain, PlotMesh, PlotSurface, PlotVariable
from febkit.results.xplt.writer import PlotWriter
from febkit.solver.finite import NotFinite, whole
from febkit.solver.result import Result
from febkit.solver.run import Listener, Run

from . import fields

if TYPE_CHECKING:
    from os import PathLike

Floats = NDArray[np.float64]


def plot_mesh(model: Model) -> PlotMesh:
    """The mesh section of a model: its domains in the order of <MeshDomains>."""
    ids = {m.name: m.id or k + 1 for k, m in enumerate(model.materials)}
    domains = []
    for d in model.domains:
        b = model.mesh.block(d.block)
        name = d.block if d.kind == "solid" else None
        domains.append(PlotDomain(b.type, ids.get(d.material, 0), name, b.ids, b.conn))
    return PlotMesh(
        model.mesh.node_ids,
        model.mesh.X,
        domains,
        [PlotSurface(s.name, dict(s.facets)) for s in model.mesh.surfaces.values()],
        {n: s.nodes for n, s in model.mesh.node_sets.items()},
        {n: s.elements for n, s in model.mesh.element_sets.items()},
        [(ids[m.name], m.name or "") for m in model.materials],
    )


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

    def __init__(self, model: Model, path: str | PathLike[str], warn: Callable[[str], None]) -> None:
        self.model = model
        self.names: list[str] = []
        variables: list[PlotVariable] = []
        mixture = bool(solutes(model))
        for v in model.output.plot:
            if v.type not in VARIABLES or v.surface or not fields.known(v.type, mixture):
                warn(f'plot variable "{v.type}" is not computed by febkit and is left out')
            elif v.type not in self.names:
                self.names.append(v.type)
                variables.append(self._variable(v.type))
        spec = model.output.plot_spec
        compress = spec is not None and spec.bool("compression")
        self.mesh = plot_mesh(model)
        self.writer = PlotWriter(
            path, self.mesh, variables, compress=compress, software="febkit", units=model.units, live=False,
        )  # fmt: skip
        self.states = 0

    def _variable(self, name: str) -> PlotVariable:
        """The record of a variable; arrays over solutes and solid-bound molecules have the names of these."""
        kind = fields.ARRAYS.get(name)
        if kind is None:
            return VARIABLES[name]
        names = tuple(s.name for s in (solutes if kind == "solute" else solid_bound)(self.model))
        return replace(VARIABLES[name], n=len(names), array_names=names)

    def save(self, run: Run, status: int) -> None:
        data: dict[str | int, Any] = {name: self._values(run, name) for name in self.names}
        self.writer.state(run.state.time, data, status)
        self.states += 1
        if run.totals.steps or not self.writer.output.replaces:
            self.writer.output.place()

    def _values(self, run: Run, name: str) -> Any:
        if VARIABLES[name].section == "node":
            return {0: single(fields.NODAL[name](run)[: len(self.mesh.X)], name)}
        if name in fields.SURFACE:
            at = {s.name: k + 1 for k, s in enumerate(self.mesh.surfaces)}
            return {at[s]: single(v, name) for s, v in fields.on_surfaces(run, name).items()}
        out: dict[int, Any] = {}
        nodal = fields.DOMAIN_NODAL.get(name)
        groups = {g.block.name: g for g in run.groups}
        for k, (part, domain) in enumerate(zip(self.model.domains, self.mesh.domains, strict=True)):
            group = groups.get(part.block)
            if group is None:  # a rigid part deforms nowhere
                continue
            if nodal is not None:
                if nodal in group.fields:
                    out[k + 1] = single(run.state.of(nodal)[domain.nodes()].squeeze(axis=-1), name)
                continue
            if name == fields.SOLUTES:
                v: Any = fields.concentrations(run, group, domain.nodes())
            elif name in fields.INTERPOLATED:
                v = fields.interpolated(fields.INTERPOLATED[name](run), group)
            else:
                v = fields.domain(name)(group)
            if v is not None:
                out[k + 1] = single(v, name)
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
