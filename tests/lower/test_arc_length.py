"""<arc_length> and <logSolve> of <solver type="solid">."""

from __future__ import annotations

import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import febkit
from febkit.model import InputError
from febkit.solver.arc_length import ArcLength
from febkit.solver.convergence import NotConverged
from febkit.solver.problem import NewtonOptions
from helpers import cube

E, AREA, LOAD, RISE = 1000.0, 0.01, 0.2, 0.2
FULL = '<qn_method type="BFGS"><max_ups>0</max_ups></qn_method>'
SOLVER = '<solver type="solid"><max_refs>60</max_refs><dtol>1e-8</dtol><etol>1e-14</etol><lstol>0</lstol>{}</solver>'
TRUSSES = f"""<febio_spec version="4.0"><Module type="solid"/>
<Control><analysis>STATIC</analysis><time_steps>40</time_steps><step_size>0.1</step_size>
{SOLVER.format("<arc_length>1</arc_length>" + FULL)}</Control>
<Material><material id="1" name="m" type="linear truss"><E>{E}</E><v>0.3</v></material></Material>
<Mesh><Nodes name="nodes"><node id="1">-1,0,0</node><node id="2">0,0,{RISE}</node><node id="3">1,0,0</node></Nodes>
<Elements type="truss2" name="P"><elem id="1">1,2</elem><elem id="2">2,3</elem></Elements>
<NodeSet name="ends">1,3</NodeSet><NodeSet name="mid">2</NodeSet></Mesh>
<MeshDomains><BeamDomain name="P" mat="m" type="linear-truss">
<cross_sectional_area>{AREA}</cross_sectional_area></BeamDomain></MeshDomains>
<Boundary><bc type="zero displacement" node_set="ends"><x_dof>1</x_dof><y_dof>1</y_dof><z_dof>1</z_dof></bc>
<bc type="zero displacement" node_set="mid"><x_dof>1</x_dof><y_dof>1</y_dof></bc></Boundary>
<Loads><nodal_load type="nodal_load" node_set="mid"><dof>z</dof><scale>-{LOAD}</scale></nodal_load></Loads>
<Output><plotfile type="febio"><var type="displacement"/></plotfile></Output></febio_spec>"""
HOLMES = '<material id="1" name="m" type="Holmes-Mow"><E>1</E><v>0.2</v><beta>4</beta></material>'
STATIC = "<analysis>STATIC</analysis>"
EIGHT = "<time_steps>8</time_steps><step_size>0.125</step_size>"
PULL = ('<Loads><nodal_load type="nodal_load" node_set="top"><dof>z</dof><scale lc="1">0.4</scale></nodal_load></Loads>'
        '<LoadData><load_controller id="1" type="loadcurve"><points><pt>0,0</pt><pt>1,1</pt></points></load_controller>'
        '</LoadData><Output><plotfile type="febio"><var type="displacement"/></plotfile></Output>')  # fmt: skip


def run(folder: Path, text: str) -> tuple[np.ndarray, str]:
    """Displacements (time, node, 3) and the log."""
    (folder / "m.feb").write_text(text)
    result = febkit.solve(folder / "m.feb", folder / "m.xplt", folder / "m.log")
    assert result.converged, result.reason
    with febkit.open_results(folder / "m.xplt") as ds:
        return ds.displacement.values.astype(float), (folder / "m.log").read_text()


def test_two_trusses_snap_through_as_in_febio(tmp_path: Path) -> None:
    """The load falls, turns round and rises again while the middle goes down through its supports."""
    u, log = run(tmp_path, TRUSSES)
    w = u[1:, 1, 2]
    found = np.array([float(x) for x in re.findall(r"arc-length factor    : (\S+)", log)])
    z, rest = RISE + w, np.sqrt(1.0 + RISE**2)
    long = np.sqrt(1.0 + z**2)
    factor = -2.0 * E * AREA * rest * np.log(long / rest) / long * z / long / LOAD  # force E A L log(l / L) / l
    np.testing.assert_allclose(found, factor, rtol=2e-5, atol=2e-6)  # of displacements in single precision
    assert (np.diff(found) < 0).sum() == 9 and found.min() < -0.15
    steps = np.diff(u[:, 1, 2])
    np.testing.assert_allclose(steps, steps[0], rtol=1e-5)
    febio = {1: (-0.0265149009, 0.0821631), 4: (-0.1060596034, 0.144508), 12: (-0.3181788325, -0.150661),
             15: (-0.3977235258, -0.00845066), 40: (-1.0605961084, 12.984)}  # fmt: skip
    for k, (displacement, of) in febio.items():
        assert w[k - 1] == pytest.approx(displacement, rel=1e-7) and found[k - 1] == pytest.approx(of, rel=1e-5)


