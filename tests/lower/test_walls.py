"""<constraint type="rigid_wall">."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from febkit.model import InputError, UnsupportedError
from febkit.solver.loads.rigid_wall import RigidWall
from febkit.solver.problem import Problem
from helpers import cube

SOLID = '<material id="1" name="m" type="neo-Hookean"><density>1</density><E>1</E><v>0.3</v></material>'
RAMP = ('<LoadData><load_controller id="1" type="loadcurve"><interpolate>LINEAR</interpolate>'
        "<points><pt>0,0</pt><pt>1,2</pt></points></load_controller></LoadData>")
TOP = '<Surface name="topS"><quad4 id="1">5,6,7,8</quad4></Surface>'


def problem(folder: Path, inside: str) -> Problem:
    wall = f'<Constraints><constraint type="rigid_wall" surface="topS">{inside}</constraint></Constraints>'
    return cube.problem(folder, cube.text(SOLID, more=wall + RAMP).replace("</Mesh>", f"{TOP}</Mesh>"))


def test_a_wall_is_read(tmp_path: Path) -> None:
    p = problem(tmp_path, "<laugon>AUGLAG</laugon><tolerance>0.2</tolerance><penalty>9</penalty>"
                '<offset lc="1">0.05</offset><plane>0,0,-1,-1</plane>')
    (wall,) = (a for s in (p.common, *p.steps) for a in s.loads if isinstance(a, RigidWall))
    assert (wall.laugon, wall.tolerance, list(wall.nodes)) == (1, 0.2, [4, 5, 6, 7])
    at = np.zeros((1, 3))
    assert [v(0.5, at)[0] for v in (wall.penalty, wall.offset, *wall.plane)] == [9.0, 0.05, 0.0, 0.0, -1.0, -1.0]


@pytest.mark.parametrize(("inside", "says"), [
    ("<plane>0,0,0,1</plane>", "no normal"),
    ("<plane>0,0,1</plane>", "plane"),
    ("<penalty>1</penalty>", "plane"),
    ("<laugon>LAGMULT</laugon><plane>0,0,1,0</plane>", "laugon"),
])  # fmt: skip
def test_a_wall_that_is_none(tmp_path: Path, inside: str, says: str) -> None:
    with pytest.raises((InputError, UnsupportedError), match=says):
        problem(tmp_path, inside)
