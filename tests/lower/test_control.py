"""<Control>: the step limit by a curve, and how a run that cannot go on ends."""

from __future__ import annotations

from pathlib import Path

import pytest

import febkit
from febkit.model import InputError
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


BAD = [
    ("<time_steps>-5</time_steps><step_size>0.2</step_size>", "time_steps"),
    ("<time_steps>0</time_steps><step_size>0.2</step_size>", "time_steps"),
    ("<time_steps>5</time_steps><step_size>0</step_size>", "step_size"),
    ("<time_steps>5</time_steps><step_size>-0.2</step_size>", "step_size"),
    ("<time_steps>5</time_steps><step_size>1e300</step_size>", "end time"),
    ("<time_steps>-1</time_steps><final_time>0</final_time>", "final_time"),
    ("<time_steps>-1</time_steps>", "final_time"),
    ("<final_time>1</final_time>", "time_steps"),
    (STEPS + "<solver><dtol>-1</dtol></solver>", "dtol"),
    (STEPS + "<solver><max_residual>-1</max_residual></solver>", "max_residual"),
    (STEPS + '<solver><qn_method type="BFGS"><cmax>-1</cmax></qn_method></solver>', "cmax"),
    (STEPS + "<time_stepper><opt_iter>-3</opt_iter></time_stepper>", "opt_iter"),
    (STEPS + "<time_stepper><max_retries>-1</max_retries></time_stepper>", "max_retries"),
    (STEPS + "<time_stepper><dtmin>-1</dtmin></time_stepper>", "dtmin"),
    (STEPS + "<time_stepper><dtmax>-1</dtmax></time_stepper>", "dtmax"),
    (STEPS + "<time_stepper><cutback>0</cutback></time_stepper>", "cutback"),
]  # fmt: skip


@pytest.mark.parametrize(("control", "named"), BAD)
def test_control_that_leads_nowhere_is_refused_with_its_line(tmp_path: Path, control: str, named: str) -> None:
    with pytest.raises(InputError, match=rf"cube\.feb:\d+: .*{named}"):
        cube.problem(tmp_path, cube.text(SOFT, control=control))


@pytest.mark.parametrize(("tag", "value"), [
    ("step_size", "nan"), ("step_size", "inf"), ("final_time", "nan"), ("final_time", "inf"), ("dtol", "nan"),
    ("rtol", "inf"), ("dtmax", "nan"), ("dtmin", "inf"), ("must_points", "0.1,nan"), ("cutback", "nan"),
])  # fmt: skip
def test_control_takes_no_numbers_that_are_not_finite(tmp_path: Path, tag: str, value: str) -> None:
    leaf = f"<{tag}>{value}</{tag}>"
    if tag == "step_size":
        control = f"<time_steps>4</time_steps>{leaf}"
    elif tag == "final_time":
        control = f"<time_steps>-1</time_steps><step_size>0.1</step_size>{leaf}"
    else:
        parent = "solver" if tag.endswith("tol") else "time_stepper"
        control = STEPS + f"<{parent}>{leaf}</{parent}>"
    with pytest.raises(InputError, match=rf"cube\.feb:\d+: .*{tag}"):
        cube.problem(tmp_path, cube.text(SOFT, control=control))


@pytest.mark.parametrize("newmark", ["<beta>0</beta>", "<beta>-0.25</beta>", "<alpha>0</alpha>"])
def test_newmarks_rule_divides_by_something(tmp_path: Path, newmark: str) -> None:
    content = cube.text(SOFT, control=STEPS + f"<solver><rhoi>-2</rhoi>{newmark}</solver>")
    cube.problem(tmp_path, content)  # static: not asked for
    with pytest.raises(InputError, match="must be more than 0 in dynamics"):
        cube.problem(tmp_path, content.replace("STATIC", "DYNAMIC"))


def test_an_empty_control_takes_febios_ten_steps(tmp_path: Path) -> None:
    content = cube.text(SOFT).replace("<time_steps>1</time_steps><step_size>1</step_size>", "")
    step = cube.problem(tmp_path, content).steps[0]
    assert (step.count, step.dt, step.duration) == (10, 0.1, None)


@pytest.mark.parametrize("points", [
    "<pt>0,0.1</pt>", "<pt>-1,0.1</pt><pt>-0.5,0.1</pt>", "<pt>0,0.1</pt><pt>1e-20,0.1</pt>",
])  # fmt: skip
def test_must_points_that_never_come_to_an_end_are_refused(tmp_path: Path, points: str) -> None:
    curve = f"""<LoadData><load_controller id="2" type="loadcurve"><extend>REPEAT</extend><points>{points}</points>
</load_controller></LoadData>"""
    control = STEPS + STEPPER.format('<dtmax lc="2"></dtmax>', 5)
    with pytest.raises(InputError, match=r"cube\.feb:\d+: .*load controller 2"):
        cube.problem(tmp_path, cube.text(SOFT, control=control, more=curve))
