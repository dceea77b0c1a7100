"""Loads and load controllers beside FEBio 4.11: a block of one element, its bottom held."""

from __future__ import annotations

import numpy as np
import pytest

import febkit
from febkit.model import InputError

X = [(0.1, 0, 0.2), (1.1, 0, 0.2), (1.1, 1.2, 0.2), (0.1, 1.2, 0.2)]
FACETS = ("1,4,3,2", "5,6,7,8", "1,2,6,5", "2,3,7,6", "3,4,8,7", "4,1,5,8")
DECK = """<febio_spec version="4.0"><Module type="solid"/><Control><analysis>STATIC</analysis><time_steps>5</time_steps>
<step_size>0.2</step_size><solver type="solid"><symmetric_stiffness>0</symmetric_stiffness><dtol>1e-9</dtol>
<etol>1e-15</etol><rtol>0</rtol><max_refs>50</max_refs><qn_method type="BFGS"><max_ups>0</max_ups></qn_method></solver>
</Control><Material><material id="1" name="m" type="neo-Hookean"><density>0.7</density><E>3</E><v>0.2</v></material>
</Material><Mesh><Nodes name="N">{nodes}</Nodes><Elements type="hex8" name="p"><elem id="1">1,2,3,4,5,6,7,8</elem>
</Elements><NodeSet name="b">1,2,3,4</NodeSet><Surface name="s">{facets}</Surface>
<Surface name="t"><quad4 id="1">5,6,7,8</quad4>
</Surface></Mesh><MeshDomains><SolidDomain name="p" mat="m"/></MeshDomains><Boundary>
<bc type="zero displacement" node_set="b"><x_dof>1</x_dof><y_dof>1</y_dof><z_dof>1</z_dof></bc></Boundary>
<Loads>{loads}</Loads><LoadData><load_controller id="1" type={controller}</load_controller></LoadData></febio_spec>"""
RAMP = '"loadcurve"><points><pt>0,0</pt><pt>1,1</pt></points>'
PULL = '<surface_load type="traction" surface="t"><scale lc="1">1</scale><traction>0.1,0.05,0.4</traction>'
PULL += "</surface_load>"
GAS = '<surface_load type="ideal gas pressure" surface="s"><P0>0.3</P0></surface_load>'
WAVE = '"math-interval"><math>sin(3*t)</math><interval>{},0.5</interval><left_extend>{}</left_extend>'
WAVE += "<right_extend>{}</right_extend>"
PID = '"PID" name="c"><var>fem.mesh.node[6].position.z</var><target>1.5</target><Kp>0.8</Kp><Ki>0.6</Ki><Kd>0.05</Kd>'
CASES = {  # loads, controller, displacement of node 7 in FEBio
    "gas": (GAS + PULL, RAMP, (0.15654364, 0.09164194, 0.13567741)),
    "axial": (
        '<body_load type="axial force"><scale lc="1">0.8</scale><p>1.5</p><c>0,0.2,0.1</c>'
        '<axis>0.1,0.2,1</axis></body_load>',
        RAMP, (-0.14631869, -0.076935053, 0.094368592)),
    "radial": (
        '<body_load type="radial force"><p>1.5</p><c>0,0.2,0.1</c><sx lc="1">0.5</sx><sy lc="1">0.7</sy>'
        '<sz lc="1">0.4</sz></body_load>', RAMP, (-0.18124822, -0.16129735, 0.085400626)),
    "pressure Robin": (
        PULL + '<surface_load type="pressure Robin BC" surface="t"><spring_eps>0.8</spring_eps></surface_load>',
        RAMP, (0.092703998, 0.038194418, 0.039523959)),
    "traction Robin": (
        PULL + '<surface_load type="traction Robin BC" surface="t"><spring_eps>0.8</spring_eps></surface_load>',
        RAMP, (0.046987712, 0.016089424, 0.068894669)),
    "PID": (PULL, PID, (0.046364315, 0.018505996, 0.017431399)),
    "zero, repeat": (PULL, WAVE.format(0.1, "zero", "repeat"), (0.062086586, 0.024632743, 0.027022082)),
    "repeat, constant": (PULL, WAVE.format(0.3, "repeat", "constant"), (0.097187608, 0.03789426, 0.057799492)),
}  # fmt: skip


