"""Derivatives of results by parameters of a model, beside central differences of whole runs."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

import febkit
from febkit import materials as mt
from febkit.model import InputError
from febkit.modelling.solution import Solution
from helpers import charged

PLOT = ["displacement", "reaction forces", "effective fluid pressure", "stress"]
TIGHT = {"dtol": 1e-9, "etol": 0, "ptol": 1e-9, "min_residual": 1e-30, "max_refs": 60}


def plug() -> febkit.Model:
    """A viscoelastic solid in fluid, stiffer with height, pressed down and held."""
    m = febkit.Model("biphasic")
    m.add_block("plug", (1, 1, 1), (2, 1, 1))
    m.materials["cartilage"] = mt.Biphasic(
        solid=mt.Viscoelastic(elastic=mt.NeoHookean(E=0.6, v=0.1), g1=0.5, t1=2.0),
        permeability=mt.PermHolmesMow(perm=2e-2, M=1.3, alpha=2.0), phi0=0.2)  # fmt: skip
    m.materials["cartilage"].solid.elastic.v = "0.1 + 0.1*Z"
    for axis in "xyz":
        m.fix(m.nodes(**{axis: 0}), axis)
    m.fix(m.nodes(x="max"), "p")
    m.node_sets["top"] = m.nodes(z="max")
    m.prescribe("top", z=-0.1, curve=[(0, 0), (1, 1)])
    m.output.plot = PLOT
    m.step(time=3, dt=0.5, dtmax=1)
    for name, value in TIGHT.items():
        setattr(m.control.solver, name, value)
    return m


def both(m: febkit.Model, paths: list[str], monkeypatch: pytest.MonkeyPatch) -> tuple[Solution, Solution]:
    """Derivatives from the equations, and by differences."""
    direct = m.solve(sensitivity=paths, sensitivity_tolerance=1e-7)
    assert direct.converged, direct.reason
    assert direct.sensitivity["method"].values.tolist() == ["direct"] * len(paths)
    with monkeypatch.context() as patch:
        patch.setattr("febkit.solver.sensitivity.refusal", lambda problem: "differences were asked for")
        other = m.solve(sensitivity=paths)
    assert other.sensitivity["method"].values.tolist() == ["differences"] * len(paths)
    assert other.sensitivity.attrs["why"][paths[0]] == "differences were asked for"
    return direct, other


def assert_same(a: xr.Dataset, b: xr.Dataset, rtol: float) -> None:
    for name in b.data_vars:
        for k in range(b.sizes["parameter"]):
            x, y = (np.asarray(q[name][k].values, float) for q in (a, b))
            assert np.isfinite(y).all() and np.abs(y).max() > 0.0
            assert np.abs(x - y).max() <= rtol * np.abs(y).max(), (name, a["parameter"].values[k])


def test_derivatives_of_a_result(monkeypatch: pytest.MonkeyPatch) -> None:
    m, c = plug(), "cartilage"
    paths = [f"{c}.solid.elastic.E", f"{c}.solid.g1", f"{c}.solid.t1", f"{c}.solid.elastic.v", f"{c}.permeability.perm",
             f"{c}.permeability.M", "fem.bc[4].value", "fem.load_controller[0].points[1].y"]  # fmt: skip
    direct, other = both(m, paths, monkeypatch)
    s = direct.sensitivity
    assert s["displacement"].dims == ("parameter", *direct.dataset["displacement"].dims)
    assert s["value"].values[3] == 1.0  # a formula counts by a factor
    assert float(np.abs(s["effective_fluid_pressure"]).max()) > 0.1
    assert_same(s, other.sensitivity, 2e-5)
    assert np.array_equal(direct.state.d, m.solve().state.d)  # the run is as it is without

    def squares(ds: xr.Dataset) -> xr.DataArray:
        return (ds["displacement"] ** 2).sum(["node", "xyz"])

    of = direct.sensitivity_of(["reaction top z", squares])
    u, du = (q["displacement"].values.astype(float) for q in (direct.dataset, s))
    np.testing.assert_allclose(of["squares"], 2 * (u * du).sum(axis=(2, 3)), rtol=1e-6, atol=1e-9)
    top = np.flatnonzero(m.X[:, 2] == 1.0)
    expected = -s["reaction_forces"].values[:, :, top, 2].sum(axis=2)  # on the supports
    np.testing.assert_allclose(of["reaction top z"], expected, rtol=1e-5, atol=1e-7)


def test_derivatives_of_a_model_that_comes_to_rest(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its pressure fades to rounding, which no balance gets below; what is left are derivatives of the rest."""
    m = febkit.Model("biphasic")
    m.add_block("plug", (1, 1, 1), (2, 1, 1))
    m.materials["cartilage"] = mt.Biphasic(solid=mt.NeoHookean(E=0.6, v=0.1), phi0=0.2,
                                           permeability=mt.PermConstIso(perm=2e-2))  # fmt: skip
    for axis in "xyz":
        m.fix(m.nodes(**{axis: 0}), axis)
    m.fix(m.nodes(x="max"), "p")
    m.node_sets["top"] = m.nodes(z="max")
    m.prescribe("top", z=-0.1, curve=[(0, 0), (1, 1)])
    m.step(time=20000, dt=1, dtmax=500)
    m.output.plot = PLOT
    paths = ["cartilage.solid.E", "cartilage.permeability.perm"]
    plain = m.solve(sensitivity=paths)
    assert plain.sensitivity["method"].values.tolist() == ["direct", "direct"]
    direct, other = both(m, paths, monkeypatch)
    p = direct.dataset["effective_fluid_pressure"]
    assert float(abs(p[-1]).max()) < 1e-12 * float(abs(p).max())
    force = other.sensitivity["reaction_forces"].isel(time=-1)
    assert float(abs(force[1]).max()) < 1e-6 * float(abs(force[0]).max()), "none is left by the permeability"
    for result in (plain, direct):
        assert_same(result.sensitivity.isel(parameter=[0])[["reaction_forces"]].isel(time=[-1]),
                    other.sensitivity.isel(parameter=[0])[["reaction_forces"]].isel(time=[-1]), 1e-4)  # fmt: skip


