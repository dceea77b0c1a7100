"""Initial velocities beside FEBio 4.11: five steps of dynamics."""

from __future__ import annotations

import numpy as np

import febkit

DECK = """<febio_spec version="4.0"><Module type="solid"/><Control><analysis>DYNAMIC</analysis>
<time_steps>5</time_steps><step_size>0.02</step_size><solver type="{solver}">
<symmetric_stiffness>0</symmetric_stiffness><dtol>1e-9</dtol>
<etol>1e-15</etol><rtol>0</rtol><max_refs>50</max_refs><qn_method type="BFGS"><max_ups>0</max_ups></qn_method></solver>
</Control><Material><material id="1" name="m" type="neo-Hookean"><density>0.7</density><E>3</E><v>0.2</v></material>
</Material><Mesh><Nodes name="N">{nodes}</Nodes>{mesh}</Mesh><MeshDomains>{domain}</MeshDomains>{sections}
</febio_spec>"""
PLANE = [(0.1, 0), (1.1, 0), (1.1, 1.2), (0.1, 1.2)]
SOLID = """<Elements type="hex8" name="p"><elem id="1">1,2,3,4,5,6,7,8</elem></Elements>
<NodeSet name="all">1,2,3,4,5,6,7,8</NodeSet>"""
TURNING = """<Initial><ic type="rigid kinematics" node_set="all"><velocity>0.1,0.2,-0.1</velocity>
<angular_velocity>0.5,1,-2</angular_velocity><center_of_rotation>0.3,0.2,0.1</center_of_rotation></ic></Initial>"""
SHELL = """<Elements type="quad4" name="p"><elem id="1">1,2,3,4</elem></Elements><NodeSet name="b">1,4</NodeSet>
<NodeSet name="t">2,3</NodeSet>"""
THICK = '<ShellDomain name="p" mat="m"><shell_thickness>0.2</shell_thickness></ShellDomain>'
STRUCK = """<Boundary><bc type="zero displacement" node_set="b"><x_dof>1</x_dof><y_dof>1</y_dof><z_dof>1</z_dof></bc>
<bc type="zero shell displacement" node_set="b"><sx_dof>1</sx_dof><sy_dof>1</sy_dof><sz_dof>1</sz_dof></bc></Boundary>
<Initial><ic type="shell velocity" node_set="t"><value>0.3,0,1.0</value></ic></Initial>"""


def solved(tmp_path, X, **parts):
    nodes = "".join(f'<node id="{k}">{x},{y},{z}</node>' for k, (x, y, z) in enumerate(X, 1))
    (tmp_path / "moving.feb").write_text(DECK.format(nodes=nodes, **parts))
    result = febkit.solve(tmp_path / "moving.feb")
    assert result.converged, result.reason
    return result.state.u


def test_a_block_set_turning(tmp_path):
    """Also by FEBio's former solver of this kind."""
    domain, X = '<SolidDomain name="p" mat="m"/>', [(x, y, z) for z in (0.2, 1.2) for x, y in PLANE]
    for solver in ("solid", "solid_old"):
        u = solved(tmp_path, X, solver=solver, mesh=SOLID, domain=domain, sections=TURNING)
        np.testing.assert_allclose(u[6], (0.31904122, -0.19560352, -0.040645756), rtol=1e-6)


def test_a_shell_struck_on_its_back(tmp_path):
    X = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
    u = solved(tmp_path, X, solver="solid", mesh=SHELL, domain=THICK, sections=STRUCK)
    np.testing.assert_allclose(u[2], (0.0051755738, 0.0025642177, 0.056335993), rtol=1e-6)
    np.testing.assert_allclose(u[6], (0.02542886, 0.0022145926, 0.04405731), rtol=1e-6)  # of the back