def deck(loads: str, controller: str) -> str:
    points = [*X, *((x, y, 1.2) for x, y, _ in X)]
    nodes = "".join(f'<node id="{k}">{x},{y},{z}</node>' for k, (x, y, z) in enumerate(points, 1))
    facets = "".join(f'<quad4 id="{k}">{f}</quad4>' for k, f in enumerate(FACETS, 1))
    return DECK.format(nodes=nodes, facets=facets, loads=loads, controller=controller)


@pytest.mark.parametrize("name", CASES)
def test_displacements_are_febios(name, tmp_path):
    loads, controller, u = CASES[name]
    (tmp_path / "block.feb").write_text(deck(loads, controller))
    result = febkit.solve(tmp_path / "block.feb")
    assert result.converged, result.reason
    np.testing.assert_allclose(result.state.u[6], u, rtol=1e-6)


AZIMUTH = '<constraint type="azimuth constraint" node_set="z"><penalty>3</penalty>{}</constraint>'
CORNERS = [(0.3, 0.3), (0.8, 0.3), (0.8, 0.7), (0.3, 0.7)]
CONSTRAINTS = {  # constraints, displacements of nodes in FEBio
    "azimuth": (AZIMUTH.format(""), {7: (0.07058873, 0.049922388, 0.073102608)}),
    "azimuth, augmented": (
        AZIMUTH.format("<laugon>AUGLAG</laugon><augtol>0.01</augtol>"), {7: (0.054705836, 0.059561029, 0.078768477)},
    ),
    "point": (
        "".join(f'<constraint type="point"><penalty>30</penalty><node>{k}</node></constraint>' for k in range(9, 17)),
        {7: (0.092321403, 0.033294648, 0.053856555), 15: (0.070084408, 0.03116191, 0.067242734)},
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", CONSTRAINTS)
def test_constraints_of_nodes_are_febios(name, tmp_path):
    """Of two nodes above; of a smaller block within, each node of which stays where it is in the larger one."""
    constraints, nodes = CONSTRAINTS[name]
    text = deck(PULL, RAMP).replace("<LoadData>", f"<Constraints>{constraints}</Constraints><LoadData>")
    text = text.replace("<NodeSet", '<NodeSet name="z">6,7</NodeSet><NodeSet', 1)
    if 15 in nodes:
        points = enumerate(((x, y, z) for z in (0.4, 0.9) for x, y in CORNERS), 9)
        within = "".join(f'<node id="{k}">{x},{y},{z}</node>' for k, (x, y, z) in points)
        text = text.replace("</Nodes>", f"{within}</Nodes>")
        own = '<Elements type="hex8" name="q"><elem id="2">9,10,11,12,13,14,15,16</elem></Elements>'
        text = text.replace("</Elements>", f"</Elements>{own}")
        text = text.replace("</MeshDomains>", '<SolidDomain name="q" mat="m"/></MeshDomains>')
    (tmp_path / "block.feb").write_text(text)
    result = febkit.solve(tmp_path / "block.feb")
    assert result.converged, result.reason
    for node, u in nodes.items():
        np.testing.assert_allclose(result.state.u[node - 1], u, rtol=1e-6)


def test_a_controller_by_feedback_is_written(tmp_path):
    (tmp_path / "block.feb").write_text(deck(PULL, PID))
    data = febkit.read(tmp_path / "block.feb").solve(variables=["pid controller"]).dataset["pid_controller"]
    measured, error, output = data.values.T
    assert list(data.coords["pid_controller_item"].values) == ["measurement", "error", "output"]
    np.testing.assert_allclose(error, 1.5 - measured, rtol=1e-6)
    np.testing.assert_allclose(output[-1], 0.40069887, rtol=1e-6)  # FEBio's


def test_an_interval_must_grow(tmp_path):
    (tmp_path / "block.feb").write_text(deck(PULL, WAVE.format(0.7, "zero", "zero")))
    with pytest.raises(InputError, match=r"block\.feb:\d+: <interval> must grow, not 0\.7,0\.5"):
        febkit.solve(tmp_path / "block.feb")
