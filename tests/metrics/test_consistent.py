"""Consistent exchange (the flux that the discrete pressure equation balances) against the change of volume."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import febkit
from febkit import templates
from febkit.metrics import cell_metrics
from febkit.model import Component, Domain
from febkit.results import open as open_results

EVERY = ("PLOT_MUST_POINTS", "PLOT_MAJOR_ITRS")
# FEBio's least residual, 1e-20, ends Newton's loop early in micrometres, newtons and seconds
SHARP = ("<ptol>", "<min_residual>1e-40</min_residual><ptol>")
FLOWS = ("updates", "dtol", "etol", "ptol"), (0, 1e-8, 1e-16, 1e-8)


def solve(folder: Path, name: str, *edits: tuple[str, str], **values):
    """A template's model, its file edited, every step plotted: model and result."""
    febkit.write(templates.new(name, **dict(zip(*FLOWS)), **values), folder / "m.feb")
    text = re.sub(r"<min_residual>.*?</min_residual>", "", (folder / "m.feb").read_text())
    for old, new in (EVERY, SHARP, *edits):
        assert old in text, old
        text = text.replace(old, new)
    (folder / "m.feb").write_text(text)
    model = febkit.read(folder / "m.feb").record
    result = febkit.solve(model, folder / "m.xplt")
    assert result.converged, result.reason
    with open_results(folder / "m.xplt") as ds:
        return model, ds.load()


def chondrocyte(folder: Path, *edits: tuple[str, str], step: float = 2.0, **more):
    """A soft cell in its PCM in ECM, the mesh of tests/metrics/test_solved.py at its coarsest."""
    return solve(folder, "cell", *edits, case="C", times=[0, 2, 4], ramp=4.0, first_step=step, longest_step=step,
                 ramp_step=step, n=6, block=4, edge=0.04, cells=1, layers=[2, 2, 2], **more)  # fmt: skip


def rates(ds, model, exchange="consistent", cells=None):
    """Exchange and -rho dV/dt (time,) of the one cell, without the first state."""
    m = cell_metrics(ds, model, cells, exchange=exchange).isel(cell=0, time=slice(1, None))
    return m.mass_exchange_rate.values, m.volume_loss_rate.values


@pytest.fixture(scope="module")
def many_steps(tmp_path_factory):
    """16 steps, their velocities too."""
    return chondrocyte(tmp_path_factory.mktemp("many"), step=0.25, velocity=True)


HOLMES_MOW = '<permeability type="perm-Holmes-Mow"><perm>0.002</perm><M>2</M><alpha>1.5</alpha></permeability>'
CONSTANT = '<permeability type="perm-const-iso">\n\t\t\t\t<perm>0.002</perm>\n\t\t\t</permeability>'
STARLING = '<solvent_supply type="Starling"><kp>20</kp><pv>0.002</pv></solvent_supply>'


@pytest.mark.parametrize(
    "edits", [(), ((CONSTANT, HOLMES_MOW),), ((CONSTANT, CONSTANT + STARLING),)],
    ids=["study", "strain-dependent permeability", "solvent supply"],
)  # fmt: skip
def test_fluid_leaves_a_chondrocyte_as_fast_as_it_shrinks(tmp_path, edits):
    """Outflow from the elements around = -rho dV/dt to Newton's tolerance, where nodal fluxes miss it by a tenth."""
    model, ds = chondrocyte(tmp_path, *edits)
    rate, balance = rates(ds, model)
    assert (np.abs(balance) > 1).all()
    np.testing.assert_allclose(rate, balance, rtol=1e-5)
    assert (np.abs(rates(ds, model, "nodal")[0] / balance - 1) > 0.05).all()


@pytest.mark.parametrize("kind", ["hex8", "hex20", "hex27", "tet4", "tet10", "penta6"])
def test_every_element_kind(tmp_path, kind):
    """The middle of a drained cube of 27 lattice cells, compressed unevenly and held."""
    model, ds = solve(tmp_path, "tissue", case="D", n=3, vertical=3, centre=0.0, edge=0.03, depth=0.003, element=kind,
                      times=[0, 0.5, 1, 2], ramp=1.0, first_step=0.5, longest_step=0.5, ramp_step=0.5)  # fmt: skip
    x, conn = ds.X.values, ds.connectivity.values
    middle = np.array([x[row[row >= 0]].mean(axis=0) for row in conn])
    away = np.abs(middle - (x.min(axis=0) + x.max(axis=0)) / 2).max(axis=1)
    rate, balance = rates(ds, model, cells={"cell": np.flatnonzero(away < 0.005)})
    assert ds.sizes["time"] == 5 and balance.min() < balance.max() / 20
    np.testing.assert_allclose(rate, balance, rtol=0, atol=1e-5 * balance.max())


