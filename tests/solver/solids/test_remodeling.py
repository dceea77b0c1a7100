"""Density of remodeling solids: roots of its equation, bounds, homeostasis."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from febkit.model import InputError
from febkit.solver.points import Points
from febkit.solver.solids import history
from febkit.solver.solids.registry import load
from helpers import cube, laws

F = laws.deformations(5, 0.2)
DECK = """<material id="1" name="m" type="remodeling solid">{}
<solid type="Carter-Hayes (old)"><density>1.2</density><c>2</c><gamma>3</gamma><v>0.3</v></solid>
<supply type="Huiskes-supply"><B>0.5</B><k>0.1</k>{}</supply></material>"""
BOUNDS = "<min_density>0.1</min_density><max_density>2</max_density>"


def solid(gamma=1.0, B=0.5, k=0.1, least=1e-3, most=1e3, start=1.2):
    base = load("remodeled", "Carter-Hayes (old)")(c=2.0, gamma=gamma, v=0.3, density_=start)
    supply = load("solid_supply", "Huiskes-supply")(B=B, k=k)
    return load("solid", "remodeling solid")(solid=base, supply=supply, min_density=least, max_density=most)


def unit_energy():
    """W / rho^gamma at the deformations: that of a neo-Hookean solid with E = c."""
    return load("solid", "neo-Hookean")(E=2.0, v=0.3).energy(Points.at(F))


def densities(law, steps=1, dt=0.4):
    old = history.initial(law, len(F))
    for k in range(steps):
        pts = Points.at(F, t=(k + 1) * dt, dt=dt, old=old, new=old.copy())
        laws.stress_of(law, pts)
        old = pts.new
    return law.density(pts)


def test_density_where_the_modulus_is_proportional_to_it():
    """gamma = 1: the specific energy does not depend on the density, which grows by dt B (w - k)."""
    np.testing.assert_allclose(densities(solid()), 1.2 + 0.4 * 0.5 * (unit_energy() - 0.1), rtol=1e-13)
    np.testing.assert_allclose(densities(solid(), 3), 1.2 + 1.2 * 0.5 * (unit_energy() - 0.1), rtol=1e-13)


def test_density_where_its_equation_is_quadratic():
    """gamma = 3: dt B u rho^2 - rho + rho_old - dt B k = 0, of whose roots the first is meant."""
    law, a = solid(gamma=3.0, B=0.2), 0.4 * 0.2 * unit_energy()
    root = (1.0 - np.sqrt(1.0 - 4.0 * a * (1.2 - 0.4 * 0.2 * 0.1))) / (2.0 * a)
    np.testing.assert_allclose(densities(law), root, rtol=1e-12)


def test_density_stays_within_its_bounds():
    np.testing.assert_array_equal(densities(solid(gamma=3.0, B=200.0, k=0.0, most=1.7)), 1.7)
    np.testing.assert_array_equal(densities(solid(B=200.0, k=10.0, least=0.4)), 0.4)


def test_at_homeostasis_nothing_changes():
    u = unit_energy()
    law = solid(k=float(u[0]))
    assert densities(law, 4)[0] == pytest.approx(1.2, rel=1e-14)
    assert (np.abs(densities(law, 4)[1:] - 1.2) > 1e-3).all()


def test_stress_is_that_of_the_density():
    law = solid(gamma=3.0, B=0.2)
    pts = Points.at(F, t=0.4, dt=0.4, old=history.initial(law, len(F)), new=np.zeros((len(F), 1)))
    s = laws.stress_of(law, pts)
    for k, rho in enumerate(law.density(pts)):
        one = load("solid", "neo-Hookean")(E=2.0 * float(rho) ** 3, v=0.3)
        np.testing.assert_allclose(s[k], laws.stress_of(one, Points.at(F[k : k + 1]))[0], rtol=1e-12)


def test_a_deck_is_read(tmp_path: Path) -> None:
    law = cube.problem(tmp_path, cube.text(DECK.format(BOUNDS, "<D>0</D>"))).blocks[0].solid
    assert law.solid.density(Points.at(F))[0] == 1.2


@pytest.mark.parametrize(("bounds", "more", "says"), [
    (BOUNDS, "<D>0.1</D>", "sensor distance <D>"),
    ("<min_density>2</min_density><max_density>1</max_density>", "", "<max_density> 1 must be above <min_density> 2"),
    ("", "", "<max_density> 0 must be above"),
])  # fmt: skip
def test_faults_are_named(tmp_path: Path, bounds: str, more: str, says: str) -> None:
    with pytest.raises(InputError, match=says) as e:
        cube.problem(tmp_path, cube.text(DECK.format(bounds, more)))
    assert e.value.where is not None and e.value.where.line
