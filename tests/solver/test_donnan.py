"""Charged tissue in equilibrium with its bath, against Donnan's theory: values analytic, or roots of one equation."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq, fsolve

import febkit
from febkit import materials as mt
from helpers.charged import (
    CHARGES,
    FC,
    PHI0,
    RT,
    TIGHT,
    bathe,
    block,
    charge,
    donnan_pressure,
    field,
    inside,
    neo_hookean,
    solute,
    solved,
    start,
)
from helpers.files import load

EXAMPLE = Path(__file__).parents[2] / "examples" / "donnan_swelling.py"
SALT = {"Na+": 150.0, "Cl-": 150.0}
SINGLE = 3e-7  # plot variables are numbers of single precision


def held(bath: dict[str, float], cF: float, osmotic: Any = 1.0, solubility: dict[str, Any] | None = None,
         steps: int = 1) -> febkit.Model:  # fmt: skip
    """One element that cannot move, all of it in contact with the bath."""
    ions = [solute(n, solubility=(solubility or {}).get(n, 1.0)) for n in bath]
    m = block((1, 1, 1), (1, 1, 1), ions, osmotic=osmotic, fixed_charge_density=cF)
    m.fix("all", "x", "y", "z")
    ideal = osmotic if isinstance(osmotic, float) else 1.0
    start(m, bath, ideal)
    bathe(m, "all", bath, ideal)
    m.output.add("partition coefficient", "porosity", "referential solid volume fraction")
    m.step(time=float(steps), dt=1.0, fixed=True, solver=TIGHT)
    return m


def quarter(n: int, ions: list[Any]) -> febkit.Model:
    """A cube on three planes of symmetry."""
    m = block((1, 1, 1), (n, n, n), ions)
    for axis in "xyz":
        m.fix(m.nodes(**{axis: 0.0}), axis)
    return m


# ---- a block that is held -------------------------------------------------------------------------


@pytest.mark.parametrize("bath", [15.0, 150.0, 1500.0])
@pytest.mark.parametrize("cF", [-200.0, 80.0, 0.0])
def test_ideal_donnan_pressure_concentrations_and_potential(bath: float, cF: float) -> None:
    result = solved(held({"Na+": bath, "Cl-": bath}, cF))
    plus, minus = field(result, "solute_concentration")[0]
    root = np.sqrt(cF**2 + 4 * bath**2)
    assert plus == pytest.approx((root - cF) / 2, rel=SINGLE) and minus == pytest.approx((root + cF) / 2, rel=SINGLE)
    assert field(result, "fluid_pressure")[0] == pytest.approx(donnan_pressure(cF, bath), rel=SINGLE, abs=1e-7)
    psi = RT / FC * np.arcsinh(cF / 2 / bath)  # mV; of the sign of the fixed charge
    assert field(result, "electric_potential")[0] == pytest.approx(psi, rel=SINGLE, abs=1e-9)
    assert field(result, "osmolarity")[0] == pytest.approx(root, rel=SINGLE)
    stress = field(result, "stress")[0]
    assert np.allclose(stress, [-donnan_pressure(cF, bath)] * 3 + [0] * 3, rtol=SINGLE, atol=1e-7)


BATHS = {
    "CaCl2": {"Ca2+": 75.0, "Cl-": 150.0},
    "three ions": {"Na+": 120.0, "Cl-": 150.0, "Ca2+": 15.0},
    "with glucose": {"Na+": 150.0, "Glc": 5.0, "Cl-": 150.0},
}


@pytest.mark.parametrize("cF", [-180.0, 60.0])
@pytest.mark.parametrize("name", BATHS)
def test_other_valences(name: str, cF: float) -> None:
    """c_i = c_i* zeta^z_i with the zeta that keeps the tissue neutral."""
    bath = BATHS[name]
    result = solved(held(bath, cF))
    c, zeta = inside(cF, [CHARGES[n] for n in bath], list(bath.values()))
    assert np.allclose(field(result, "solute_concentration")[0], c, rtol=SINGLE)
    assert field(result, "electric_potential")[0] == pytest.approx(-RT / FC * np.log(zeta), rel=SINGLE)
    assert field(result, "fluid_pressure")[0] == pytest.approx(RT * (c.sum() - sum(bath.values())), rel=2 * SINGLE)


def test_two_to_one_salt_is_the_root_of_a_cubic() -> None:
    """Ca Cl2 of c: 2 c x^3 + cF x - 2 c = 0 for x = zeta, without the solver's own way to it."""
    c, cF = 75.0, -180.0
    x = max(r.real for r in np.roots([2 * c, 0, cF, -2 * c]) if abs(r.imag) < 1e-12)
    got = field(solved(held({"Ca2+": c, "Cl-": 2 * c}, cF)), "solute_concentration")[0]
    assert np.allclose(got, [c * x**2, 2 * c / x], rtol=SINGLE)