def arch() -> str:
    """Eight elements in a row, raised as a sine of 0.2, pressed from above."""
    top = [(x, y, z + up) for x, z in ((i / 4, 0.2 * np.sin(np.pi * i / 8)) for i in range(9))
           for y, up in ((0, 0), (0.2, 0), (0.2, 0.1), (0, 0.1))]  # fmt: skip
    nodes = "".join(f'<node id="{k}">{x:.10g},{y},{z:.10g}</node>' for k, (x, y, z) in enumerate(top, 1))
    of = [[1, 5, 6, 2, 4, 8, 7, 3]] * 8
    conn = [[q + 4 * k for q in e] for k, e in enumerate(of)]
    elements = "".join(f'<elem id="{k}">{",".join(map(str, e))}</elem>' for k, e in enumerate(conn, 1))
    facets = "".join(f'<quad4 id="{k}">{",".join(map(str, e[4:]))}</quad4>' for k, e in enumerate(conn, 1))
    flat = ",".join(map(str, range(1, 37)))
    return f"""<febio_spec version="4.0"><Module type="solid"/>
<Control>{STATIC}<time_steps>30</time_steps><step_size>0.05</step_size>
{SOLVER.format("<arc_length>1</arc_length>" + FULL)}</Control>
<Material><material id="1" name="m" type="neo-Hookean"><E>1000</E><v>0.3</v></material></Material>
<Mesh><Nodes name="nodes">{nodes}</Nodes><Elements type="hex8" name="P">{elements}</Elements>
<NodeSet name="ends">1,2,3,4,33,34,35,36</NodeSet><NodeSet name="flat">{flat}</NodeSet>
<Surface name="top">{facets}</Surface></Mesh>
<MeshDomains><SolidDomain name="P" mat="m"/></MeshDomains>
<Boundary><bc type="zero displacement" node_set="ends"><x_dof>1</x_dof><y_dof>1</y_dof><z_dof>1</z_dof></bc>
<bc type="zero displacement" node_set="flat"><y_dof>1</y_dof></bc></Boundary>
<Loads><surface_load type="pressure" surface="top"><pressure>5</pressure></surface_load></Loads>
<Output><plotfile type="febio"><var type="displacement"/></plotfile></Output></febio_spec>"""


def test_an_arch_under_pressure_takes_febio_s_iterations(tmp_path: Path) -> None:
    """The load follows its surface."""
    u, log = run(tmp_path, arch())
    febio = [-0.0777231157, -0.1569259763, -0.3121492565, -0.4559610188]
    np.testing.assert_allclose(u[[5, 10, 20, 30], 16, 2], febio, rtol=1e-7)
    assert re.search(r"equilibrium iterations \.+ : 179\n", log) and re.search(r"evaluations \.+ : 209\n", log)


def test_a_step_that_finds_no_point_is_tried_at_half_its_length() -> None:
    """The residual alone leads three radii away, the load at right angles to it."""
    newton = SimpleNamespace(full=True, options=NewtonOptions(), increment=np.zeros(2), system=SimpleNamespace())
    arc = ArcLength(newton)  # type: ignore[arg-type]
    arc.radius, before = 1.0, (0.5, 1.0, np.ones(2))
    with pytest.raises(NotConverged, match="half of it is tried"):
        arc._next(np.array([3.0, 0.0]), np.array([0.0, 1.0]), 1.0)
    arc.restore(before)
    assert (arc.factor, arc.radius) == (0.5, 0.5)
    newton.increment = np.array([0.0, 0.3])
    assert arc._next(np.array([0.3, 0.0]), np.array([0.0, 1.0]), 1.0) == pytest.approx(0.1)  # not -0.7: it turns less


@pytest.mark.parametrize(("log_solve", "iterations"), [(0, [4, 5, 4, 4, 4, 4, 4, 4]), (1, [4, 4, 3, 3, 3, 3, 3, 3])])
def test_logarithms_of_residuals_save_febio_s_iterations(
    tmp_path: Path, log_solve: int, iterations: list[int]
) -> None:
    """Displacements are those without."""
    control = EIGHT + SOLVER.format(f"<logSolve>{log_solve}</logSolve>{FULL}")
    u, log = run(tmp_path, cube.text(HOLMES, control=control, more=PULL))
    assert [int(n) for n in re.findall(r"number of iterations   : (\d+)", log)] == iterations
    febio = [0.1734244972, 0.2727063000, 0.3334827423, 0.3760781586, 0.4085047245, 0.4345245957]
    np.testing.assert_allclose(u[1:7, 6, 2], febio, rtol=1e-7)


@pytest.mark.parametrize(
    ("control", "said"),
    [
        (EIGHT + "<analysis>DYNAMIC</analysis><solver><arc_length>1</arc_length></solver>", "in a dynamic analysis"),
        (EIGHT + "<solver><arc_length>1</arc_length><logSolve>1</logSolve></solver>", "<logSolve> with <arc_length>"),
        (EIGHT + "<solver><arc_length>2</arc_length></solver>", "arc_length"),
    ],
)
def test_what_does_not_go_together_is_refused(tmp_path: Path, control: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        febkit.solve(cube.read(tmp_path, cube.text(HOLMES, control=control, more=PULL)))


def test_a_biphasic_model_has_no_arc_length(tmp_path: Path) -> None:
    text = cube.text(HOLMES, control=EIGHT + "<solver><arc_length>1</arc_length></solver>", more="")
    with pytest.raises(InputError, match='outside of <Module type="solid">'):
        febkit.solve(cube.read(tmp_path, text.replace('<Module type="solid"/>', '<Module type="biphasic"/>')))
