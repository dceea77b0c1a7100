"""Runs that start from a state of another result."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import febkit
from febkit import materials as mt
from febkit.model import InputError

TIGHT = {"dtol": 1e-9, "etol": 1e-16, "min_residual": 1e-28}


def creep(time: float, solid: bool = False) -> febkit.Model:
    """A column under a load that stays; biphasic: the water leaves through its top."""
    m = febkit.Model("solid" if solid else "biphasic", units="mm-N-s")
    m.add_block("column", (1, 1, 2), (1, 1, 4))
    E = mt.NeoHookean(E=0.5, v=0.2)
    m.materials["tissue"] = E if solid else mt.Biphasic(
        solid=E, permeability=mt.PermHolmesMow(perm=5e-2, M=1.0, alpha=1.0), phi0=0.25)  # fmt: skip
    m.fix("all", "x", "y")
    m.fix(m.nodes(z="min"), "z")
    if not solid:
        m.fix(m.nodes(z="max"), "p")
    m.load(m.faces(z="max"), "traction", traction=(0, 0, -0.1))
    m.step(time=time, dt=0.5, fixed=True, solver=TIGHT)
    return m


@pytest.mark.parametrize("solid", [True, False])
def test_a_run_goes_on_where_another_ended(solid: bool, tmp_path: Path) -> None:
    variables = ["displacement"] if solid else ["displacement", "effective fluid pressure"]
    half, whole = creep(4.0, solid).solve(tmp_path / "half.xplt", variables=variables), creep(8.0, solid).solve()
    rest = creep(4.0, solid).solve(start=str(tmp_path / "half.xplt"))
    assert half.converged and rest.converged
    scale = np.abs(whole.state.d).max(axis=0)
    assert np.abs(rest.state.d - whole.state.d).max(axis=0) == pytest.approx(0.0 * scale, abs=2e-6)
    if not solid:  # it is not at its end yet
        assert np.abs(half.state.d - whole.state.d).max() > 1e-3
        early = creep(6.0).solve(start=f"{tmp_path / 'half.xplt'}@2")
        assert np.abs(early.state.d - whole.state.d).max() < 2e-6


def test_what_cannot_be_started_from_is_refused(tmp_path: Path) -> None:
    plot = tmp_path / "half.xplt"
    creep(1.0).solve(plot, variables=["displacement"])
    with pytest.raises(InputError, match='holds no "effective fluid pressure"'):
        creep(1.0).solve(start=str(plot))
    creep(1.0, solid=True).solve(plot, variables=["displacement"])
    with pytest.raises(InputError, match="no state at time 7; the nearest is at 1"):
        creep(1.0, solid=True).solve(start=f"{plot}@7")
    longer = creep(1.0, solid=True)
    longer.add_block("more", (1, 1, 1), (1, 1, 1))
    with pytest.raises(InputError, match="nodes of the model are not in this result"):
        longer.solve(start=str(plot))
