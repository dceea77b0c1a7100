"""What cells of charged mixtures hold and exchange, against theory and the discrete balances."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import febkit
from febkit import templates
from febkit.metrics import cell_metrics, compare, exchange, flux, groups, mixtures, osmotic
from febkit.metrics.selection import select_cells
from febkit.metrics.sources import Sources
from febkit.results import open as open_results
from helpers.forked import febkit as command

R, T, FC = 8.314e-6, 298.0, 9.65e-5  # N mm / (nmol K), K, C / nmol
SHARP = dict(updates=0, dtol=1e-9, etol=1e-18, ptol=1e-9, ctol=1e-9)


def solve(folder: Path, name: str, *edits: tuple[str, str], **values):
    """A charged template, its file edited, every step plotted: model and result."""
    febkit.write(templates.new(name, physics="triphasic", **SHARP, **values), folder / "m.feb")
    text = (folder / "m.feb").read_text()
    for old, new in (("PLOT_MUST_POINTS", "PLOT_MAJOR_ITRS"), *edits):
        assert old in text, old
        text = text.replace(old, new)
    (folder / "m.feb").write_text(text)
    model = febkit.read(folder / "m.feb").record
    result = febkit.solve(model, folder / "m.xplt")
    assert result.converged, result.reason
    with open_results(folder / "m.xplt") as ds:
        return model, ds.load()


@pytest.fixture(scope="module")
def chondrocyte(tmp_path_factory):
    """A soft cell of less charge than the matrix around, in a cube that is squeezed for two steps."""
    return solve(tmp_path_factory.mktemp("cell"), "cell", case="C", times=[0, 2, 4], ramp=4.0, first_step=2.0,
                 longest_step=2.0, ramp_step=2.0, n=6, block=4, edge=0.04, cells=1, layers=[1, 1, 1],
                 ecm_E=2.0, pcm_E=1.0, cell_E=0.5, cell_charge=-140.0)  # fmt: skip


def through_surface(model, ds) -> np.ndarray:
    """Outflow (time, solute) by the elements outside: int phi d(J phi_w c)/dt / J - j . grad phi, steps all plotted."""
    pick, sources = select_cells(ds), Sources(ds, model)
    inside = groups.make(ds, pick.rows, pick.owner, sources.parts)
    on = flux.surface(inside, 1)
    rows, owner = exchange.touching(ds, pick, on)
    keep = ~np.isin(rows, pick.rows)
    out, times = np.zeros((ds.sizes["time"], ds.sizes["solute"])), ds.time.values
    for g in groups.make(ds, rows[keep], owner[keep], sources.parts):
        law, phi = mixtures.make(sources, g), (on.slots(g.owner, g.nodes) >= 0).astype(float)
        stored = None
        for t in range(len(times)):
            s = g.at(sources.displacement(t), gradient=True)
            now = law(s, t)
            new = now.concentration * now.water * s.J  # per reference volume
            if t:
                rate = (new - stored) / s.J / (times[t] - times[t - 1])
                leaves = g.at_points(phi) * rate - (now.solute_flux * flux.gradient(g, s, phi)).sum(axis=1)
                out[t] += (leaves * s.dv).sum(axis=(-2, -1))
            stored = new
    return out


def test_solutes_leave_a_cell_through_its_surface(chondrocyte):
    """-dN/dt is the flux that the solutes' balances have in the elements around the cell."""
    model, ds = chondrocyte
    m = cell_metrics(ds, model).isel(cell=0)
    rate = m.solute_exchange_rate.values[1:]
    assert m.solute_exchange_rate.dims == ("time", "solute") and np.isnan(m.solute_exchange_rate[0]).all()
    assert m.solute_exchange_rate.attrs["units"] == "nmol/s" and (np.abs(rate) > 1e-8).any()
    np.testing.assert_allclose(rate, through_surface(model, ds)[1:], rtol=2e-3)
    # as much Na+ as Cl-: no charge gathers
    np.testing.assert_allclose(rate[:, 0], rate[:, 1], rtol=2e-3)


def test_fluid_leaves_a_charged_cell_as_fast_as_it_shrinks(chondrocyte):
    model, ds = chondrocyte
    bare = ds.drop_vars([v for v in ("nodal_fluid_flux", "fluid_flux") if v in ds])
    for found in (cell_metrics(ds, model, exchange="consistent"), cell_metrics(bare, model, exchange="consistent")):
        m = found.isel(cell=0, time=slice(1, None))
        assert (np.abs(m.volume_loss_rate) > 1).all()
        np.testing.assert_allclose(m.mass_exchange_rate, m.volume_loss_rate, rtol=1e-3)


def test_flux_at_nodes_is_that_of_the_plotfile(chondrocyte):
    """Recovered with osmosis of the ions, as the solver has it, not by Darcy's law of the effective pressure alone."""
    model, ds = chondrocyte
    plotted = cell_metrics(ds, model).mass_exchange_rate.values
    bare = ds.drop_vars([v for v in ("nodal_fluid_flux", "fluid_flux") if v in ds])
    recovered = cell_metrics(bare, model).mass_exchange_rate
    np.testing.assert_allclose(recovered, plotted, rtol=1e-3, atol=1e-3 * plotted.max())


