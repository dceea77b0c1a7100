"""Bent tetrahedra of 10 and 20 nodes beside FEBio 4.11."""

from __future__ import annotations

import numpy as np
import pytest

import febkit
from febkit.solver import elements

DECK = """<febio_spec version="4.0"><Module type="solid"/><Control><analysis>STATIC</analysis><time_steps>2</time_steps>
<step_size>0.5</step_size><solver type="solid"><dtol>1e-9</dtol><etol>1e-14</etol><rtol>0</rtol><max_refs>50</max_refs>
<qn_method type="BFGS"><max_ups>0</max_ups></qn_method></solver></Control><Material>{material}</Material><Mesh>
<Nodes name="N">{nodes}</Nodes><Elements type="{kind}" name="p"><elem id="1">{conn}</elem></Elements>
<NodeSet name="b">{base}</NodeSet><NodeSet name="t">{top}</NodeSet>
<Surface name="s"><tri10 id="1">1,2,4,5,6,13,14,11,12,17</tri10></Surface></Mesh>
<MeshDomains><SolidDomain name="p" mat="m"/></MeshDomains>
<Boundary><bc type="zero displacement" node_set="b"><x_dof>1</x_dof><y_dof>1</y_dof><z_dof>1</z_dof></bc></Boundary>
<Loads>{load}</Loads><LoadData><load_controller id="1" type="loadcurve"><interpolate>LINEAR</interpolate><points>
<pt>0,0</pt><pt>1,1</pt></points></load_controller></LoadData></febio_spec>"""
NEO = '<material id="1" name="m" type="neo-Hookean"><E>1</E><v>0.3</v></material>'
MOONEY = '<material id="1" name="m" type="Mooney-Rivlin"><c1>1</c1><c2>0.1</c2><k>50</k></material>'
PULL = '<nodal_load type="nodal_load" node_set="t"><dof>x</dof><scale lc="1">0.002</scale></nodal_load>'
PRESSURE = '<surface_load type="pressure" surface="s"><pressure lc="1">0.01</pressure></surface_load>'
NODES = {"tet10": [1, 2, 3, 4, 5, 7, 9, 11, 13, 15], "tet20": [*range(1, 21)]}  # of a tet20
TOP = {"tet10": "4,11,13,15", "tet20": "4,11,16,17"}
CASES = {  # element, material, load, iterations, displacement of node 4 in FEBio
    "tet20": ("tet20", NEO, PULL, 13, (0.797346, 0.1328585, -0.08287973)),
    "tet20 under pressure on a tri10": ("tet20", NEO, PRESSURE, 14, (0.010811197, 0.1425121, 0.019686304)),
    "uncoupled tet20": ("tet20", MOONEY, PULL, 8, (0.11356949, 0.026010301, 0.027225384)),
    "uncoupled tet10, which FEBio gives no element pressure": (
        "tet10", MOONEY, PULL, 6, (0.01687422, 0.000786522, 0.0014762377),
    ),
}  # fmt: skip


@pytest.mark.filterwarnings("ignore:.*belong to no element")
@pytest.mark.parametrize("name", CASES)
def test_a_tetrahedron(name, tmp_path):
    kind, material, load, iterations, expected = CASES[name]
    r = elements.get("tet20").natural
    X = r @ np.array([[1.1, 0.1, 0], [0.05, 0.9, 0.1], [0, 0.2, 1.2]]).T
    X += 0.02 * np.column_stack([r[:, 1] * r[:, 2], r[:, 0] ** 2, r[:, 0] * r[:, 1]])
    used = NODES[kind]
    deck = DECK.format(
        material=material, kind=kind, conn=",".join(map(str, used)), load=load, top=TOP[kind],
        base=",".join(str(k) for k in used if r[k - 1, 2] == 0.0),
        nodes="".join(f'<node id="{k}">{x!r},{y!r},{z!r}</node>' for k, (x, y, z) in enumerate(X.tolist(), 1)),
    )  # fmt: skip
    (tmp_path / "tet.feb").write_text(deck)
    result = febkit.solve(tmp_path / "tet.feb")
    assert result.converged, result.reason
    assert result.totals.iterations == iterations
    np.testing.assert_allclose(result.state.u[3], expected, rtol=1e-6)
