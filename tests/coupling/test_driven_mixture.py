"""A charged cell driven by a charged tissue: its surface does what the series says, ions included."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest

import febkit
from febkit import coupling, templates
from febkit.coupling.field import Field, blocks_of
from febkit.solver.run import Listener

TIMES = [0.0, 1.0, 2.0]
FIELDS = ("displacement", "fluid pressure", "concentration 1", "concentration 2")
STEPS = dict(physics="triphasic", times=TIMES, first_step=1.0, ramp_step=1.0, longest_step=1.0)


@dataclass
class History(Listener):
    """All nodal unknowns at the must points, in double precision."""

    times: list[float] = field(default_factory=list)
    d: list[np.ndarray] = field(default_factory=list)

    def save(self, run: Any, status: int) -> None:
        self.times.append(run.state.time)
        self.d.append(np.hstack([run.state.of(n) for n in FIELDS]))


def solved(model: Any) -> tuple[np.ndarray, np.ndarray]:
    """Times, and displacement, pressure and two concentrations (time, node, 6)."""
    history = History()
    result = febkit.solve(model, listeners=[history])
    assert result.converged, result.reason
    return np.array(history.times), np.array(history.d)


@pytest.mark.parametrize(("order", "fluid", "solute"), [(1, 1, 1), (2, 2, 2), (2, 1, 0)])
def test_the_surface_of_a_charged_cell_follows_the_series(tissue, order, fluid, solute):
    model = templates.new("cell", drive="none", n=6, cells=1, layers=[1, 1, 1], seed=3, **STEPS)
    nodes = coupling.surface_nodes(model.mesh)
    series = coupling.series(tissue, (0, 0, 0.4), order=order)
    given = coupling.handoff(
        series, model.mesh.X[nodes], order=order, fluid_order=fluid, solute_order=solute
    )
    t, d = solved(coupling.drive(model, given, nodes).model)
    at = np.abs(given.times[None] - t[:, None]).argmin(axis=1)
    wanted = np.concatenate([given.u[at], given.p[at][..., None], given.c[at]], axis=-1)
    scale = [np.abs(given.u).max()] * 3 + [np.abs(given.p).max(), *np.abs(given.c).max(axis=(0, 1))]
    assert (np.abs(d[:, nodes] - wanted) <= 1e-14 * np.array(scale)).all()
    if order == solute:  # ions are told apart, and what they do is no constant
        assert np.abs(given.c[-1, :, 0] - given.c[-1, :, 1]).max() > 1
        assert np.ptp(given.c[-1, :, 0]) > 1e-3 * given.c.max()


@pytest.fixture(scope="module")
def tissue() -> Field:
    """A charged column of the tissue, its top pressed down and in the bath."""
    model = templates.new("tissue", case="B", n=3, vertical=11, centre=0.0, **STEPS)
    t, d = solved(model)
    blocks = blocks_of(model.mesh.X, [(b.type, b.conn) for b in model.mesh.blocks])
    return Field(model.mesh.X, blocks, t, d[..., :3], d[..., 3], c=d[..., 4:], solutes=("Na+", "Cl-"))
