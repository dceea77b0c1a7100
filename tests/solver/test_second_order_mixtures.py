"""Steps of second order of mixtures with solutes: their order, and that the error asked for is the error met."""

from __future__ import annotations

from math import sqrt
from typing import Any

import numpy as np
import pytest

import febkit
from febkit import materials as mt
from febkit.modelling.solution import Solution
from febkit.solver.run import Listener, Run
from helpers.charged import CHARGES, RT, TIGHT, bathe, block, solute, solved, start

L = 0.5  # mm
GAMMA = 1.0 - 1.0 / sqrt(2.0)
ANY = 0.1  # an error that no step here comes near: steps of second order of the given size
BALANCED = TIGHT | {"min_residual": 1e-30}


def amplification(z: float) -> float:
    """Of y' = lambda y over a step, z = lambda dt: Alexander's method."""
    return (1 + (1 - 2 * GAMMA) * z) / (1 - GAMMA * z) ** 2


def nodal(m: febkit.Model, result: Solution, name: str) -> Any:
    """A nodal field along z, in double precision."""
    order = np.argsort(m.X[:, 2], kind="stable")[::4]
    return np.asarray(result.state.layout.scalar(result.state.d, name))[order]


def orders(errors: Any) -> Any:
    return np.log2(np.array(errors[:-1]) / errors[1:])


class Last(Listener):
    """What is at the first point of the first part as the run ends."""

    def __init__(self, name: str) -> None:
        self.name = name

    def end(self, run: Run, result: Any) -> None:
        self.value = float(getattr(run.groups[0].physics.at, self.name).flat[0])


# ---- closed forms -----------------------------------------------------------------------------------


