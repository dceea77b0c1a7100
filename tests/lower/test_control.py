"""<Control>: the step limit by a curve, and how a run that cannot go on ends."""

from __future__ import annotations

from pathlib import Path

import pytest

import febkit
from helpers import cube

SOFT = '<material id="1" name="m" type="neo-Hookean"><E>1</E><v>0.3</v></material>'
CURVE = """<LoadData><load_controller id="2" type="loadcurve"><interpolate>STEP</interpolate><extend>CONSTANT</extend>
<points><pt>0,0.25</pt><pt>0.5,0.5</pt><pt>1,0.5</pt></points></load_controller></LoadData>"""
STEPPER = "<time_stepper>{}<max_retries>{}</max_retries></time_stepper>"
STEPS = "<time_steps>4</time_steps><step_size>0.25</step_size>"


@pytest.mark.parametrize("value", ["", "0", "0.1"])
def test_dtmax_by_a_curve_needs_no_value(tmp_path: Path, value: str) -> None:
    """FEBio takes an empty <dtmax lc>: the curve's values count, its points are must points."""
    control = STEPS + STEPPER.format(f'<dtmax lc="2">{value}</dtmax>', 5)
    auto = cube.problem(tmp_path, cube.text(SOFT, control=control, more=CURVE)).steps[0].auto
    assert auto is not None and auto.must_points == (0.0, 0.5, 1.0)
    assert auto.dtmax_curve(0.1) == 0.5


def test_a_failing_run_says_where_its_retries_ended(tmp_path: Path) -> None:
    """A cube pressed through its base turns inside out at any step that FEBio's rule cuts to."""
    control = STEPS + STEPPER.format("<dtmax>0.25</dtmax>", 2)
    pressed = """<Boundary><bc node_set="base" type="zero displacement"><z_dof>1</z_dof></bc>
<bc node_set="top" type="prescribed displacement"><dof>z</dof><value lc="1">-40</value></bc></Boundary>
<LoadData><load_controller id="1" type="loadcurve"><points><pt>0,0</pt>
<pt>1,1</pt></points></load_controller></LoadData>"""
    content = cube.text(SOFT, control=control, more="")
    before, rest = content.split("<Boundary>")
    content = before + pressed + rest.split("</Boundary>")[1]
    result = febkit.solve(cube.read(tmp_path, content))
    assert not result.converged
    assert "turned inside out" in result.reason
    assert "after 8 halvings by guarded Newton steps beyond the file's retries, down to a step of" in result.reason