@pytest.mark.parametrize("osmotic", [1.0, 0.93])
def test_osmotic_coefficient_and_solubilities(osmotic: float) -> None:
    """c+ c- = k+ k- c*^2 and p - p* = RT Phi (c+ + c- - 2 c*)."""
    cF, c, k = -200.0, 150.0, {"Na+": 0.9, "Cl-": 0.7}
    result = solved(held(SALT, cF, osmotic, k))
    root = np.sqrt(cF**2 + 4 * k["Na+"] * k["Cl-"] * c**2)
    plus, minus = field(result, "solute_concentration")[0]
    assert plus == pytest.approx((root - cF) / 2, rel=SINGLE) and minus == pytest.approx((root + cF) / 2, rel=SINGLE)
    assert field(result, "fluid_pressure")[0] == pytest.approx(RT * osmotic * (root - 2 * c), rel=2 * SINGLE)
    assert np.allclose(field(result, "partition_coefficient")[0], [plus / c, minus / c], rtol=SINGLE)


@pytest.mark.parametrize("ksi", [0.6, 1.8])
def test_manning_s_condensation(ksi: float) -> None:
    """Counterions that condense: activity and osmotic coefficients of Manning (1969), solved by fsolve.

    A solubility takes the concentrations of the last evaluation (FEBio's order): steps at rest bring them together.
    """
    cF, c = -200.0, 150.0
    laws = {n: mt.SolubManning(solub=1.0, ksi=ksi, co_ion="Cl-") for n in SALT}
    result = solved(held(SALT, cF, mt.OsmCoefManning(osmc=1.0, ksi=ksi, co_ion="Cl-"), laws, steps=20))

    def activity(X: float, counter: bool) -> float:
        if ksi <= 1:
            return float(np.exp(ksi * X / 2 / (X + 2)))
        Y = X / ksi
        return float(np.exp(Y / 2 / (Y + 2)) * ((X + 1) / (Y + 1) if counter else 1))

    def balance(v: np.ndarray) -> list[float]:
        minus, X = v[0], -cF / v[0]
        return [(minus - cF) * minus / (activity(X, True) * activity(X, False) * c * c) - 1]

    minus = float(fsolve(balance, [100.0], xtol=1e-13)[0])
    X = -cF / minus
    phi = 1 - ksi * X / 2 / (X + 2) if ksi <= 1 else (X / 2 / ksi + 2) / (X + 2)
    assert np.allclose(field(result, "solute_concentration")[0], [minus - cF, minus], rtol=1e-6)
    expected = RT * (phi * (2 * minus - cF) - 2 * c)
    assert field(result, "fluid_pressure")[0] == pytest.approx(expected, rel=1e-5)
    assert phi < 0.95  # far from ideal


def test_a_triphasic_material_is_a_multiphasic_one_of_two_ions() -> None:
    m = held(SALT, -200.0)
    other = m.copy()
    given = m.materials["tissue"]
    other.materials["tissue"] = mt.Triphasic(
        phi0=PHI0, fixed_charge_density=-200.0, solid=given.solid, permeability=given.permeability,
        osmotic_coefficient=given.osmotic_coefficient, solute=given.all("solute"))  # fmt: skip
    one, two = solved(m), solved(other)
    for name in ("fluid_pressure", "solute_concentration", "electric_potential"):
        assert np.array_equal(field(one, name), field(two, name))
    assert field(two, "fluid_pressure")[0] == pytest.approx(donnan_pressure(-200.0, 150.0), rel=SINGLE)


# ---- a block that moves ---------------------------------------------------------------------------


@pytest.mark.parametrize("cFr", [-200.0, -60.0])
def test_free_swelling(cFr: float) -> None:
    """sigma(J) = p_Donnan(cF(J)), cF = cFr (1 - phi0) / (J - phi0): one scalar equation for J."""
    m = quarter(2, [solute("Na+"), solute("Cl-")])
    start(m, SALT)
    for axis in "xyz":
        bathe(m, m.nodes(**{axis: "max"}), SALT)
    charge(m, cFr, until=1e4)
    m.step(analysis="STEADY-STATE", time=1e4, dt=1e3, solver=TIGHT)
    result = solved(m)

    def balance(J: float) -> float:
        return neo_hookean(J ** (1 / 3), J) - donnan_pressure(cFr * (1 - PHI0) / (J - PHI0), 150.0)

    J = brentq(balance, 1.0, 2.0, xtol=1e-14)
    assert np.allclose(result.state.u, (J ** (1 / 3) - 1) * m.X, atol=1e-8)
    assert np.allclose(field(result, "fixed_charge_density"), cFr * (1 - PHI0) / (J - PHI0), rtol=SINGLE)
    assert J > 1.01


def test_free_swelling_takes_its_time_and_ends_at_the_same_place() -> None:
    """The transient from an uncharged block leads to the swelling of the steady state."""
    m = quarter(2, [solute("Na+"), solute("Cl-")])
    start(m, SALT)
    for axis in "xyz":
        bathe(m, m.nodes(**{axis: "max"}), SALT)
    charge(m, -200.0, until=1e3)
    m.step(time=1e5, dt=1e2, dtmax=5e3, solver=TIGHT)
    J = brentq(lambda J: neo_hookean(J ** (1 / 3), J) - donnan_pressure(-160.0 / (J - PHI0), 150.0), 1, 2, xtol=1e-14)
    u = solved(m).state.u
    assert np.allclose(u, (J ** (1 / 3) - 1) * m.X, atol=1e-6)


