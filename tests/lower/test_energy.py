"""Solids whose strain energy the file gives as a formula."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from febkit.model import InputError
from febkit.solver.points import Points
from febkit.solver.solids.base import Solid, evaluate
from febkit.solver.solids.neo_hookean import NeoHookean
from helpers import cube


def solid(folder: Path, W: str) -> Solid:
    material = f'<material id="1" name="m" type="hyperelastic"><W>{W}</W><print_derivs>0</print_derivs></material>'
    return cube.problem(folder, cube.text(material)).blocks[0].solid


def test_definitions_come_before_the_energy(tmp_path: Path) -> None:
    """The neo-Hookean energy, its moduli defined from E and v in the formula."""
    law = solid(tmp_path, """
        E = 2; v = 0.3;
        mu = E/(2*(1 + v)); lam = E*v/((1 + v)*(1 - 2*v));
        mu*((I1 - 3)/2 - ln(J)) + lam*ln(J)*ln(J)/2
    """)
    F = np.eye(3) + 0.1 * np.random.default_rng(0).normal(size=(4, 3, 3))
    pts = Points(F, np.linalg.det(F), np.zeros((4, 3)), np.zeros(4, int))
    s, c = evaluate(law, pts)
    s0, c0 = evaluate(NeoHookean(2.0, 0.3), pts)
    assert c is not None and c0 is not None
    np.testing.assert_allclose(s, s0, atol=1e-10)
    np.testing.assert_allclose(c, c0, atol=1e-6)


@pytest.mark.parametrize(("W", "message"), [
    ("mu*(I1 - 3)", "unknown variable mu"),
    ("2 mu; I1 - 3", "must read name = formula"),
    ("mu = I9; mu*(I1 - 3)", "unknown variable I9"),
    ("", "empty"),
])  # fmt: skip
def test_bad_formulas_are_named(tmp_path: Path, W: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        solid(tmp_path, W)