def test_a_fourier_mode_decays_by_the_method_s_amplification() -> None:
    """To round-off what linear elements and the method make of exp(-D k^2 t); order 2 in dt."""
    n, D, k, t = 4, 0.67e-3, np.pi / L, 60.0
    rate = D * 6 * (n / L) ** 2 * (1 - np.cos(k * L / n)) / (2 + np.cos(k * L / n))
    errors = []
    for steps in (5, 10, 20):
        m = block((L / n, L / n, L), (1, 1, n), [solute("Glc")])
        m.fix("all", "x", "y", "z")
        wave = f"(10 + 4*sin({k!r}*Z))"
        m.initial(c1=wave, p=f"{-RT!r}*{wave}")
        for end in ("min", "max"):
            bathe(m, m.nodes(z=end), {"Glc": 10.0})
        m.step(time=t, dt=t / steps, fixed=True, solver=TIGHT)
        left = (nodal(m, solved(m, accuracy=ANY), "concentration 1")[n // 2] - 10.0) / 4.0
        assert left == pytest.approx(amplification(-rate * t / steps) ** steps, rel=1e-9)
        errors.append(abs(left - np.exp(-rate * t)))
    assert (abs(orders(errors) - 2) < 0.1).all(), errors


def reacting(reaction: Any, **at_start: float) -> febkit.Model:
    """A closed rigid cube in which A and B react."""
    m = block((1, 1, 1), (1, 1, 1), [solute("A", free=1e-3), solute("B", free=1e-3)])
    m.materials["tissue"].add("reaction", reaction)
    m.fix("all", "x", "y", "z")
    m.initial(p=0.0, **at_start)
    m.prescribe("all", p=0.0)
    return m


@pytest.fixture
def species(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(CHARGES, "A", 0)
    monkeypatch.setitem(CHARGES, "B", 0)


@pytest.mark.usefixtures("species")
def test_a_reversible_reaction_follows_the_method_s_amplification() -> None:
    kF, kR, t, steps = 0.03, 0.01, 100.0, 10
    m = reacting(mt.MassActionReversible(
        vR={"A": 1}, vP={"B": 1}, Vbar=0.0, override_vbar=True, forward_rate=mt.ConstantReactionRate(k=kF),
        reverse_rate=mt.ConstantReactionRate(k=kR)), A=12.0, B=0.0)  # fmt: skip
    m.step(time=t, dt=t / steps, fixed=True, solver=TIGHT)
    result = solved(m, accuracy=ANY)
    a, b = (nodal(m, result, f"concentration {i}") for i in (1, 2))
    left = amplification(-(kF + kR) * t / steps) ** steps
    assert np.allclose(a + b, 12.0, rtol=1e-10) and np.allclose(a, 3.0 + 9.0 * left, rtol=1e-9)


K, T_END, RHO = 0.03, 100.0, 0.2


def decaying(**steps: Any) -> febkit.Model:
    """A solid-bound molecule decays at a rate K; the solutes know nothing of it."""
    m = reacting(mt.MassActionForward(
        vR={"CS": 1}, Vbar=0.0, override_vbar=True, forward_rate=mt.ConstantReactionRate(k=K)), A=12.0, B=0.0,
    )  # fmt: skip
    m.solid_bound("CS", molar_mass=1.0, density=1.5)
    m.materials["tissue"].add("solid_bound", mt.SolidBound("CS", rho0=RHO))
    m.step(time=T_END, solver=TIGHT, **steps)
    return m


@pytest.mark.usefixtures("species")
def test_solid_bound_molecules_follow_the_method_s_amplification() -> None:
    last = Last("bound")
    solved(decaying(dt=T_END / 10, fixed=True), accuracy=ANY, listeners=[last])
    assert last.value == pytest.approx(RHO * amplification(-K * T_END / 10) ** 10, rel=1e-12)


@pytest.mark.usefixtures("species")
def test_the_error_of_what_is_bound_counts() -> None:
    """No nodal field shows it: steps that watched these alone would be as long as the run."""
    errors = []
    for accuracy in (1e-2, 1e-3, 1e-4):
        last = Last("bound")
        solved(decaying(dt=T_END / 100, dtmax=T_END), accuracy=accuracy, listeners=[last])
        errors.append(abs(last.value / RHO - np.exp(-K * T_END)))
        assert errors[-1] < 2 * accuracy
    assert errors[0] > 2 * errors[1] > 4 * errors[2]


def test_receptors_bind_to_second_order() -> None:
    """db/dt = kf (phi c - b)(Rtot - b) - kr b in a closed block of one solute: scipy's answer, order 2."""
    from scipy.integrate import solve_ivp

    kf, kr, total, c0, t, phi = 0.02, 0.01, 3.0, 5.0, 60.0, 0.8
    m0 = phi * c0
    exact = solve_ivp(lambda _, b: kf * (m0 - b) * (total - b) - kr * b, (0, t), [0.0], rtol=1e-12, atol=1e-13).y[0, -1]
    errors = []
    for steps in (5, 10, 20):
        m = febkit.Model("solute", units="mm-N-s")
        m.set_constants(R=RT / 298.0, T=298.0)
        m.solute("Glc")
        m.add_block("tissue", (1, 1, 1), (1, 1, 1))
        m.materials["tissue"] = mt.BiphasicSolute(
            phi0=1 - phi, solid=mt.NeoHookean(E=0.5, v=0.1), permeability=mt.PermConstIso(perm=1e-3),
            osmotic_coefficient=mt.OsmCoefConst(osmcoef=1.0),
            solute=mt.Solute("Glc", diffusivity=mt.DiffConstIso(free_diff=1e-3, diff=1e-3),
                             solubility=mt.SolubConst(solub=1.0), supply=mt.SupplyBinding(kf=kf, kr=kr, Rtot=total)),
        )  # fmt: skip
        m.fix("all", "x", "y", "z")
        start(m, {"Glc": c0})
        m.prescribe("all", p=0.0)
        m.step(time=t, dt=t / steps, fixed=True, solver=TIGHT)
        last = Last("complex")
        result = solved(m, accuracy=ANY, listeners=[last])
        assert phi * nodal(m, result, "concentration 1") + last.value == pytest.approx(m0, rel=1e-9)
        errors.append(abs(last.value - exact))
    assert (abs(orders(errors) - 2) < 0.3).all(), errors


# ---- a charged tissue that swells and is pressed ----------------------------------------------------

END, BATH = 200.0, 150.0
REST = (0.0, -2 * RT * BATH, BATH, BATH)  # of z displacement, effective pressure and concentrations


def charged(**steps: Any) -> febkit.Model:
    """A layer in a bath of NaCl: its charges grow, its top is pressed; all fields change at rates of their own."""
    n, ions = 6, ("Na+", "Cl-")
    m = block((L / n, L / n, L), (1, 1, n), [solute(i, hindered=0.6) for i in ions], fixed_charge_density=-120.0)
    m.materials["tissue"]["fixed_charge_density"].curve = m.curves.add([(0, 0), (1000, 1)])
    m.fix("all", "x", "y")
    m.fix(m.nodes(z="min"), "z")
    start(m, dict.fromkeys(ions, BATH))
    bathe(m, m.nodes(z="max"), dict.fromkeys(ions, BATH))
    m.prescribe(m.nodes(z="max"), z=-0.1 * L, curve=[(0, 0), (1000, 1)])
    m.step(time=END, solver=BALANCED, **steps)
    return m


def at_end(accuracy: float, **steps: Any) -> tuple[Any, int]:
    m = charged(**steps)
    result = solved(m, accuracy=accuracy)
    names = ("displacement", "fluid pressure", "concentration 1", "concentration 2")
    d, layout = result.state.d, result.state.layout
    return [layout.view(d, n)[:, -1] for n in names], result.totals.steps + result.totals.retries


def by(steps: int) -> dict[str, Any]:
    return {"dt": END / steps, "fixed": True}


@pytest.fixture(scope="module")
def exact() -> Any:
    return at_end(ANY, **by(160))[0]


def off(got: Any, exact: Any) -> Any:
    """Errors of the fields over the norms of their changes."""
    return np.array([np.linalg.norm(a - b) / np.linalg.norm(b - c) for a, b, c in zip(got, exact, REST)])


def test_order_two_in_all_fields_of_a_charged_tissue(exact: Any) -> None:
    first = [off(at_end(0.0, **by(n))[0], exact) for n in (10, 20)]
    second = [off(at_end(ANY, **by(n))[0], exact) for n in (10, 20, 40)]
    assert (abs(np.log2(first[0] / first[1]) - 1.0) < 0.1).all(), first
    assert (abs(np.log2(np.array(second[:-1]) / second[1:]) - 2.0) < 0.25).all(), second
    assert (second[0] < 0.1 * first[1]).all()  # as many solves


def test_the_error_asked_for_in_all_fields(exact: Any) -> None:
    tries = [at_end(a, dt=END / 100, dtmax=END) for a in (1e-2, 1e-3, 1e-4)]
    errors, steps = [off(d, exact).max() for d, _ in tries], [n for _, n in tries]
    assert all(e < 5 * a for e, a in zip(errors, (1e-2, 1e-3, 1e-4))), errors
    assert errors[0] > 2 * errors[1] > 4 * errors[2]
    assert steps[2] < 3.2 * steps[1]


def test_a_field_that_does_not_change_is_not_resolved_for_its_own_sake() -> None:
    """Charges and ions at rest beside a tissue that is pressed: noise in their concentrations takes no steps."""
    m = charged(dt=END / 100, dtmax=END)
    m.materials["tissue"].fixed_charge_density = 0.0
    m.materials["tissue"]["fixed_charge_density"].curve = None
    assert solved(m, accuracy=1e-3).totals.steps < 40
