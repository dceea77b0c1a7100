"""Transport of solutes through layers, against closed forms and against boundary value problems solved by scipy."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_bvp

import febkit
from febkit import materials as mt
from febkit.lower import lower
from febkit.modelling.solution import Solution
from febkit.solver.newton import Newton, NotConverged, Strategy
from febkit.solver.options import Options
from febkit.solver.run import Listener, Run
from febkit.solver.system import System
from helpers.charged import CHARGES, FC, PERM, PHI0, RT, TIGHT, bathe, block, field, solute, solved, start

L = 0.5  # mm
POROSITY = 1 - PHI0


def layer(n: int, solutes: list[Any], **material: Any) -> febkit.Model:
    """A rigid layer 0 < z < L of n elements."""
    m = block((L / n, L / n, L), (1, 1, n), solutes, **material)
    m.fix("all", "x", "y", "z")
    return m


def nodal(m: febkit.Model, result: Solution, name: str) -> np.ndarray:
    """A nodal field along the layer, in double precision."""
    order = np.argsort(m.X[:, 2], kind="stable")[::4]
    return np.asarray(result.state.layout.scalar(result.state.d, name))[order]


def orders(errors: list[float]) -> np.ndarray:
    return np.log2(np.array(errors[:-1]) / errors[1:])


# ---- one neutral solute ---------------------------------------------------------------------------


def through(n: int, push: float, hindered: float = 1.0) -> tuple[febkit.Model, Solution]:
    """Glucose between baths of 20 and 5 mmol/l, with ``push`` MPa more pressure on the first."""
    m = layer(n, [solute("Glc", hindered=hindered)])
    start(m, {"Glc": 10.0})
    bathe(m, m.nodes(z="min"), {"Glc": 20.0}, pressure=push)
    bathe(m, m.nodes(z="max"), {"Glc": 5.0})
    m.step(analysis="STEADY-STATE", time=1.0, dt=1.0, fixed=True, solver=TIGHT)
    return m, solved(m)


def test_diffusion_through_a_layer() -> None:
    """Without flow the profile is a line and the flux phi D dc / L."""
    m, result = through(4, 0.0)
    assert np.allclose(nodal(m, result, "concentration 1"), 20 - 15 * np.linspace(0, 1, 5), rtol=1e-9)
    flux = POROSITY * 0.67e-3 * 15 / L
    assert np.allclose(field(result, "solute_flux").reshape(4, 3), [0, 0, flux], rtol=1e-6, atol=1e-12)
    assert np.abs(field(result, "fluid_flux")).max() < 1e-12


def test_diffusion_against_and_with_a_flow() -> None:
    """c = A + B exp(w z / (phi D)), w = K dp / L where the solid does not hinder the solute; order 2 in h."""
    D, push = 0.67e-3, 0.6
    w = PERM * push / L
    peclet = w * L / (POROSITY * D)
    errors = []
    for n in (4, 8, 16):
        m, result = through(n, push)
        z = np.linspace(0, 1, n + 1)
        exact = 20 - 15 * np.expm1(peclet * z) / np.expm1(peclet)
        errors.append(float(np.abs(nodal(m, result, "concentration 1") - exact).max()))
        assert np.allclose(field(result, "fluid_flux").reshape(n, 3)[:, 2], w, rtol=2e-2 / n**2)
    assert peclet > 1 and errors[-1] < 0.01 and (orders(errors) > 1.9).all(), (errors, orders(errors))


def mode(n: int, steps: int, end: float = 60.0) -> float:
    """Amplitude left of c = 10 + 4 sin(pi z / L) with 10 held at both ends, at z = L / 2."""
    m = layer(n, [solute("Glc")])
    wave = f"4*sin({np.pi / L!r}*Z)"
    m.initial(c1=f"10 + {wave}", p=f"{-RT!r}*(10 + {wave})")
    for end_ in ("min", "max"):
        bathe(m, m.nodes(z=end_), {"Glc": 10.0})
    m.step(time=end, dt=end / steps, fixed=True, solver=TIGHT)
    result = solved(m)
    c = nodal(m, result, "concentration 1") - 10.0
    assert np.allclose(c, c[n // 2] * np.sin(np.pi * np.linspace(0, 1, n + 1)), atol=1e-8)
    return float(c[n // 2] / 4)


def test_a_fourier_mode_decays_at_the_rate_of_theory_with_its_orders() -> None:
    """exp(-D k^2 t): order 2 in h, 1 in dt; and to round-off what linear elements and backward Euler make of it."""
    D, k, t = 0.67e-3, np.pi / L, 60.0

    def rate(n: int) -> float:
        h = L / n
        return float(D * 6 / h**2 * (1 - np.cos(k * h)) / (2 + np.cos(k * h)))

    space = []
    for n in (4, 8, 16):
        got = mode(n, 6)
        assert got == pytest.approx((1 + rate(n) * t / 6) ** -6, rel=1e-8)
        space.append(abs(got - (1 + D * k * k * t / 6) ** -6))
    time = [abs(mode(4, s) - np.exp(-rate(4) * t)) for s in (5, 10, 20)]
    assert (abs(orders(space) - 2) < 0.1).all() and (abs(orders(time) - 1) < 0.1).all(), (space, time)


def test_uptake_from_a_bath_follows_the_series() -> None:
    """c / c* = 1 - 4 / pi sum (-1)^k / (2 k + 1) exp(-(2 k + 1)^2 pi^2 D t / 4 L^2) cos(...): Crank, 2.4.1."""
    n, D, t = 20, 0.67e-3, 150.0
    m = layer(n, [solute("Glc")])
    m.initial(c1=0.0, p=0.0)
    bathe(m, m.nodes(z="max"), {"Glc": 10.0})
    m.step(time=t, dt=1.0, fixed=True, solver=TIGHT)
    z, k = np.linspace(0, 1, n + 1)[:, None], np.arange(60)
    q = (2 * k + 1) * np.pi / 2
    series = 10 * (1 - 2 * ((-1) ** k / q * np.exp(-q * q * D * t / L**2) * np.cos(q * z)).sum(axis=1))
    assert np.abs(nodal(m, solved(m), "concentration 1") - series).max() < 0.02


def supplied(n: int, supply: Any, D: float = 0.67e-3) -> febkit.Model:
    """A layer of a biphasic-solute material with a supply of glucose."""
    m = febkit.Model("solute", units="mm-N-s")
    m.set_constants(R=RT / 298.0, T=298.0)
    m.solute("Glc")
    m.add_block("tissue", (L / n, L / n, L), (1, 1, n))
    glucose = mt.Solute("Glc", diffusivity=mt.DiffConstIso(free_diff=D, diff=D), solubility=mt.SolubConst(solub=1.0),
                        supply=supply)  # fmt: skip
    m.materials["tissue"] = mt.BiphasicSolute(
        phi0=PHI0, solid=mt.NeoHookean(E=0.5, v=0.1), permeability=mt.PermConstIso(perm=PERM),
        osmotic_coefficient=mt.OsmCoefConst(osmcoef=1.0), solute=glucose)  # fmt: skip
    return m


def test_a_solute_made_at_a_constant_rate_in_a_biphasic_solute_material() -> None:
    """c = c* + s (L^2 - z^2) / (2 phi D) at rest, s moles per volume and time: exact at the nodes."""
    made, D, n = 0.02, 0.67e-3, 6
    m = supplied(n, mt.SupplyConst(supp=made))
    m.fix("all", "x", "y", "z")
    start(m, {"Glc": 5.0})
    bathe(m, m.nodes(z="max"), {"Glc": 5.0})
    m.step(analysis="STEADY-STATE", time=1.0, dt=1.0, fixed=True, solver=TIGHT)
    z = L * np.linspace(0, 1, n + 1)
    c = nodal(m, solved(m), "concentration 1")
    assert np.allclose(c, 5.0 + made * (L * L - z * z) / (2 * POROSITY * D), rtol=1e-8)
    assert c[0] > 9.0


def test_a_steady_state_is_one_from_its_first_iterate_on(monkeypatch: pytest.MonkeyPatch) -> None:
    """Receptors hold what they hold at rest, before any residual is taken."""
    m = supplied(1, mt.SupplyBinding(kf=0.1, kr=0.2, Rtot=3.0))
    m.fix("all", "x", "y", "z")
    start(m, {"Glc": 5.0})
    m.step(analysis="STEADY-STATE", time=1.0, dt=1.0, fixed=True, solver=TIGHT)
    run = Run(lower(m.record), options=Options(threads=1))
    seen, take = [], System.residual

    def looking(self: System) -> Any:
        seen.append(run.groups[0].physics.at.complex.copy())
        return take(self)

    monkeypatch.setattr(System, "residual", looking)
    assert run.solve().converged
    cr = POROSITY * 5.0
    assert np.allclose(seen[0], 3.0 * cr / (2.0 + cr))


# ---- salts ----------------------------------------------------------------------------------------


def nernst_planck(names: list[str], cF: float, hindered: float) -> Any:
    """Slopes of [F psi / RT, p, c of all ions but the first] at fluxes w, j_i: actual quantities, not effective ones.

    g_i = c_i' + z_i c_i (F psi / RT)' = (c_i w / D0_i - j_i / D_i) / phi (Nernst and Planck, with convection);
    sum z_i c_i' = 0, as cF is uniform; p' - RT sum c_i' = -w (1 / K + RT / phi sum (1 - D_i / D0_i) c_i / D0_i)
    - RT sum g_i D_i / D0_i (momentum of the fluid).
    """
    z = np.array([CHARGES[n] for n in names], float)
    D0 = np.array([solute(n).component.child("diffusivity").float("free_diff") for n in names])
    D = hindered * D0

    def slopes(y: np.ndarray, w: float, j: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        c = actual(y)
        g = (c * w / D0[:, None] - j[:, None] / D[:, None]) / POROSITY
        potential = (z @ g) / (z * z @ c)
        dc = g - z[:, None] * c * potential
        inverse = 1 / PERM + RT / POROSITY * ((1 - hindered) / D0 @ c)
        dp = RT * dc.sum(axis=0) - inverse * w - RT * hindered * g.sum(axis=0)
        return np.vstack([potential, dp, dc[1:]]), c

    def actual(y: np.ndarray) -> np.ndarray:
        rest = y[2:]
        return np.vstack([-(cF + z[1:] @ rest) / z[0], rest])

    return slopes, actual


def at_rest(names: list[str], bath: dict[str, float], cF: float) -> tuple[float, float, np.ndarray]:
    """F psi / RT, p and concentrations just inside a tissue in equilibrium with a bath of 1:1 salt."""
    a, b = (bath[n] for n in names)
    y = float(np.log(a / b)) / 2 - float(np.arcsinh(-cF / 2 / np.sqrt(a * b)))
    c = np.array([a * np.exp(-y), b * np.exp(y)])
    return y, RT * float(c.sum() - a - b), c


IONS = ["Na+", "Cl-"]
CF, HINDERED = -120.0, 0.6


def salt_layer(n: int, **bath: float) -> febkit.Model:
    m = layer(n, [solute(i, hindered=HINDERED) for i in IONS], fixed_charge_density=CF)
    start(m, bath)
    bathe(m, m.nodes(z="min"), bath)
    return m


def test_a_salt_through_a_charged_layer_between_baths() -> None:
    """Baths of 150 and 50 mmol/l at one potential: both ions, fluid and a current pass; order 2 in h."""
    near, far = (dict.fromkeys(IONS, c) for c in (150.0, 50.0))
    slopes, actual = nernst_planck(IONS, CF, HINDERED)
    ends = [at_rest(IONS, b, CF) for b in (near, far)]

    def bc(a: np.ndarray, b: np.ndarray, q: np.ndarray) -> np.ndarray:
        return np.concatenate([e - np.array([y, p, c[1]]) for e, (y, p, c) in zip((a, b), ends)])

    x = np.linspace(0, L, 41)
    guess = np.array([np.linspace(u, v, 41) for u, v in zip(*((y, p, c[1]) for y, p, c in ends))])
    scale = np.array([1e-4, 0.1, 0.1])
    theory = solve_bvp(lambda x, y, q: slopes(y, q[0] * scale[0], q[1:] * scale[1:])[0], bc, x, guess,
                       p=[0.0, 1.0, 1.0], tol=1e-9, max_nodes=100000)  # fmt: skip
    assert theory.success
    w, *j = theory.p * scale
    errors = []
    for n in (4, 8, 16):
        m = salt_layer(n, **near)
        bathe(m, m.nodes(z="max"), far)
        m.step(analysis="STEADY-STATE", time=1.0, dt=0.1, fixed=True, solver=TIGHT)
        result = solved(m)
        at = theory.sol(np.linspace(0, L, n + 1))
        c = actual(at)
        exact = c[0] * np.exp(at[0])  # effective concentration of sodium
        errors.append(float(np.abs(nodal(m, result, "concentration 1") / exact - 1).max()))
    flux = field(result, "solute_flux").reshape(16, -1)
    assert np.allclose(flux[:, [2, 5]], j, rtol=5e-3)
    assert np.allclose(field(result, "fluid_flux")[:, 2], w, rtol=5e-3)
    current = FC * (j[0] - j[1])
    assert abs(current) > 1e-8 and np.allclose(field(result, "current_density")[:, 2], current, rtol=5e-3)
    assert errors[-1] < 1e-3 and (orders(errors) > 1.8).all(), (errors, orders(errors))


def test_streaming_potential_in_open_circuit() -> None:
    """Fluid is driven through, the far end conducts no current: psi(L) of the boundary value problem; order 2 in h."""
    bath = dict.fromkeys(IONS, 150.0)
    w = 4e-4
    slopes, _ = nernst_planck(IONS, CF, HINDERED)
    y0, p0, c0 = at_rest(IONS, bath, CF)

    def bc(a: np.ndarray, b: np.ndarray, q: np.ndarray) -> np.ndarray:
        return np.array([a[0] - y0, a[1] - p0, a[2] - c0[1], b[2] - c0[1]])  # the same salt in the bath beyond

    x = np.linspace(0, L, 41)
    guess = np.repeat([[y0], [p0], [c0[1]]], 41, axis=1)
    theory = solve_bvp(lambda x, y, q: slopes(y, w, np.full(2, q[0] * 0.1))[0], bc, x, guess, p=[0.5], tol=1e-9)
    assert theory.success
    flux, end = theory.p[0] * 0.1, theory.sol(L)
    streaming = RT / FC * (end[0] - y0)  # mV
    errors = []
    for n in (4, 8, 16):
        m = salt_layer(n, **bath)
        far = m.faces(z="max")
        m.load(far, "fluidflux", flux=w, linear=True)
        for i in IONS:
            m.load(far, "soluteflux", solute_id=i, flux=flux, linear=True)
        m.step(analysis="STEADY-STATE", time=1.0, dt=0.1, fixed=True, solver=TIGHT)
        result = solved(m)
        sodium, chloride = (nodal(m, result, f"concentration {k}")[-1] for k in (1, 2))
        got = RT / FC / 2 * float(np.log(sodium / chloride))
        errors.append(abs(got / streaming - 1))
        assert np.abs(field(result, "current_density")).max() < 1e-6 * FC * flux
    assert abs(streaming) > 0.1 and errors[-1] < 1e-3 and (orders(errors) > 1.8).all(), (streaming, errors)


def closed_to_chloride() -> febkit.Model:
    """Fixed charges appear in the first step; sodium may enter from a bath, chloride can neither enter nor leave."""
    m = block((L, L, L), (1, 1, 3), [solute(i) for i in IONS], fixed_charge_density=CF)
    m.fix("all", "x", "y")
    m.fix(m.nodes(z="min"), "z")
    start(m, dict.fromkeys(IONS, 150.0))
    m.prescribe(m.nodes(z="max"), **{"Na+": 150.0, "p": -RT * 300.0})
    m.materials["tissue"]["fixed_charge_density"].curve = m.curves.add([(0, 0), (500, 1)])
    m.output.add("relative volume", "porosity")
    return m


def moles(result: Solution) -> np.ndarray:
    """Of each ion, per volume of fluid at the start."""
    J = field(result, "relative_volume")
    fluid = J * field(result, "porosity") / POROSITY
    return np.asarray((fluid[:, None] * field(result, "solute_concentration")).mean(axis=0))


def test_what_cannot_leave_is_kept_while_charges_appear() -> None:
    """Moles of chloride as at the start, those of sodium as many more as there are charges: from the first step on."""
    m = closed_to_chloride()
    m.fix("all", "z")
    m.step(time=1000.0, dt=500.0, fixed=True, solver=TIGHT)
    assert np.allclose(moles(solved(m)), [150.0 - CF, 150.0], rtol=1e-6)


def test_a_first_step_that_is_cut_starts_from_the_same_moles() -> None:
    """A first step that turns elements inside out is tried anew from the state at the start."""
    m = closed_to_chloride()
    m.prescribe(m.nodes(z="max"), z=-L, curve=[(0, 0), (500, 0), (600, 1.5), (700, 0), (1000, 0)])
    m.step(time=1200.0, dt=600.0, retries=5, solver=TIGHT)
    result = solved(m)
    assert result.totals.retries > 0
    assert np.allclose(moles(result), [150.0 - CF, 150.0], rtol=1e-5)


class FirstStep(Listener):
    """Remembers the size and the end of the first step that converged."""

    dt = 0.0

    def converged(self, run: Run, counts: Any) -> None:
        if not self.dt:
            self.dt, self.d = run.state.dt, run.state.d.copy()


def first_step(dt: float, plot: str) -> FirstStep:
    m, seen = closed_to_chloride(), FirstStep()
    m.step(time=400.0, dt=400.0, plot=plot, solver=TIGHT)
    m.control["step_size"] = dt
    solved(m, listeners=[seen])
    return seen


@pytest.mark.parametrize("plot", ["PLOT_NEVER", "PLOT_MAJOR_ITRS"])
def test_a_first_step_that_fails_leaves_nothing_of_its_start_behind(plot: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Tried anew, it is the step that one begun with its size at once makes."""
    step, tries = Newton.step, iter(range(10**6))

    def failing(self: Newton, how: Strategy) -> Any:
        if not next(tries):
            raise NotConverged("not tried")
        return step(self, how)

    with monkeypatch.context() as patch:
        patch.setattr(Newton, "step", failing)
        again = first_step(400.0, plot)
    assert again.dt < 400.0
    at_once = first_step(again.dt, plot)
    assert at_once.dt == again.dt and np.abs(at_once.d).max() > 1.0
    assert np.array_equal(again.d, at_once.d)


