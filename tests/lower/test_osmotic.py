"""Osmotic solids take R and T of <Globals>, and the fibers of a charged matrix FEBio's directions."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from febkit.model import InputError
from febkit.solver.points import Points
from febkit.solver.solids.base import Solid, evaluate
from febkit.solver.solids.ellipsoidal_fibers import EllipsoidalFibers, EllipsoidalFibersOld
from febkit.solver.solids.osmotic import Donnan
from febkit.solver.values import Expression
from helpers import cube

R, T = 8.314e-6, 310.0
GAS = f"<R>{R}</R><T>{T}</T>"
DONNAN = "<phiw0>0.8</phiw0><cF0>200</cF0><bosm>300</bosm>"


def solid(folder: Path, material: str, constants: str = GAS) -> Solid:
    return cube.problem(folder, cube.text(material, constants=constants)).blocks[0].solid


def points(*stretch: float, t: float = 0.0) -> Points:
    F = np.diag(stretch)[None]
    pts = Points(F, np.linalg.det(F), np.zeros((1, 3)), np.zeros(1, int))
    pts.t = t
    return pts


def test_constants_of_the_file_scale_the_pressure(tmp_path: Path) -> None:
    law = solid(tmp_path, f'<material id="1" name="m" type="Donnan equilibrium">{DONNAN}</material>')
    s, _ = evaluate(law, points(1.0, 1.0, 1.0))
    np.testing.assert_allclose(s[0], [-R * T * (np.hypot(200, 300) - 300)] * 3 + [0] * 3)


@pytest.mark.parametrize("constants", ["", "<R>8.314e-6</R>", "<R>8.314e-6</R><T>0</T>"])
def test_lacking_constants_are_named(tmp_path: Path, constants: str) -> None:
    with pytest.raises(InputError, match=r"positive <[RT]> in <Globals><Constants>"):
        solid(tmp_path, '<material id="1" name="m" type="perfect osmometer"><phiw0>0.8</phiw0></material>', constants)


def test_solid_fraction_may_grow_in_time() -> None:
    """phis0 gives phiw0 at the start alone (FEBio's Donnan equilibrium)."""
    law = Donnan(phis0=Expression(lambda X, Y, Z, t: 0.2 + 0.1 * t + 0 * X), cF0=0.2, bosm=0.3, R=1.0, T=1.0)
    s, _ = evaluate(law, points(1.2, 1.0, 1.0, t=1.0))
    cF = 0.8 * 0.2 / (1.2 - 0.3)
    assert s[0, 0] == pytest.approx(0.3 - np.hypot(cF, 0.3))


def test_fibers_of_a_charged_matrix_are_summed_over_the_dome(tmp_path: Path) -> None:
    fibers = "<beta>2.5,3,3.5</beta><ksi>1,2,3</ksi>"
    whole = solid(tmp_path, f'<material id="1" name="m" type="EFD Donnan equilibrium">{DONNAN}{fibers}</material>')
    matrix = solid(tmp_path, f'<material id="1" name="m" type="Donnan equilibrium">{DONNAN}</material>')
    pts = points(1.1, 0.95, 1.2)
    got = evaluate(whole, pts)[0] - evaluate(matrix, pts)[0]
    family = {"beta": (2.5, 3.0, 3.5), "ksi": (1.0, 2.0, 3.0)}
    np.testing.assert_allclose(got, evaluate(EllipsoidalFibersOld(**family), pts)[0], atol=1e-14)
    assert np.abs(got - evaluate(EllipsoidalFibers(**family), pts)[0]).max() > 1e-6
