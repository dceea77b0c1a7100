"""Stresses of materials by FEBio 4.11, at a deformation gradient given to a whole element."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from febkit.solver.points import Points
from febkit.solver.solids.base import evaluate
from helpers import cube

F = np.array([[1.2, 0.1, 0.0], [-0.05, 0.92, 0.07], [0.02, 0.0, 0.95]])
FIBER = '<fiber type="vector">1,0.5,0</fiber>'
STRESSES = {  # xx yy zz xy yz xz
    "without lam_max, which FEBio then takes for 0: muscle": (
        '<material id="1" name="m" type="muscle material"><g1>5</g1><g2>4</g2><p1>0.05</p1><p2>6.6</p2><smax>300</smax>'
        f"<Lofl>1.07</Lofl><activation>0.3</activation><k>100</k>{FIBER}</material>",
        (48.088058, -13.327588, -19.870428, 21.288612, 0.8737576, 1.1632953),
    ),
    "without lam_max, which FEBio then takes for 0: tendon": (
        '<material id="1" name="m" type="tendon material"><g1>5</g1><g2>4</g2><l1>2.5</l1><l2>4</l2><k>100</k>'
        f"{FIBER}</material>",
        (4.354239, 4.818285, 5.7175169, -1.4547473, 0.50986385, 0.053863112),
    ),
    "cubic CLE": (
        '<material id="1" name="m" type="cubic CLE"><lp1>13.01</lp1><lm1>0.49</lm1><l2>0.66</l2><mu>0.16</mu>'
        '<mat_axis type="vector"><a>1,0.4,0</a><d>0,1,0.3</d></mat_axis></material>',
        (3.3528569, 0.26231706, 0.061884902, 0.82610697, 0.021040909, 0.056310192),
    ),
    "cubic CLE, its axes given as a rotation": (
        '<material id="1" name="m" type="cubic CLE"><lp1>13.01</lp1><lm1>0.49</lm1><l2>0.66</l2><mu>0.16</mu>'
        '<mat_axis type="const">0.928476690885,-0.353401019252,0.114187363901,0.371390676354,0.883502548129,'
        "-0.285468409752,0,0.307458886749,0.95156136584</mat_axis></material>",
        (3.3528569, 0.26231706, 0.061884902, 0.82610697, 0.021040909, 0.056310192),
    ),
}


@pytest.mark.parametrize("name", STRESSES)
def test_stress(tmp_path: Path, name: str) -> None:
    material, expected = STRESSES[name]
    solid = cube.problem(tmp_path, cube.text(material)).blocks[0].solid
    s, _ = evaluate(solid, Points.at(F), tangent=False)
    np.testing.assert_allclose(s[0], expected, rtol=2e-7, atol=2e-7 * np.abs(expected).max())
