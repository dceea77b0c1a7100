"""Springs and linear constraints of a file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from febkit.lower import lower
from febkit.model import InputError, UnsupportedError
from febkit.solver.loads import springs
from helpers import cube

SOFT = '<material id="1" name="m" type="neo-Hookean"><E>1</E><v>0.3</v></material>'
TIE = """<bc type="linear constraint"><node>6</node><dof>x</dof><offset>0.1</offset>
<child_dof><node>5</node><dof>x</dof><value>2</value></child_dof>
<child_dof><node>7</node><dof>z</dof><value>-1</value></child_dof></bc>"""
SET = """<Constraints><constraint type="linear constraint"><laugon>1</laugon><tol>0.01</tol><penalty>9</penalty>
<linear_constraint><node id="5" bc="z">1</node><node id="6" bc="z">-1</node></linear_constraint>
<linear_constraint><node id="7" bc="x">0.5</node></linear_constraint></constraint></Constraints>"""
MUSCLE = """<Discrete><discrete_material id="1" name="s" type="{}"/>
<discrete_material id="2" name="h" type="Hill"><Fmax>3</Fmax><ac>0.5</ac><Ftl type="point"><points><pt>0,0</pt>
<pt>1,1</pt><pt>2,0</pt></points></Ftl></discrete_material>
<discrete dmat="{}" discrete_set="pairs"/></Discrete>"""


def tied(*bcs: str) -> str:
    return cube.text(SOFT).replace("</Boundary>", "".join(bcs) + "</Boundary>")


def with_springs(kind: str, number: int = 1) -> str:
    content = cube.text(SOFT, more=MUSCLE.format(kind, number))
    pairs = '<DiscreteSet name="pairs"><delem>1,7</delem><delem>2,6</delem></DiscreteSet></Mesh>'
    return content.replace("</Mesh>", pairs)


def test_a_linear_constraint(tmp_path: Path) -> None:
    (tie,) = lower(cube.read(tmp_path, tied(TIE))).common.constraints
    assert (tie.node, tie.column, tie.offset) == (5, 0, 0.1)
    assert tie.nodes.tolist() == [4, 6] and tie.columns.tolist() == [0, 2]
    assert [float(v(0.0, np.zeros((1, 3)))[0]) for v in tie.values] == [2.0, -1.0]


def test_constraints_that_hang_on_one_another_are_refused(tmp_path: Path) -> None:
    other = TIE.replace("<node>6</node>", "<node>8</node>").replace("<node>5</node>", "<node>6</node>")
    with pytest.raises(UnsupportedError, match=r"linear constraint \(of node 8\) of unknowns that depend on others"):
        lower(cube.read(tmp_path, tied(TIE, other)))
    with pytest.raises(InputError, match="there is no node 60"):
        lower(cube.read(tmp_path, tied(TIE.replace("<node>6<", "<node>60<"))))
    with pytest.raises(InputError, match="cannot act on 'p'"):
        lower(cube.read(tmp_path, tied(TIE.replace("<dof>z<", "<dof>p<"))))


def test_a_set_of_constraints(tmp_path: Path) -> None:
    (load,) = lower(cube.read(tmp_path, cube.text(SOFT, more=SET))).common.loads
    assert load.nodes.tolist() == [[4, 5], [6, -1]] and load.columns[:, 0].tolist() == [2, 0]
    assert load.coefficients.tolist() == [[1.0, -1.0], [0.5, 0.0]]
    assert (load.tolerance, load.maxaug, load.laugon) == (0.01, 50, 1)
    assert load.penalty(0.0, np.zeros((1, 3)))[0] == 9.0
    with pytest.raises(UnsupportedError, match="LAGMULT"):
        lower(cube.read(tmp_path, cube.text(SOFT, more=SET.replace("<laugon>1", "<laugon>2"))))


def test_springs(tmp_path: Path) -> None:
    (load,) = lower(cube.read(tmp_path, with_springs("tension-only linear spring"))).common.loads
    assert isinstance(load, springs.LinearSprings) and load.tension_only
    np.testing.assert_allclose(load.rest, [np.sqrt(3), 1.0])
    (muscle,) = lower(cube.read(tmp_path, with_springs("linear spring", 2))).common.loads
    assert isinstance(muscle, springs.HillMuscles) and muscle.Fvl is None
    np.testing.assert_allclose(muscle.Ftl(np.array([0.5, 1.5])), 0.5)
    with pytest.raises(UnsupportedError, match='<discrete_material type="torsion">'):
        lower(cube.read(tmp_path, with_springs("torsion")))
    with pytest.raises(InputError, match='no discrete material "3"'):
        lower(cube.read(tmp_path, with_springs("linear spring", 3)))