# ---- reactions ------------------------------------------------------------------------------------


def consumed(n: int, k: float, analysis: str) -> np.ndarray:
    """Glucose used up at k c in a slab, its bath at z = L, the plane of symmetry at 0."""
    m = layer(n, [solute("Glc")])
    rate = mt.ConstantReactionRate(k=k)
    m.materials["tissue"].add(
        "reaction", mt.MassActionForward(vR={"Glc": 1}, Vbar=0.0, override_vbar=True, forward_rate=rate))
    start(m, {"Glc": 10.0})
    bathe(m, m.nodes(z="max"), {"Glc": 10.0})
    if analysis == "TRANSIENT":
        m.step(time=1e6, dt=1e2, dtmax=1e5, solver=TIGHT)
    else:
        m.step(analysis=analysis, time=1.0, dt=1.0, fixed=True, solver=TIGHT)
    return nodal(m, solved(m), "concentration 1") / 10.0


@pytest.mark.parametrize("thiele", [0.5, 2.0])
def test_reaction_and_diffusion_in_a_slab(thiele: float) -> None:
    """c / c* = cosh(Th z / L) / cosh(Th), Th = L sqrt(k / D); order 2 in h."""
    k = 0.67e-3 * (thiele / L) ** 2
    errors = []
    for n in (4, 8, 16):
        exact = np.cosh(thiele * np.linspace(0, 1, n + 1)) / np.cosh(thiele)
        errors.append(float(np.abs(consumed(n, k, "TRANSIENT") - exact).max()))
    assert errors[-1] < 1e-3 and (abs(orders(errors) - 2) < 0.1).all(), (errors, orders(errors))


