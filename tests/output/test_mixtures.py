"""Plot variables and log items of mixtures with solutes: each by what defines it, from others of the same state."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from helpers.mixture_deck import HELD, deck, initial, material, prescribed, refused, solute, solve

N, DT = 3, 0.05
ITEMS = (
    "p;porosity;psi;cF;Iex;Iey;Iez;c;jz;c1;c2;c3;j1z;j2x;j3z;sbm1;sbm1_referential_apparent_density;esxx;eszz;esxy;"
    "sz;c4;crc;Kpxx"
)
IONS = solute("Na") + solute("Cl", 1.5) + solute("Glc", 0.7)
BOUND = '<solid_bound sbm="CS"><rho0>0.2</rho0></solid_bound>'
CHARGED = material("multiphasic", IONS, f"<fixed_charge_density>-0.5</fixed_charge_density>{BOUND}")


def with_output(text: str, variables: str = "", log: str = "", surface: str = "") -> str:
    names = "".join(f'<var type="{v}"/>' for v in variables.split(";") if v)
    text = text.replace("</plotfile>", f"{names}</plotfile>{log}")
    return text.replace("</Mesh>", f"{surface}</Mesh>")


def charged(**output: str) -> str:
    """A held rod with fixed charges between two baths; three solutes, a solid-bound molecule."""
    baths = "".join(
        prescribed("concentration", end, v, c)
        for end, values in (("start", (1.0, 1.0, 2.0)), ("end", (0.5, 0.5, 0.3)))
        for c, v in zip(("c1", "c2", "c3"), values)
    )
    pressures = prescribed("fluid pressure", "start", 0.05) + prescribed("fluid pressure", "end", 0.0)
    at_start = "".join(initial(c, 0.7) for c in ("c1", "c2", "c3"))
    return with_output(deck(CHARGED, HELD + baths + pressures, at_start, n=N, steps=(3, DT)), **output)


def rows(path: Path) -> Any:
    """The values of the last state of a record (item, datum)."""
    lines = path.read_text().split("*Data")[-1].splitlines()[1:]
    return np.array([[float(x) for x in line.split(",")[1:]] for line in lines])


def test_element_data_are_means_of_the_variables_of_the_same_state(tmp_path: Path) -> None:
    log = f'<logfile><element_data data="{ITEMS}" file="e.csv" delim=","/></logfile>'
    more = "porosity;current density;fluid flux;solid stress;stress;osmolarity"
    last = solve(charged(variables=more, log=log), tmp_path).isel(time=-1)
    found = dict(zip(ITEMS.split(";"), rows(tmp_path / "e.csv").T, strict=True))
    c = {s: last["solute_concentration"].sel(solute=s).values for s in ("Na", "Cl", "Glc")}
    j = {s: last["solute_flux"].sel(solute=s).values for s in ("Na", "Cl", "Glc")}
    solid, total = (last[v].values for v in ("solid_stress", "stress"))
    expected = {
        "p": last["fluid_pressure"].values, "porosity": last["porosity"].values,
        "psi": last["electric_potential"].values, "cF": last["fixed_charge_density"].values,
        "Iez": last["current_density"].values[:, 2], "c": c["Na"], "c1": c["Na"], "c2": c["Cl"], "c3": c["Glc"],
        "jz": j["Na"][:, 2], "j1z": j["Na"][:, 2], "j3z": j["Glc"][:, 2], "sbm1": 0.2,
        "sbm1_referential_apparent_density": 0.2, "sz": total[:, 2], "eszz": solid[:, 2],
    }  # fmt: skip
    for name, values in expected.items():
        np.testing.assert_allclose(found[name], values, rtol=2e-6, err_msg=name)
        assert np.abs(found[name]).min() > 0 or name in ("eszz",), name
    for name in ("c4", "crc", "Kpxx", "j2x", "esxy"):  # what there is none of, or none in this direction
        assert np.abs(found[name]).max() < 1e-12, name


def test_data_of_domains(tmp_path: Path) -> None:
    items = "volume;c1_integral;c3_integral;sbm1_integral;avg('c1');integrate('c3')"
    log = f'<logfile><domain_data data="{items}" domain="p" file="d.csv" delim=","/></logfile>'
    last = solve(charged(log=log), tmp_path).isel(time=-1)
    c = last["solute_concentration"]
    (got,) = rows(tmp_path / "d.csv")
    na, glucose = (float(c.sel(solute=s).mean()) for s in ("Na", "Glc"))  # the rod's volume is 1
    np.testing.assert_allclose(got, [1.0, na, glucose, 0.2, na, glucose], rtol=2e-6)


def test_a_domain_that_does_not_exist_is_named(tmp_path: Path) -> None:
    log = '<logfile><domain_data data="volume" domain="q"/></logfile>'
    assert 'there is no domain "q"' in refused(charged(log=log), tmp_path)


def test_osmotic_coefficient_and_velocities_of_solutes(tmp_path: Path) -> None:
    text = charged(variables="osmotic coefficient;solute volumetric flux").replace(
        "<osmcoef>1</osmcoef>", "<osmcoef>0.93</osmcoef>")  # fmt: skip
    last = solve(text, tmp_path).isel(time=-1)
    np.testing.assert_allclose(last["osmotic_coefficient"].values, 0.93, rtol=1e-6)
    c, j, v = (last[n].values for n in ("solute_concentration", "solute_flux", "solute_volumetric_flux"))
    assert v.shape == j.shape
    np.testing.assert_allclose(v[..., 2], j[..., 2] / c, rtol=0.1)  # means of ratios, ratio of means
    assert np.abs(v[..., 2]).min() > 0


def test_receptors_are_written_for_one_solute(tmp_path: Path) -> None:
    """At rest bound = Rtot cr / (kr / kf + cr), cr the moles per referential volume."""
    supply = '<supply type="supply-binding"><kf>0.1</kf><kr>0.2</kr><Rtot>3</Rtot></supply></solute>'
    made = material("biphasic-solute", solute("Glc").replace("</solute>", supply))
    held = HELD + '<bc type="zero fluid pressure" node_set="all"/>' + prescribed("concentration", "all", 5.0, "c3")
    log = '<logfile><element_data data="crc;c" file="e.csv" delim=","/></logfile>'
    text = with_output(deck(made, held, analysis="STEADY-STATE"), "receptor-ligand concentration", log)
    last = solve(text, tmp_path).isel(time=-1)
    cr = 0.8 * 5.0
    assert last["receptor_ligand_concentration"].values == pytest.approx(3.0 * cr / (2.0 + cr), rel=1e-6)
    np.testing.assert_allclose(rows(tmp_path / "e.csv"), [[3.0 * cr / (2.0 + cr), 5.0]], rtol=1e-8)


END = f'<Surface name="out"><quad4 id="1">{",".join(str(4 * N + i) for i in (1, 2, 3, 4))}</quad4></Surface>'


def test_the_fluid_that_leaves_through_a_surface(tmp_path: Path) -> None:
    """Its rate is the flux by the area of 1."""
    last = solve(charged(variables="fluid flux;fluid flow rate", surface=END), tmp_path).isel(time=-1)
    np.testing.assert_allclose(last["fluid_flow_rate"].values.squeeze(), last["fluid_flux"].values[-1, 2], rtol=1e-6)
    assert abs(float(last["fluid_flow_rate"].squeeze())) > 0


def test_effective_elasticity_of_a_mixture(tmp_path: Path) -> None:
    """The stress of a block that is stretched by h more differs by the elasticity, all fields being held."""
    from febkit.output.plot.stresses import UPPER

    def stretched(value: float) -> Any:
        moved = "".join(
            f'<bc type="prescribed displacement" node_set="{s}"><dof>z</dof><value>{v!r}</value></bc>'
            for s, v in (("start", 0.0), ("end", value))
        )
        sides = '<bc type="zero displacement" node_set="all"><x_dof>1</x_dof><y_dof>1</y_dof><z_dof>0</z_dof></bc>'
        fields = '<bc type="zero fluid pressure" node_set="all"/>' + "".join(
            prescribed("concentration", "all", 1.0, c) for c in ("c1", "c2", "c3"))  # fmt: skip
        text = deck(CHARGED, sides + moved + fields, analysis="STEADY-STATE")
        return solve(with_output(text, "stress;effective elasticity"), tmp_path).isel(time=-1)

    h, at = 1e-2, 0.1
    low, middle, high = (stretched(at + s * h)["stress"].values.ravel()[2] for s in (-1, 0, 1))
    C = stretched(at)["effective_elasticity"].values.ravel()
    J = 1 + at
    # dsigma_zz = (C_zzzz + sigma_zz) dl / l where nothing moves sideways: the rate is Truesdell's
    slope = (high - low) / (2 * h)
    assert slope == pytest.approx((C[UPPER.index((2, 2))] + middle) / J, rel=2e-3)
