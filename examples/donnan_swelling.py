"""Charged tissue swells in a bath of salt: built in Python, solved, compared with Donnan's theory.

``python examples/donnan_swelling.py`` prints the swelling in baths of several concentrations; :func:`main` returns the
relative volume in one of them, found and expected. Units: mm, N, s, nmol (so mmol/l), mV.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

import febkit
from febkit import materials as mt

R, T, FC = 8.314e-6, 298.0, 9.6485e-5  # mJ/(nmol K), K, C/nmol
E, V, PHI0 = 0.5, 0.1, 0.2  # MPa, -, -
CHARGE = -200.0  # mmol/l of fluid, before it swells


def tissue(bath: float, n: int) -> febkit.Model:
    """A cube of 1 mm on three planes of symmetry, the other faces in a bath of NaCl."""
    m = febkit.Model("multiphasic", units="mm-N-s")
    m.set_constants(R=R, T=T, Fc=FC)
    m.solute("Na+", charge=1)
    m.solute("Cl-", charge=-1)
    m.add_block("tissue", (1, 1, 1), (n, n, n))
    ions = [
        mt.Solute(name, diffusivity=mt.DiffConstIso(free_diff=d, diff=0.6 * d), solubility=mt.SolubConst(solub=1.0))
        for name, d in (("Na+", 1.33e-3), ("Cl-", 2.03e-3))  # mm^2/s
    ]
    m.materials["tissue"] = mt.Multiphasic(
        phi0=PHI0, solid=mt.NeoHookean(E=E, v=V), permeability=mt.PermConstIso(perm=1e-3),
        osmotic_coefficient=mt.OsmCoefConst(osmcoef=1.0), fixed_charge_density=CHARGE, solute=ions)  # fmt: skip
    m.materials["tissue"]["fixed_charge_density"].curve = m.curves.add([(0, 0), (1000, 1)])
    outside = {"p": -2 * R * T * bath, "Na+": bath, "Cl-": bath}  # effective pressure and concentrations of the bath
    m.initial(**outside)
    for axis in "xyz":
        m.fix(m.nodes(**{axis: 0.0}), axis)
        m.prescribe(m.nodes(**{axis: 1.0}), **outside)
    m.step(time=20000.0, dt=100.0, dtmax=2000.0, must_points=[1000.0, 20000.0])
    return m


def expected(bath: float) -> float:
    """J where the stress of the solid balances the Donnan pressure R T (sqrt(cF^2 + 4 c*^2) - 2 c*)."""
    mu, lam = E / 2 / (1 + V), E * V / (1 + V) / (1 - 2 * V)

    def balance(J: float) -> float:
        cF = CHARGE * (1 - PHI0) / (J - PHI0)
        stress = (mu * (J ** (2 / 3) - 1) + lam * np.log(J)) / J
        return float(stress - R * T * (np.hypot(cF, 2 * bath) - 2 * bath))

    return float(brentq(balance, 1.0, 3.0))


def main(bath: float = 150.0, n: int = 3) -> tuple[float, float]:
    """Relative volume once the tissue is at rest, and that of the theory."""
    result = tissue(bath, n).solve()
    assert result.converged, result.reason
    u = np.abs(result.state.u).max(axis=0)  # at the corner, the whole cube stretched alike
    return float(np.prod(1 + u)), expected(bath)


if __name__ == "__main__":
    print("bath (mmol/l)   J   of the theory")
    for bath in (15.0, 50.0, 150.0, 500.0):
        print("{:13g}   {:.5f}   {:.5f}".format(bath, *main(bath)))
