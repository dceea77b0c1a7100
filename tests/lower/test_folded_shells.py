"""Shells that are bent more sharply than they are thin: FEBio solves them, and so does febkit, with a warning."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import febkit

DECK = """<?xml version="1.0"?>
<febio_spec version="4.0">
<Module type="solid"/>
<Control><analysis>STATIC</analysis><time_steps>1</time_steps><step_size>1</step_size>
<solver type="solid"><dtol>1e-9</dtol><etol>1e-16</etol><qn_method type="BFGS"><max_ups>0</max_ups></qn_method></solver>
</Control>
<Material><material id="1" name="m" type="neo-Hookean"><density>1</density><E>10</E><v>0.3</v></material></Material>
<Mesh>
<Nodes name="all">
<node id="1">-1,0,0</node><node id="2">-0.3,0,0</node><node id="3">0,0,0.3</node><node id="4">0.3,0,0</node>
<node id="5">1,0,0</node><node id="6">-1,1,0</node><node id="7">-0.3,1,0</node><node id="8">0,1,0.3</node>
<node id="9">0.3,1,0</node><node id="10">1,1,0</node>
</Nodes>
<Elements type="quad4" name="sheet"><elem id="1">1,2,7,6</elem><elem id="2">2,3,8,7</elem><elem id="3">3,4,9,8</elem>
<elem id="4">4,5,10,9</elem></Elements>
<NodeSet name="held">1,6</NodeSet><NodeSet name="drawn">5,10</NodeSet>
</Mesh>
<MeshDomains><ShellDomain name="sheet" mat="m"><shell_thickness>THICK</shell_thickness></ShellDomain></MeshDomains>
<Boundary>
<bc node_set="held" type="zero displacement"><x_dof>1</x_dof><y_dof>1</y_dof><z_dof>1</z_dof></bc>
<bc node_set="held" type="zero shell displacement"><sx_dof>1</sx_dof><sy_dof>1</sy_dof><sz_dof>1</sz_dof></bc>
<bc node_set="drawn" type="zero displacement"><x_dof>0</x_dof><y_dof>1</y_dof><z_dof>1</z_dof></bc>
<bc node_set="drawn" type="prescribed displacement"><dof>x</dof><value>0.01</value></bc>
</Boundary>
</febio_spec>
"""
# displacements of nodes 2 to 4 of FEBio 4.11's own run, by thickness
FEBIO = {
    "1.2": [
        [0.00226711665936, 0.000534498387035, 0.0010079404801], [0.00366088113677, 0.000591986651424, 0.00070847880523],
        [0.00444748689704, 0.00113675021822, 0.000860749074331],
    ],
    "2": [
        [0.00276892156717, 0.00066069131779, 0.000667378960384],
        [0.00466348919363, 0.000794631485012, -0.000280748971068],
        [0.00509522125612, 0.00112441736711, -0.000491430340586],
    ],
}  # fmt: skip


@pytest.mark.parametrize("thick", FEBIO)
def test_folded_shells_are_solved_as_in_febio(tmp_path: Path, thick: str) -> None:
    path, said = tmp_path / "sheet.feb", []
    path.write_text(DECK.replace("THICK", thick))
    result = febkit.solve(path, warn=said.append)
    assert result.converged
    np.testing.assert_allclose(result.state.u[1:4], FEBIO[thick], rtol=1e-8)
    folded = [m for m in said if "folded over" in m]
    assert len(folded) == (thick == "2")
    assert all("2 of 4 shell elements" in m and "the first is 2" in m for m in folded)
