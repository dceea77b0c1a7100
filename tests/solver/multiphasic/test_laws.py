"""Laws of solutes: values, and derivatives by differences."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from febkit.solver import (
    diffusivities,
    osmotic_coefficients,
    reaction_rates,
    reactions,
    solubilities,
    solute_supplies,
)
from febkit.solver.law import PoreCollapse
from febkit.solver.multiphasic.partition import partition
from febkit.solver.multiphasic.solution import Solution
from febkit.solver.multiphasic.voigt import full, full4
from febkit.solver.points import Points
from febkit.solver.solids.registry import load
from helpers.mixture_element import Wells, mixture, solute

RNG = np.random.default_rng(4)
N, PHI, H = 5, 0.2, 1e-6
MIX = mixture(tuple(solute(i, z) for i, z in enumerate((1, -1, 0))))
F0 = np.eye(3) + 0.1 * RNG.uniform(-1, 1, (N, 3, 3))
C0 = RNG.uniform(0.5, 1.5, (N, 3))


def evaluated(F: np.ndarray, c: np.ndarray) -> tuple[Points, Solution]:
    pts = Points.at(F)
    sol = Solution.at(MIX.z, c.copy(), np.full(N, PHI))
    sol.cF[:] = -0.4 * (1 - PHI) / (pts.J - PHI)
    partition(MIX, pts, sol, np.zeros(N))
    return pts, sol


def by_J(value: Any) -> np.ndarray:
    """Derivative by J along an isotropic stretch."""
    J = np.linalg.det(F0)
    plus, minus = (evaluated(F0 * np.cbrt(1 + s * H / J)[:, None, None], C0) for s in (1, -1))
    return (value(*plus) - value(*minus)) / (2 * H)


def by_c(value: Any) -> np.ndarray:
    out = []
    for j in range(3):
        step = np.zeros(3)
        step[j] = H
        out.append((value(*evaluated(F0, C0 + step)) - value(*evaluated(F0, C0 - step))) / (2 * H))
    return np.stack(out, axis=1)


DIFFUSIVITIES = {
    "diff-const-iso": {"free_diff": 1.0, "diff": 0.4},
    "diff-const-ortho": {"free_diff": 1.0, "diff": (0.4, 0.3, 0.2)},
    "diff-ref-iso": {"free_diff": 9.0, "diff0": 1.1, "diff1": 0.3, "diff2": 0.2, "M": 0.4, "alpha": 1.1},
    "diff-Albro-iso": {"free_diff": 1.3, "cdinv": 0.3, "alphad": 0.5},
}


def tensor(law: Any, i: int) -> Any:
    def value(pts: Points, sol: Solution) -> np.ndarray:
        D = np.zeros((N, 6))
        law.diffusivity(pts, sol, i, D, None)
        return full(D)

    return value


def test_every_kind_is_tested() -> None:
    assert set(DIFFUSIVITIES) == set(diffusivities.TYPES)
    strained = {"Huiskes reaction rate", "exp-sed reaction rate", "Ruberti reaction rate"}
    other = {"constant reaction rate", "Nims reaction rate", "solute-as-sbm reaction rate"}
    assert strained | other == set(reaction_rates.TYPES)
    assert {"supply-const", "supply-binding", "supply-synthesis-binding", "supply-Michaelis-Menten"} == set(
        solute_supplies.TYPES
    )


@pytest.mark.parametrize("name", [n for n in DIFFUSIVITIES if "const" not in n])
def test_strain_tangent_of_a_diffusivity(name: str) -> None:
    """J D : e is the rate of J D convected: D tr e + D' - L D - D L^T."""
    law = diffusivities.load(name)(**DIFFUSIVITIES[name])
    pts, sol = evaluated(F0, C0)
    dD = np.zeros((N, 6, 6))
    law.diffusivity(pts, sol, 1, np.zeros((N, 6)), dD)
    L = RNG.uniform(-1, 1, (3, 3))
    value = tensor(law, 1)
    rate = (value(*evaluated(F0 + H * L @ F0, C0)) - value(*evaluated(F0 - H * L @ F0, C0))) / (2 * H)
    D = value(pts, sol)
    expected = D * np.trace(L) + rate - L @ D - D @ L.T
    assert np.allclose(np.einsum("nabkl,kl->nab", full4(dD), 0.5 * (L + L.T)), expected, atol=1e-8)


