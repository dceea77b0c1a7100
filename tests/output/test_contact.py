"""Contact variables in plotfiles: surface data of both surfaces of a pair."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import febkit

_CUBE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]


def two_cubes(kind: str, more: str = "") -> str:
    """One cube on another, pressed down by 2 %, with sides free to slide: uniaxial stress."""
    nodes = [(x, y, z + up) for up in (0, 1) for x, y, z in _CUBE]
    text = "".join(f'<node id="{k + 1}">{x},{y},{z}</node>' for k, (x, y, z) in enumerate(nodes))
    fixed = {"x": "1,4,5,8,9,12,13,16", "y": "1,2,5,6,9,10,13,14", "z": "1,2,3,4"}
    sets = "".join(f'<NodeSet name="{a}">{ids}</NodeSet>' for a, ids in fixed.items())
    zero = "".join(
        f'<bc node_set="{a}" type="zero displacement">'
        + "".join(f"<{b}_dof>{int(a == b)}</{b}_dof>" for b in "xyz") + "</bc>"
        for a in fixed
    )  # fmt: skip
    variables = "".join(f'<var type="contact {n}"/>' for n in ("gap", "pressure", "traction"))
    return f"""<?xml version="1.0"?>
<febio_spec version="4.0">
<Module type="solid"/>
<Control><analysis>STATIC</analysis><time_steps>1</time_steps><step_size>1</step_size>
<solver type="solid"><dtol>1e-9</dtol></solver></Control>
<Material><material id="1" name="m" type="neo-Hookean"><E>3</E><v>0.2</v></material></Material>
<Mesh><Nodes>{text}</Nodes>
<Elements type="hex8" name="low"><elem id="1">1,2,3,4,5,6,7,8</elem></Elements>
<Elements type="hex8" name="high"><elem id="2">9,10,11,12,13,14,15,16</elem></Elements>
{sets}<NodeSet name="top">13,14,15,16</NodeSet>
<Surface name="under"><quad4 id="1">9,12,11,10</quad4></Surface>
<Surface name="over"><quad4 id="1">5,6,7,8</quad4></Surface>
<SurfacePair name="faces"><primary>under</primary><secondary>over</secondary></SurfacePair></Mesh>
<MeshDomains><SolidDomain name="low" mat="m"/><SolidDomain name="high" mat="m"/></MeshDomains>
<Boundary>{zero}
<bc node_set="top" type="prescribed displacement"><dof>z</dof><value lc="1">-0.02</value></bc></Boundary>
<Contact><contact type="{kind}" surface_pair="faces"><penalty>100</penalty>{more}</contact></Contact>
<LoadData><load_controller id="1" type="loadcurve"><points><pt>0,0</pt><pt>1,1</pt></points></load_controller>
</LoadData>
<Output><plotfile type="febio">{variables}<var type="stress"/><var type="displacement"/></plotfile></Output>
</febio_spec>
"""


@pytest.mark.parametrize("two_pass", [0, 1])
@pytest.mark.parametrize("kind", ["sliding-elastic", "sliding-node-on-facet", "sliding-facet-on-facet"])
def test_the_pressure_balances_the_stress(tmp_path: Path, kind: str, two_pass: int) -> None:
    path = tmp_path / "two.feb"
    path.write_text(two_cubes(kind, f"<two_pass>{two_pass}</two_pass>"))
    result = febkit.solve(febkit.read(path), plotfile=str(tmp_path / "two.xplt"))
    assert result.converged, result.reason
    last = febkit.open_results(tmp_path / "two.xplt").isel(time=-1)
    stress = float(last["stress"].values[0, 2])
    pressure = last["contact_pressure"].values
    assert stress < 0.0
    acting = 2 if two_pass else 1
    # node and facet contacts measure pressures per reference area, which grows by some per mille
    assert pressure[:acting] == pytest.approx(-stress, rel=2e-2)
    assert np.all(pressure[acting:] == 0.0)
    gap = last["contact_gap"].values
    assert gap[0] == pytest.approx(pressure[0] / 100 / acting, rel=1e-3)
    traction = last["contact_traction"].values
    assert np.linalg.norm(traction[0]) == pytest.approx(pressure[0], rel=1e-6)
    up = traction[0, 2] > 0.0  # what pushes the upper cube up; FEBio has the other sign for facets on facets
    assert up == (kind != "sliding-facet-on-facet")


def test_tied_surfaces_have_a_gap_and_a_traction(tmp_path: Path) -> None:
    path = tmp_path / "two.feb"
    path.write_text(two_cubes("tied-elastic"))
    said: list[str] = []
    febkit.solve(febkit.read(path), plotfile=str(tmp_path / "two.xplt"), warn=said.append)
    assert not said
    last = febkit.open_results(tmp_path / "two.xplt").isel(time=-1)
    assert last["contact_traction"].values[0, 2] == pytest.approx(-float(last["stress"].values[0, 2]), rel=2e-2)
    assert last["contact_gap"].values[0] == pytest.approx(last["contact_traction"].values[0, 2] / 100, rel=1e-3)