def test_states_between_which_steps_were_not_written(many_steps):
    """Velocities of the last step stand in for the state before it; without them the interval does, and says so."""
    model, ds = many_steps
    every, balance = rates(ds, model)
    np.testing.assert_allclose(every, balance, rtol=1e-5)
    few, last = ds.isel(time=[0, 8, 16]), balance[[7, 15]]
    rate, interval = rates(few, model)
    np.testing.assert_allclose(rate, last, rtol=2e-4)
    assert abs(interval[0] / last[0] - 1) > 0.03  # -rho dV/dt of the states is not that of their last steps
    bare = few.drop_vars("nodal_velocity")
    np.testing.assert_allclose(rates(bare, model)[0], last, rtol=0.005)
    said = [cell_metrics(d, model, exchange="consistent").mass_exchange_rate.attrs["storage"] for d in (ds, few, bare)]
    assert "over the solved step" in said[0] and "(at 16 of 17 times)" in said[0]
    assert "nodal velocity" in said[1] and "over the interval between states" in said[2]
    # a plotfile whose velocities were not computed is read as one that has none
    zero = few.assign(nodal_velocity=few.nodal_velocity * 0)
    np.testing.assert_array_equal(rates(zero, model)[0], rates(bare, model)[0])


def test_no_storage_in_a_steady_state(tmp_path):
    model, ds = chondrocyte(tmp_path, (">TRANSIENT<", ">STEADY-STATE<"))
    rate, between = rates(ds, model)
    assert (np.abs(rate) < 1e-5 * np.abs(between)).all()


def test_the_elements_inside_give_the_same_by_identity(many_steps):
    """What leaves the rest enters the cell: the part of the mesh outside of it is a cell as well, sealed elsewhere."""
    model, ds = many_steps
    part = np.asarray([p.startswith("cell") for p in ds.attrs["parts"]])[ds.part.values]
    m = cell_metrics(ds, model, {"in": np.flatnonzero(part), "out": np.flatnonzero(~part)}, exchange="consistent")
    inside, outside = m.mass_exchange_rate.values
    np.testing.assert_allclose(outside, -inside, atol=1e-5 * inside.max())
    assert "count as sealed" in m.mass_exchange_rate.attrs["how"]


def test_radial_flux(many_steps, coated_mesh, make):
    """p = c/(k r) has q = c r/r^3: mass rate 4 pi rho c, of order 2 in the elements around."""
    model, c, k, error = many_steps[0], 0.7e-6, 0.001, []
    model = replace(model, domains=tuple(Domain(p, "solid", "chondrocyte") for p in ("cell1", "pcm1")))
    assert [m.need("permeability").float("perm") for m in model.materials if m.name == "chondrocyte"] == [k]
    for n in (6, 12):
        X, cell, pcm = coated_mesh(n, 0.005, n // 3)
        ds = make(X, [("hex8", "cell1", cell), ("hex8", "pcm1", pcm)], lambda X, t: X,
                  pressure=lambda X, t: c / (k * np.maximum(np.linalg.norm(X, axis=1), 1e-4)))  # fmt: skip
        rate = rates(ds, model)[0].item()
        error.append(abs(rate / (4 * np.pi * c * 1e9) - 1))
    assert np.log2(error[0] / error[1]) > 1.8
    assert error[1] < 0.02


def test_what_it_cannot_do_is_said(many_steps):
    model, ds = many_steps
    with pytest.raises(ValueError, match="consistent"):
        cell_metrics(ds, model, exchange="surface")
    without = cell_metrics(ds, exchange="consistent")
    assert "mass_exchange_rate" not in without and "needs the effective fluid pressure" in without.attrs["missing"]
    whole = cell_metrics(ds, model, {"all": np.arange(ds.sizes["element"])}, exchange="consistent")
    assert np.isnan(whole.mass_exchange_rate).all()
    assert "count as sealed" in whole.mass_exchange_rate.attrs["how"]
    pulled = replace(model, common=replace(model.common, loads=(Component("body_load", type="const"),)))
    assert "mass_exchange_rate" in cell_metrics(ds, pulled, exchange="consistent")  # on the solid alone
    heavy = Path(model.file).with_name("heavy.feb")
    heavy.write_text(Path(model.file).read_text().replace("<fluid_density>0<", "<fluid_density>1<"))
    pulled = replace(febkit.read(heavy).record, common=pulled.common)
    assert "without body forces" in cell_metrics(ds, pulled, exchange="consistent").attrs["missing"]