def test_confined_compression_at_equilibrium() -> None:
    """sigma_zz = sigma_e(stretch) - p_Donnan(stretch) while a charged plug is squeezed from 1 to 0.8."""
    m = block((1, 1, 1), (1, 1, 3), [solute("Na+"), solute("Cl-")])
    m.fix("all", "x", "y")
    m.fix(m.nodes(z="min"), "z")
    m.prescribe(m.nodes(z="max"), z=-0.2, curve=[(0, 0), (1, 0), (5, 1)])
    start(m, SALT)
    bathe(m, m.nodes(z="max"), SALT)
    charge(m, -200.0)
    m.step(analysis="STEADY-STATE", time=5.0, dt=0.2, dtmax=0.5, must_points=[1, 2, 3, 4, 5], solver=TIGHT)
    result = solved(m, at=[1, 2, 3, 4, 5])
    for k, stretch in enumerate((1.0, 0.95, 0.9, 0.85, 0.8)):
        p = donnan_pressure(-200.0 * (1 - PHI0) / (stretch - PHI0), 150.0)
        stress = field(result, "stress", k)
        # FEBio 4.11 counts osmotic pressure from that of the bath: p* = 0
        assert np.allclose(stress[:, 2], neo_hookean(stretch, stretch) - p, rtol=1e-6)
        assert np.allclose(field(result, "fluid_pressure", k), p, rtol=1e-6)
    top = m.nodes(z="max").index
    assert result.state.reaction[top, 2].sum() == pytest.approx(neo_hookean(0.8, 0.8) - p, rel=1e-8)


# ---- solid-bound molecules ------------------------------------------------------------------------


def synthesis(dt: float) -> tuple[np.ndarray, Any]:
    """Chondroitin sulfate (charge -2) and two sodium ions made at a constant rate per fluid volume, for 100 s."""
    ions = [solute("Na+"), solute("Cl-")]
    m = block((1, 1, 1), (1, 1, 1), ions)
    m.solid_bound("CS", charge=-2, molar_mass=4e-7, density=1.2e-3)  # ton/nmol, ton/mm^3, with room to see
    made = mt.ConcentrationIndependent(
        vP={"CS": 1, "Na+": 2}, Vbar=0.0, override_vbar=True, forward_rate=mt.ConstantReactionRate(k=K))
    material = m.materials["tissue"]
    material.add("solid_bound", mt.SolidBound("CS", rho0=1e-5))
    material.add("reaction", made)
    m.fix("all", "x", "y", "z")
    start(m, SALT)
    bathe(m, "all", SALT)
    m.output.plot = ["fixed charge density", "sbm referential apparent density", "porosity", "solute concentration"]
    m.step(time=100.0, dt=dt, fixed=True, solver=TIGHT)
    result = solved(m)
    rho = result.dataset["sbm_referential_apparent_density"].values.astype(float).reshape(-1)
    return rho, result


K = 3.0  # nmol/(mm^3 s) of fluid


def test_solid_bound_molecules_made_at_a_constant_rate() -> None:
    """drho/dt = k M (J - phi_s - rho / rho_T), J = 1: rho, the solid fraction and the charge follow; order 2 in dt."""
    M, density, rho0 = 4e-7, 1.2e-3, 1e-5
    rate = K * M / density
    end = density * (1 - PHI0) + (rho0 - density * (1 - PHI0)) * np.exp(-rate * 100.0)
    errors = []
    for dt in (20.0, 10.0, 5.0):
        rho, result = synthesis(dt)
        errors.append(abs(rho[-1] / end - 1))
        phi = 1 - PHI0 - rho[-1] / density
        cF = -2 * rho[-1] / M / phi
        assert field(result, "porosity")[0] == pytest.approx(phi, rel=SINGLE)
        assert field(result, "fixed_charge_density")[0] == pytest.approx(cF, rel=SINGLE)
        plus, minus = field(result, "solute_concentration")[0]
        assert plus - minus == pytest.approx(-cF, rel=1e-6) and plus * minus == pytest.approx(150.0**2, rel=1e-6)
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert errors[-1] < 1e-4 and (orders > 1.9).all() and (orders < 2.1).all(), (errors, orders)


# ---- FEBio's way ----------------------------------------------------------------------------------


def test_steps_and_iterations_of_a_swelling_block_are_febio_s(tmp_path: Path) -> None:
    """A file that names no <qn_method>: FEBio 4.11 takes BFGS, and 6, 12 and 37 iterations to 1000 s."""
    m = load(EXAMPLE).tissue(150.0, 3)
    m.steps[0].control.time_steps = 10
    del m.steps[0].control.solver.qn_method
    m.write(tmp_path / "m.feb")
    result = febkit.solve(tmp_path / "m.feb")
    assert (result.totals.steps, result.totals.iterations) == (3, 55)
    assert np.allclose(result.state.u[-1], 0.12277321, rtol=1e-7)  # FEBio's displacement of the far corner, mm