def test_slopes_of_the_albro_diffusivity() -> None:
    law = diffusivities.load("diff-Albro-iso")(**DIFFUSIVITIES["diff-Albro-iso"])
    dD, dD0 = law.slopes(*evaluated(F0, C0), 1)
    assert np.allclose(full(dD), by_c(tensor(law, 1)), atol=1e-8)
    assert np.allclose(dD0, by_c(lambda pts, sol: law.free(pts, sol, 1)), atol=1e-8)
    assert dD0[:, 0].any()  # through the partition coefficient


def test_diffusivity_known_values() -> None:
    pts, sol = evaluated(np.tile(np.diag([1.1, 0.9, 1.0]), (N, 1, 1)), C0)
    J = 0.99
    law = diffusivities.load("diff-Albro-iso")(free_diff=2.0, cdinv=0.1, alphad=0.5)
    expected = 2.0 * np.exp(-0.5 * 0.2 / (J - 0.2) - 0.1 * sol.ca[:, 2])
    assert np.allclose(tensor(law, 2)(pts, sol)[:, 0, 0], expected)
    law = diffusivities.load("diff-ref-iso")(diff0=1.1, diff1=0.3, diff2=0.2, M=0.4, alpha=1.5)
    f = ((J - 0.2) / 0.8) ** 1.5 * np.exp(0.2 * (J * J - 1))
    assert np.allclose(tensor(law, 0)(pts, sol)[0, 0, 0], f * (1.1 + 0.3 * 1.21 / J**2 + 0.2 * 1.21**2 / J**4))
    assert law.free(pts, sol, 0)[0] == 1.1


def test_closed_pores_are_named() -> None:
    law = diffusivities.load("diff-Albro-iso")(alphad=1.0)
    pts, sol = evaluated(F0, C0)
    pts.J[3] = 0.1
    with pytest.raises(PoreCollapse):
        tensor(law, 0)(pts, sol)


@pytest.mark.parametrize("ksi", [0.7, 2.5])
@pytest.mark.parametrize("i", [0, 1], ids=["counterion", "co-ion"])
def test_slopes_of_manning_s_solubility(ksi: float, i: int) -> None:
    law = solubilities.load("solub-Manning")(ksi=ksi, co_ion=1, solub=Wells())
    dJ, dc = law.slopes(*evaluated(F0, C0), i)
    assert np.allclose(dJ, by_J(lambda pts, sol: law.solubility(pts, sol, i)), atol=1e-8)
    assert np.allclose(dc, by_c(lambda pts, sol: law.solubility(pts, sol, i)), atol=1e-8)


@pytest.mark.parametrize("ksi", [0.7, 2.5])
def test_slopes_of_manning_s_osmotic_coefficient(ksi: float) -> None:
    law = osmotic_coefficients.load("osm-coef-Manning")(ksi=ksi, co_ion=1, osmc=Wells())
    pts, sol = evaluated(F0, C0)
    dJ, dc = law.slopes(pts, sol)
    assert np.allclose(dJ, by_J(law.coefficient), atol=1e-8)
    assert np.allclose(dc, by_c(law.coefficient), atol=1e-8)
    X = np.abs(sol.cF) / sol.ca[:, 1]
    manning = 1 - 0.35 * X / (X + 2) if ksi == 0.7 else (0.2 * X + 2) / (X + 2)
    assert np.allclose(law.coefficient(pts, sol), manning + Wells().value(sol.ca[:, 1]) - 1)


