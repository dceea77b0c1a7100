"""Charged tissues on small meshes, in mm, N, s, nmol (mmol/l), and Donnan's theory of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.optimize import brentq

import febkit
from febkit import materials as mt
from febkit.modelling.solution import Solution

R, T, FC = 8.314e-6, 298.0, 9.65e-5  # mJ/(nmol K), K, C/nmol
RT = R * T
E, V = 0.5, 0.1  # MPa, - of the solid
MU, LAM = E / 2 / (1 + V), E * V / (1 + V) / (1 - 2 * V)
PHI0, PERM = 0.2, 1e-3  # -, mm^4/(N s)
TIGHT = {"dtol": 1e-10, "etol": 0, "rtol": 0, "ptol": 1e-10, "ctol": 1e-10, "min_residual": 1e-20, "max_refs": 60}
CHARGES = {"Na+": 1, "Cl-": -1, "Ca2+": 2, "Glc": 0}
FREE = {"Na+": 1.33e-3, "Cl-": 2.03e-3, "Ca2+": 0.79e-3, "Glc": 0.67e-3}  # mm^2/s in water


def solute(name: str, free: float | None = None, hindered: float = 1.0, solubility: Any = 1.0) -> Any:
    """A solute of diffusivity ``free`` in water and ``hindered`` times that in the tissue."""
    d = FREE[name] if free is None else free
    law = mt.SolubConst(solub=solubility) if isinstance(solubility, float) else solubility
    return mt.Solute(name, diffusivity=mt.DiffConstIso(free_diff=d, diff=hindered * d), solubility=law)


def block(size: Sequence[float], n: Sequence[int], solutes: Sequence[Any], *, osmotic: Any = 1.0, perm: float = PERM,
          **material: Any) -> febkit.Model:  # fmt: skip
    """A block of tissue; ``solutes`` are constituents, all their names in CHARGES."""
    m = febkit.Model("multiphasic", units="mm-N-s")
    m.set_constants(R=R, T=T, Fc=FC)
    for s in solutes:
        name = s.component.attrs["sol"]
        m.solute(name, CHARGES[name])
    m.add_block("tissue", size, n)
    coefficient = mt.OsmCoefConst(osmcoef=osmotic) if isinstance(osmotic, float) else osmotic
    m.materials["tissue"] = mt.Multiphasic(
        phi0=PHI0, solid=mt.NeoHookean(E=E, v=V), permeability=mt.PermConstIso(perm=perm),
        osmotic_coefficient=coefficient, solute=list(solutes), **material)  # fmt: skip
    return m


def bathe(m: febkit.Model, where: Any, bath: dict[str, float], osmotic: float = 1.0, pressure: float = 0.0) -> None:
    """Nodes in contact with a bath of these concentrations, ideal but for the osmotic coefficient."""
    m.prescribe(where, p=pressure - RT * osmotic * sum(bath.values()), **bath)


def start(m: febkit.Model, bath: dict[str, float], osmotic: float = 1.0) -> None:
    """The tissue begins in equilibrium with a bath, were it not charged."""
    m.initial(p=-RT * osmotic * sum(bath.values()), **bath)


def charge(m: febkit.Model, cFr: float, until: float = 1.0) -> None:
    """Fixed charges that grow from none to ``cFr`` (per fluid volume of the reference) at time ``until``."""
    material = m.materials["tissue"]
    material.fixed_charge_density = cFr
    material["fixed_charge_density"].curve = m.curves.add([(0, 0), (until, 1)])


def solved(m: febkit.Model, **options: Any) -> Solution:
    result = m.solve(threads=1, **options)
    assert result.converged, result.reason
    return result


def field(result: Solution, name: str, time: int = -1) -> Any:
    """Values of the elements at a state of the run."""
    return result.dataset[name].isel(time=time).values.astype(float)


# ---- theory -----------------------------------------------------------------------------------------


def inside(cF: float, z: Sequence[int], kc: Sequence[float]) -> tuple[np.ndarray, float]:
    """Concentrations inside, and zeta = exp(-Fc psi / RT): sum z kc zeta^z + cF = 0, by bisection of ln zeta."""
    zs, k = np.array(z, float), np.array(kc, float)
    y = brentq(lambda y: float(zs @ (k * np.exp(zs * y)) + cF), -40, 40, xtol=1e-14, rtol=1e-15)
    return k * np.exp(zs * y), float(np.exp(y))


def donnan_pressure(cF: float, bath: float) -> float:
    """Ideal Donnan pressure of a 1:1 salt: RT (sqrt(cF^2 + 4 c^2) - 2 c)."""
    return RT * float(np.sqrt(cF * cF + 4 * bath * bath) - 2 * bath)


def neo_hookean(stretch: float, J: float) -> float:
    """Principal stress of FEBio's neo-Hookean solid: (mu (stretch^2 - 1) + lambda ln J) / J."""
    return (MU * (stretch * stretch - 1) + LAM * float(np.log(J))) / J