def test_equilibrium_is_donnans(chondrocyte):
    """At rest: sum of ions sqrt(cF^2 + 4 c*^2), psi = -RT/F asinh(-cF/2c*), pi = RT (sqrt(...) - 2 c*)."""
    m = cell_metrics(chondrocyte[1], chondrocyte[0]).isel(cell=0, time=0)
    cF, bath = m.fixed_charge_density.item(), 150.0
    assert m.fixed_charge_density.attrs["units"] == "mM" and m.electric_potential.attrs["units"] == "mV"
    # the solid gives way to the difference of charges at once; water goes out, charges stay
    assert cF == pytest.approx(-140.0 / (1 + m.osmotic_swelling.item()), rel=1e-4)
    total = np.sqrt(cF**2 + 4 * bath**2)
    assert m.osmolarity.item() == pytest.approx(total, rel=1e-4)
    assert m.donnan_pressure.item() == pytest.approx(1e3 * R * T * (total - 2 * bath), rel=1e-3)  # kPa
    assert m.electric_potential.item() == pytest.approx(-R * T / FC * np.arcsinh(-cF / 2 / bath), rel=1e-4)
    Na, Cl = m.solute_concentration.values
    assert Na - Cl == pytest.approx(-cF, rel=1e-5) and Na * Cl == pytest.approx(bath**2, rel=1e-4)
    water = m.volume.item() * 1e-9 - 0.2 * m.volume.item() * 1e-9 / (1 + m.volumetric_strain.item())
    np.testing.assert_allclose(m.solute_amount, m.solute_concentration * water, rtol=1e-6)


MORE = "".join(
    f'<ic type="initial concentration" node_set="top"><dof>c{k}</dof><value>180</value></ic>' for k in (1, 2)
)
# Na+ told at the top fixes the level of the electric potential, which nothing else does; alone it cannot pass
LEVEL = '<bc type="prescribed concentration" node_set="top"><dof>c1</dof><value>180</value></bc>'


def test_nothing_leaves_a_closed_cell(tmp_path):
    """Salt that starts at the top of a sealed column spreads; the whole keeps its amounts, the halves exchange."""
    column = dict(case="B", n=1, vertical=6, centre=0.0, edge=0.06, times=[0, 0.1, 0.2], first_step=0.1,
                  longest_step=0.1, ramp_step=0.1)  # fmt: skip
    febkit.write(templates.new("tissue", physics="triphasic", **SHARP, **column), tmp_path / "open.feb")
    text = (tmp_path / "open.feb").read_text()
    sealed = [(_condition(text, name), "") for name in ("drained top", "bath top c1", "bath top c2", "top")]
    edits = (*sealed, ("</Boundary>", LEVEL + "</Boundary>"), ("</Initial>", MORE + "</Initial>"))
    model, ds = solve(tmp_path, "tissue", *edits, **column)
    up = ds.X.values[ds.connectivity.values].mean(axis=1)[:, 2] > 0
    m = cell_metrics(ds, model, {"top": np.flatnonzero(up), "bottom": np.flatnonzero(~up)})
    whole = cell_metrics(ds, model, {"all": np.arange(ds.sizes["element"])})
    top, bottom = m.solute_exchange_rate.values[:, 1:]
    assert (top > 1e-7).all()
    np.testing.assert_allclose(bottom, -top, rtol=1e-4)
    assert np.abs(whole.solute_exchange_rate.values[0, 1:]).max() < 1e-4 * top.max()


def _condition(text: str, name: str) -> str:
    """The <bc> of this name as the file has it."""
    start = text.index(f'<bc name="{name}"')
    return text[start : text.index("</bc>", start) + len("</bc>")]


def test_commands_tell_them(chondrocyte, tmp_path):
    folder = Path(chondrocyte[0].file).parent
    done = command("metrics", "m.xplt", "-o", str(tmp_path / "m.csv"), folder=folder)
    assert done.returncode == 0, done.stderr
    for text in ("osmolarity (mM)", "donnan pressure (kPa)", "concentration Na+ (mM)", "exchange Cl- (nmol/s)"):
        assert text in done.stdout
    head = (tmp_path / "m.csv").read_text().splitlines()[0]
    assert "solute_amount[Na+] (nmol)" in head and "electric_potential (mV)" in head


def test_agreement_is_told_solute_by_solute(chondrocyte):
    m = cell_metrics(chondrocyte[1], chondrocyte[0])
    names = compare(m, m)["metric"].values.tolist()
    assert names[-2:] == ["solute_exchange_rate[Na+]", "solute_exchange_rate[Cl-]"] and "osmolarity" in names
    assert next(iter(osmotic.names(osmotic.split(m)))) == "osmolarity"


def test_without_a_model_it_is_said_what_is_missing(chondrocyte):
    found = cell_metrics(chondrocyte[1])
    assert "osmolarity" not in found and "no model was given" in found.attrs["missing"]
