"""<mixed_formulation>: pressures of a lower order than displacements."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from febkit.lower import lower, midnodes
from febkit.model import UnsupportedError
from febkit.solver.elements import get
from febkit.solver.run import run
from helpers import cube

SOLID = """<material id="1" name="m" type="biphasic"><phi0>0.2</phi0>
<solid type="neo-Hookean"><E>1</E><v>0.2</v></solid>
<permeability type="perm-Holmes-Mow"><perm>0.3</perm><M>1.5</M><alpha>2</alpha></permeability></material>"""
CONTROL = """<time_steps>2</time_steps><step_size>0.5</step_size><solver type="biphasic"><dtol>1e-8</dtol>
<ptol>1e-8</ptol><etol>1e-14</etol><symmetric_stiffness>0</symmetric_stiffness><mixed_formulation>{}</mixed_formulation></solver>"""
LOAD = """<Loads><surface_load surface="topS" type="traction"><traction>0.05,0,-0.1</traction></surface_load></Loads>"""


def deck(kind: str, mixed: int = 1, module: str = "biphasic") -> str:
    """One element with nodes on its edges, drained and sheared on top."""
    X = (get(kind).natural + 1.0) / 2.0 if kind.startswith("hex") else get(kind).natural
    low, top = (np.flatnonzero(np.abs(X[:, 2] - z) < 1e-9) + 1 for z in (0.0, 1.0))
    text = cube.text(SOLID, control=CONTROL.format(mixed), module=module)
    text = text.replace("STATIC", "TRANSIENT").replace("</Boundary>", (
        f'<bc node_set="top" type="zero fluid pressure"/></Boundary>{LOAD if kind == "hex20" else ""}'
    ))  # fmt: skip
    start, end = text.index("<Nodes"), text.index("</Mesh>")
    mesh = "".join(f'<node id="{k + 1}">{x},{y},{z}</node>' for k, (x, y, z) in enumerate(X.tolist()))
    mesh = f'<Nodes name="all">{mesh}</Nodes><Elements type="{kind}" name="cube"><elem id="1">'
    mesh += ",".join(str(k + 1) for k in range(len(X))) + "</elem></Elements>"
    for name, nodes in (("base", low), ("top", top)):
        mesh += f'<NodeSet name="{name}">{",".join(map(str, nodes))}</NodeSet>'
    if kind == "hex20":
        mesh += '<Surface name="topS"><quad8 id="1">5,6,7,8,13,14,15,16</quad8></Surface>'
    return text[:start] + mesh + text[end:]


def test_answer_of_febio(tmp_path: Path) -> None:
    """Displacements and pressures of the same deck, by FEBio 4.11."""
    result = run(lower(cube.read(tmp_path, deck("hex20"))))
    assert result.converged, result.reason
    some = [5, 16, 17]
    expected = [[0.42032436, -0.00186841, -0.3935189], [0.19836049, 0.01503342, 0.11570407],
                [0.14016208, -0.04568313, -0.20162146]]  # fmt: skip
    np.testing.assert_allclose(result.state.u[some], expected, atol=2e-7)
    p = result.state.p
    assert p is not None
    expected = [-0.0026038, 0.06515866, 0.06515866, 0.0, 0.03127743, -0.0013019, 0.03257933]
    np.testing.assert_allclose(p[[0, 1, 2, 5, 8, 16, 17]], expected, atol=5e-8)


@pytest.mark.parametrize("kind", ["hex20", "hex27", "tet10", "tet15", "penta15", "pyra13"])
def test_pressures_are_those_of_the_linear_element(tmp_path: Path, kind: str) -> None:
    """Interpolated with all nodes, the corners' pressures are as interpolated with the corners alone."""
    (step,) = lower(cube.read(tmp_path, deck(kind))).steps
    e, linear = get(kind), get(midnodes.LINEAR[get(kind).corners])
    assert sorted(c.node for c in step.constraints) == list(range(e.corners, e.nodes))
    corners = np.random.default_rng(4).normal(size=e.corners)
    p = np.concatenate([corners, np.zeros(e.nodes - e.corners)])
    for c in step.constraints:
        p[c.node] = np.dot(np.array(c.values), corners[c.nodes])
    np.testing.assert_allclose(e.N @ p, linear.shape(e.points) @ corners, atol=1e-14)
    slope = np.einsum("gar,a->gr", linear.gradient(e.points), corners)
    np.testing.assert_allclose(np.einsum("gar,a->gr", e.dN, p), slope, atol=1e-13)


def test_elsewhere_it_is_refused_or_means_nothing(tmp_path: Path) -> None:
    with pytest.raises(UnsupportedError, match='<mixed_formulation> in a "multiphasic" model'):
        lower(cube.read(tmp_path, deck("hex20", module="multiphasic")))
    assert not lower(cube.read(tmp_path, deck("hex20", mixed=0))).steps[0].constraints