def test_nims_rate_remembers_the_largest_concentration() -> None:
    law = reaction_rates.load("Nims reaction rate")(sol=2, k0=1.0, kc=3.0, kr=0.5, cc=2.0, cr=2.0, trel=10.0)
    pts, sol = evaluated(F0, C0)
    sol.memory[id(law)] = np.zeros(N)
    sol.ca[:, 2] = 1.0
    assert np.allclose(law.rate(pts, sol), 2.0)
    law.begin_step(pts, sol)
    sol.ca[:, 2] = 0.1
    assert np.allclose(law.rate(pts, sol), 2.0)
    pts.t = 10.0
    assert np.allclose(law.rate(pts, sol), 0.75)


def test_rate_per_referential_volume() -> None:
    law = reaction_rates.load("solute-as-sbm reaction rate")(k0=0.3)
    assert np.allclose(law.by_J(*evaluated(F0, C0)), by_J(law.rate), atol=1e-8)


@pytest.mark.parametrize(
    ("kind", "parameters"), [("Huiskes", {"B": 0.4, "psi0": 0.01}), ("exp-sed", {"B": 0.3, "Psi0": 0.2})]
)
def test_rates_by_strain(kind: str, parameters: dict[str, float]) -> None:
    """At a held strain energy, which is that of the last evaluation; the energy is taken of the solid."""
    law = reaction_rates.load(f"{kind} reaction rate")(**parameters)
    bone = load("solid", "Carter-Hayes")(E0=2.0, v=0.2, rho0=0.5, gamma=2.0)
    law.attach(bone, np.zeros(1), np.ones(1), np.array([3.0]))
    W = np.linspace(0.05, 0.1, N)

    def rate(pts: Points, sol: Solution) -> np.ndarray:
        sol.bound, sol.memory[id(law)] = np.full((N, 1), 0.4), W
        return law.rate(pts, sol)

    pts, sol = evaluated(F0, C0)
    k = rate(pts, sol)
    rho = PHI * 0.5 + 0.4  # the solid for itself has its reference density
    exact = 0.4 * (W / rho - 0.01) / 3.0 if kind == "Huiskes" else 0.3 * np.exp(W / 0.2)
    assert np.allclose(k * (pts.J - PHI), exact)
    assert np.allclose(law.by_J(pts, sol), by_J(rate), atol=1e-8)
    law.evaluated(pts, sol.memory[id(law)])
    assert np.allclose(sol.memory[id(law)], bone.energy(pts))


def test_binding_conserves_the_solute() -> None:
    """What receptors bind leaves the solution, and at rest the two rates are equal."""
    pts, _ = evaluated(F0, C0)
    cr, held = RNG.uniform(0.1, 1, N), RNG.uniform(0.1, 0.3, N)
    law = solute_supplies.load("supply-binding")(kf=2.0, kr=0.5, Rtot=0.8)
    assert np.allclose(law.supply(pts, cr, held), -law.binding(pts, cr, held))
    assert np.allclose(law.binding(pts, cr, law.bound_at_rest(pts, cr)), 0.0, atol=1e-15)
    made = solute_supplies.load("supply-synthesis-binding")(kf=2.0, kr=0.5, Rtot=0.8, supp=0.3)
    assert np.allclose(made.supply(pts, cr, held), 0.3 + law.supply(pts, cr, held))
    used = solute_supplies.load("supply-Michaelis-Menten")(Vmax=2.0, Km=0.5)
    assert np.allclose(used.supply(pts, cr, held), -2.0 * cr / (0.5 + cr))
    assert solute_supplies.load("supply-const")(supp=0.2).supply(pts, cr, held)[0] == 0.2


def test_a_michaelis_menten_reaction_has_one_reactant() -> None:
    with pytest.raises(ValueError, match="one vR"):
        reactions.load("Michaelis-Menten")(np.array([1.0, 1.0]), np.zeros(2))
