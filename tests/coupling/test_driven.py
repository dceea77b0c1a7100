"""Cell models driven in case B: their surface does what the series says, and order 2 comes nearer to the control."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest

import febkit
from febkit import coupling, templates
from febkit.solver.run import Listener

TIMES = [0.0, 0.1, 1.0, 2.0, 3.0, 5.0, 8.0]
CELL = dict(n=6, cells=1, layers=[1, 1, 1], seed=3, times=TIMES)


@dataclass
class History(Listener):
    """Nodal u and p of the must points, in double precision."""

    times: list[float] = field(default_factory=list)
    u: list[np.ndarray] = field(default_factory=list)
    p: list[np.ndarray] = field(default_factory=list)

    def save(self, run: Any, status: int) -> None:
        self.times.append(run.state.time)
        self.u.append(run.state.u.copy())
        self.p.append(run.state.p.copy())


def solved(model: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    history = History()
    result = febkit.solve(model, listeners=[history])
    assert result.converged, result.reason
    times = np.array(history.times)
    assert np.allclose(times, TIMES[-len(times):], rtol=1e-12)
    return times, np.array(history.u), np.array(history.p)


@pytest.fixture(scope="module")
def tissue():
    """A column of the tissue (case B is uniform in x and y), fine enough for the front that passes its middle."""
    from febkit.coupling.field import Field, blocks_of

    model = templates.new("tissue", case="B", n=3, vertical=40, centre=0.0, times=TIMES)
    t, u, p = solved(model)
    return Field(model.mesh.X, blocks_of(model.mesh.X, [(b.type, b.conn) for b in model.mesh.blocks]), t, u, p)


@pytest.fixture(scope="module")
def control():
    """Times, and u and p of the control; its first nodes are the cell model's."""
    return solved(templates.new("embedded", case="B", transition="none", lateral=1, vertical=14, **CELL))


def driven(tissue, order: int, recovery: str):
    """Times, u, p, the hand-off, and the nodes it is on."""
    model = templates.new("cell", drive="none", **CELL)
    nodes = coupling.surface_nodes(model.mesh)
    series = coupling.series(tissue, (0, 0, 0), order=order, recovery=recovery)
    given = coupling.handoff(series, model.mesh.X[nodes], order=order, fluid_order=order)
    t, u, p = solved(coupling.drive(model, given, nodes).model)
    return t, u, p, given, nodes


def away(found: np.ndarray, true: np.ndarray, inner: np.ndarray) -> float:
    """Relative difference inside; the mean over the nodes (rigid motion, uniform pressure) does not count."""
    a, b = (v[:, inner] - v[:, inner].mean(axis=1, keepdims=True) for v in (found, true))
    return float(np.linalg.norm(a - b) / np.linalg.norm(b))


def test_the_surface_follows_the_series_and_order_two_comes_nearer_to_the_control(tissue, control):
    times, U, Q = control
    inside = {}
    for order, recovery in ((1, "patches"), (2, "patches"), (2, "element")):
        t, u, p, given, nodes = driven(tissue, order, recovery)
        at = np.abs(given.times[None] - t[:, None]).argmin(axis=1)
        assert np.abs(u[:, nodes] - given.u[at]).max() <= 1e-14 * np.abs(given.u).max()
        assert np.abs(p[:, nodes] - given.p[at]).max() <= 1e-14 * np.abs(given.p).max()
        n, late = u.shape[1], t >= 1.0  # before, nothing but the pressure has changed in the middle
        inner = np.setdiff1d(np.arange(n), nodes)
        k = np.abs(times[None] - t[:, None]).argmin(axis=1)
        inside[order, recovery] = [away(own[late], other[k][late, :n], inner) for own, other in ((u, U), (p, Q))]
    for first, second in zip(inside[1, "patches"], inside[2, "patches"]):
        assert second < 0.5 * first and second < 0.05, inside
    # a brick's own second derivatives are zero along its edges: order 2 by element gains nothing
    assert inside[2, "element"][0] > 2 * inside[2, "patches"][0], inside