def test_values_of_nodes_need_no_elements() -> None:
    """What is asked for alone, and beside stresses, for which elements follow."""
    m = plug()
    m.materials["cartilage"] = mt.Biphasic(solid=mt.NeoHookean(E=0.6, v=0.1), phi0=0.2,
                                           permeability=mt.PermHolmesMow(perm=2e-2, M=1.3, alpha=2.0))  # fmt: skip
    paths = ["cartilage.solid.E", "cartilage.permeability.perm", "fem.bc[4].value"]
    few, many = (m.solve(variables=v, sensitivity=paths).sensitivity for v in (PLOT[:3], PLOT))
    for name in few.data_vars:
        assert float(abs(few[name]).max()) > 1e-3
        np.testing.assert_allclose(few[name], many[name], rtol=0, atol=2e-6 * float(abs(many[name]).max()))


def test_derivatives_of_a_mixture_with_ions(monkeypatch: pytest.MonkeyPatch) -> None:
    m = charged.block((1, 1, 1), (2, 1, 1), [charged.solute("Na+"), charged.solute("Cl-")])
    bath = {"Na+": 150.0, "Cl-": 150.0}
    charged.start(m, bath)
    charged.charge(m, -100.0, until=1e3)
    for axis in "xyz":
        m.fix(m.nodes(**{axis: 0}), axis)
    charged.bathe(m, m.nodes(x="max"), bath)
    m.output.plot = ["displacement", "effective fluid pressure", "effective solute concentration"]
    m.step(time=1e3, dt=500, fixed=True, solver=charged.TIGHT)
    paths = ["tissue.solid.E", "tissue.permeability.perm", "tissue.fixed_charge_density"]
    direct, other = both(m, paths, monkeypatch)
    assert_same(direct.sensitivity, other.sensitivity, 1e-4)


def test_what_is_no_parameter_is_said() -> None:
    m = plug()
    with pytest.raises(InputError, match="takes a list of parameter paths"):
        m.solve(sensitivity="cartilage.solid.g1")
    with pytest.raises(InputError, match="no parameter 'K'"):
        m.solve(sensitivity=["cartilage.solid.elastic.K"])
    with pytest.raises(InputError, match="no derivatives were asked for"):
        _ = m.solve().sensitivity