def test_a_steady_state_reacts_by_the_porosity_squared() -> None:
    """FEBio 4.11 multiplies supplies of solutes by the porosity once more in steady states, and so does febkit."""
    thiele = 2.0
    k = 0.67e-3 * (thiele / L) ** 2
    exact = np.cosh(thiele * np.linspace(0, 1, 17)) / np.cosh(thiele)
    assert np.abs(consumed(16, k / POROSITY, "STEADY-STATE") - exact).max() < 1e-3
    assert np.abs(consumed(16, k, "STEADY-STATE") - exact).max() > 1e-2


def test_a_reversible_reaction_comes_to_equilibrium(monkeypatch: pytest.MonkeyPatch) -> None:
    """A = B in a closed block: A + B is kept, B / A = kF / kR, (1 + (kF + kR) dt)^-n of the way left after n steps."""
    monkeypatch.setitem(CHARGES, "A", 0)
    monkeypatch.setitem(CHARGES, "B", 0)
    m = block((1, 1, 1), (1, 1, 1), [solute("A", free=1e-3), solute("B", free=1e-3)])
    kF, kR, dt, steps = 0.03, 0.01, 5.0, 20
    m.materials["tissue"].add("reaction", mt.MassActionReversible(
        vR={"A": 1}, vP={"B": 1}, Vbar=0.0, override_vbar=True,
        forward_rate=mt.ConstantReactionRate(k=kF), reverse_rate=mt.ConstantReactionRate(k=kR)))  # fmt: skip
    m.fix("all", "x", "y", "z")
    m.initial(A=12.0, B=0.0, p=0.0)
    m.prescribe("all", p=0.0)
    m.step(time=dt * steps, dt=dt, fixed=True, solver=TIGHT)
    result = solved(m)
    left = (1 + (kF + kR) * dt) ** -steps
    a, b = (nodal(m, result, f"concentration {k}") for k in (1, 2))
    assert np.allclose(a + b, 12.0, rtol=1e-10)
    assert np.allclose(a, 3.0 + 9.0 * left, rtol=1e-9)
    assert left < 0.03
