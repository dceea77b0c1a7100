"""Materials beside FEBio 4.11: a cube of one element, seven nodes given, the eighth free.

``febio_materials.txt``: a type, what its <material> holds, and FEBio's displacement (3) of the free node and stress
(xx yy zz xy yz xz) at the end, to the plotfile's seven digits.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import febkit

LINES = Path(__file__).with_name("febio_materials.txt").read_text().splitlines()
CASES = {n: (inner.strip(), np.array(v.split(), float)) for n, inner, v in zip(LINES[::3], LINES[1::3], LINES[2::3])}
X = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
GRADIENT = np.array([[0.12, 0.15, 0.0], [0.03, -0.05, 0.1], [0.02, 0.0, 0.08]])
DECK = """<febio_spec version="4.0"><Module type="solid"/><Control><analysis>STATIC</analysis><time_steps>5</time_steps>
<step_size>0.2</step_size><solver type="solid"><dtol>1e-9</dtol><etol>1e-15</etol><rtol>0</rtol><max_refs>50</max_refs>
<qn_method type="BFGS"><max_ups>0</max_ups></qn_method></solver></Control>
<Globals><Constants><T>298</T><R>8.314e-6</R><Fc>0</Fc></Constants></Globals>
<Material><material id="1" name="m" {inner}</material></Material>
<Mesh><Nodes name="N">{nodes}</Nodes><Elements type="hex8" name="p"><elem id="1">1,2,3,4,5,6,7,8</elem></Elements>{sets}
</Mesh><MeshDomains><SolidDomain name="p" mat="m"/></MeshDomains><Boundary>{given}</Boundary>
<LoadData><load_controller id="1" type="loadcurve"><points><pt>0,0</pt><pt>1,1</pt></points></load_controller>
</LoadData>
</febio_spec>"""
GIVEN = '<bc type="prescribed displacement" node_set="n{}"><dof>{}</dof><value lc="1">{:.12g}</value></bc>'


def deck(inner: str) -> str:
    nodes = "".join(f'<node id="{k}">{x},{y},{z}</node>' for k, (x, y, z) in enumerate(X, 1))
    sets = "".join(f'<NodeSet name="n{k}">{k}</NodeSet>' for k in range(1, 8))
    moved = [(k, GRADIENT @ np.array(x)) for k, x in enumerate(X[:7], 1)]
    given = "".join(GIVEN.format(k, d, v) for k, u in moved for d, v in zip("xyz", u))
    return DECK.format(inner=inner, nodes=nodes, sets=sets, given=given)


@pytest.mark.parametrize("name", CASES)
def test_displacement_and_stress_are_febios(name, tmp_path):
    inner, values = CASES[name]
    (tmp_path / "cube.feb").write_text(deck(inner))
    result = febkit.read(tmp_path / "cube.feb").solve(variables=["displacement", "stress"])
    assert result.converged, result.reason
    last = result.dataset.isel(time=-1)
    np.testing.assert_allclose(last["displacement"].values[7], values[:3], rtol=2e-6, atol=2e-8)
    np.testing.assert_allclose(last["stress"].values[0], values[3:], rtol=2e-6, atol=2e-7)
