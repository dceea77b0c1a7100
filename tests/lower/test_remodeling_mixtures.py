"""Solids that go by what is bound to them, and reactions that go by their strain: FEBio's answers for these models."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from helpers.mixture_deck import deck, material, refused, solute, solve

CARTER = '<solid type="Carter-Hayes"><E0>2</E0><rho0>0.3</rho0><gamma>2</gamma><v>0.2</v><sbm>CS</sbm></solid>'
MATRIX = '<solid type="neo-Hookean"><E>0.5</E><v>0.1</v></solid>'
FIBER = '<fiber type="vector">0,0,1</fiber><rho0>0.3</rho0><gamma>1.5</gamma><sbm>CS</sbm>'
POWER = f'<solid type="fiber-exp-pow sbm"><alpha>1.2</alpha><beta>2.5</beta><ksi0>3</ksi0>{FIBER}</solid>'
LINEAR = f'<solid type="fiber-pow-linear sbm"><E0>4</E0><lam0>1.04</lam0><beta>2.4</beta>{FIBER}</solid>'

SPHERE = """<solid type="spherical fiber distribution sbm"><alpha>0.8</alpha><beta>2.4</beta><ksi0>3</ksi0>
<rho0>0.3</rho0><gamma>1.5</gamma><sbm>CS</sbm></solid>"""


def mixed(fibers: str) -> str:
    return f'<solid type="solid mixture">{MATRIX}{fibers}</solid>'


def reaction(rate: str, species: str) -> str:
    return (
        f'<reaction type="mass-action-forward"><Vbar>0</Vbar><forward_rate {rate}</forward_rate>'
        f'<{species} species="CS"><{species}>1</{species}></{species}></reaction>'
    )


HUISKES = reaction('type="Huiskes reaction rate"><B>0.4</B><psi0>0.01</psi0>', "vP")
MODELS = {
    "Huiskes": (CARTER, HUISKES),
    "exp-sed": (CARTER, reaction('type="exp-sed reaction rate"><B>5e-3</B><Psi0>0.02</Psi0>', "vP")),
    "Huiskes of fibers": (mixed(LINEAR), HUISKES),
    "of fibers in all directions": (
        mixed(SPHERE), reaction('type="constant reaction rate"><k>0.05</k>', "vP"),
    ),
    "Ruberti": (mixed(POWER), reaction('type="Ruberti reaction rate"><kd>0.3</kd><sigma>0.05</sigma>', "vR")),
}


# densities of the elements, displacement of the seventh node
FEBIO = {
    "Huiskes": ([0.21244094, 0.21343912], [-0.015092704, -0.015092704, 0.073457062]),
    "exp-sed": ([0.22983976, 0.2305253], [-0.015091022, -0.015091022, 0.07332693]),
    "Huiskes of fibers": ([0.2157874, 0.21586525], [-0.0062551429, -0.0062551429, 0.074947298]),
    "of fibers in all directions": ([0.33950147, 0.31609645], [-0.070531234, -0.070531234, 0.065201953]),
    "Ruberti": ([0.17579982, 0.1758247], [-0.0056842696, -0.0056842696, 0.074976072]),
}


def pulled(solid: str, made: str) -> str:
    """A rod of two elements of different length of stretch, whose solid-bound molecule, 0.2 at first, changes."""
    plain = '<solid type="neo-Hookean"><density>1</density><E>1.0</E><v>0</v></solid>'
    of = material("multiphasic", "", made).replace(plain, solid)
    of = of.replace("</material>", '<solid_bound sbm="CS"><rho0>0.2</rho0></solid_bound></material>')
    base = '<bc type="zero displacement" node_set="start"><x_dof>1</x_dof><y_dof>1</y_dof><z_dof>1</z_dof></bc>'
    end = '<bc type="prescribed displacement" node_set="end"><dof>z</dof><value lc="1">0.15</value></bc>'
    dry = '<bc type="zero fluid pressure" node_set="all"/>'
    ramp = (
        '<LoadData><load_controller id="1" type="loadcurve"><interpolate>LINEAR</interpolate><points><pt>0,0</pt>'
        "<pt>1,1</pt></points></load_controller></LoadData>"
    )
    return deck(of, base + end + dry, n=2, steps=(8, 0.25), more=ramp).replace(
        'name="CS"><charge_number>0</charge_number><molar_mass>500</molar_mass>\n<density>1e9',
        'name="CS"><charge_number>0</charge_number><molar_mass>2</molar_mass>\n<density>3',
    )


@pytest.mark.parametrize("name", MODELS)
def test_as_febio(name: str, tmp_path: Path) -> None:
    """Densities of both elements and displacements of a free node, at the end."""
    last = solve(pulled(*MODELS[name]), tmp_path).isel(time=-1)
    densities, moved = FEBIO[name]
    rho = last["sbm_referential_apparent_density"].values.ravel()
    np.testing.assert_allclose(rho, densities, rtol=2e-6)
    np.testing.assert_allclose(last["displacement"].values[6], moved, rtol=1e-4, atol=1e-8)


BAD = {
    "a solid without a molecule": ((MATRIX, HUISKES), "no solid of the material goes by the density of the product"),
    "exp-sed of such a solid": ((MATRIX, MODELS["exp-sed"][1]), "must be Carter-Hayes or a fiber"),
    "fibers of a solid that is no mixture": ((POWER, MODELS["Ruberti"][1]), "no fibers of a solid mixture"),
    "a distance": ((CARTER, HUISKES.replace("<B>", "<D>0.1</D><B>")), "<D> of <forward_rate"),
    "a molecule that is not there": ((CARTER.replace("<sbm>CS", "<sbm>HA"), HUISKES), 'no solid-bound molecule "HA"'),
}


@pytest.mark.parametrize("name", BAD)
def test_what_makes_no_sense_is_said(name: str, tmp_path: Path) -> None:
    made_of, said = BAD[name]
    message = refused(pulled(*made_of), tmp_path)
    assert said in message and "m.feb:" in message, message


def test_a_product_that_is_dissolved(tmp_path: Path) -> None:
    text = pulled(CARTER, HUISKES.replace('species="CS"', 'species="Glc"'))
    text = text.replace("</material>", solute("Glc") + "</material>")
    assert "the first vP must be a solid-bound molecule" in refused(text, tmp_path)


def test_such_a_solid_is_for_multiphasic_materials(tmp_path: Path) -> None:
    alone = CARTER.replace('<solid type="Carter-Hayes">', '<material id="1" name="m" type="Carter-Hayes">')
    text = pulled(CARTER, HUISKES)
    before, after = text.split("<Material>")[0], text.split("</Material>")[1]
    text = f"{before}<Material>{alone.replace('</solid>', '</material>')}</Material>{after}"
    assert "it is for multiphasic materials" in refused(text, tmp_path)
