"""Loads outside <Step> go by the analysis of the step that they act in."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from febkit import read, solve

LOADS = """<Loads><surface_load type="fluidflux" surface="top"><flux>-0.01</flux><mixture>1</mixture>
</surface_load></Loads>"""
MODEL = """<?xml version="1.0"?>
<febio_spec version="4.0"><Module type="biphasic"/>
<Material><material id="1" name="m" type="biphasic"><phi0>0.2</phi0>
<solid type="neo-Hookean"><E>1</E><v>0</v></solid>
<permeability type="perm-const-iso"><perm>0.1</perm></permeability></material></Material>
<Mesh><Nodes name="n"><node id="1">0,0,0</node><node id="2">1,0,0</node><node id="3">1,1,0</node>
<node id="4">0,1,0</node><node id="5">0,0,1</node><node id="6">1,0,1</node><node id="7">1,1,1</node>
<node id="8">0,1,1</node></Nodes>
<Elements type="hex8" name="P"><elem id="1">1,2,3,4,5,6,7,8</elem></Elements>
<Surface name="top"><quad4 id="1">5,6,7,8</quad4></Surface>
<NodeSet name="low">1,2,3,4</NodeSet><NodeSet name="high">5,6,7,8</NodeSet></Mesh>
<MeshDomains><SolidDomain name="P" mat="m"/></MeshDomains>
<Boundary><bc type="zero displacement" node_set="low"><x_dof>1</x_dof><y_dof>1</y_dof><z_dof>1</z_dof></bc>
<bc type="zero displacement" node_set="high"><x_dof>1</x_dof><y_dof>1</y_dof></bc>
<bc type="zero fluid pressure" node_set="low"/>
<bc type="prescribed displacement" node_set="high"><dof>z</dof><value lc="1">-0.2</value></bc></Boundary>
{outside}<Step><step id="1"><Control><analysis>{analysis}</analysis><time_steps>1</time_steps><step_size>0.5</step_size>
</Control>{inside}</step></Step>
<LoadData><load_controller id="1" type="loadcurve"><points><pt>0,0</pt><pt>1,1</pt></points>
</load_controller></LoadData>
</febio_spec>"""


def _pressure(folder: Path, analysis: str, outside: str = "", inside: str = "") -> np.ndarray:
    path = folder / "m.feb"
    path.write_text(MODEL.format(analysis=analysis, outside=outside, inside=inside))
    result = solve(read(path))
    assert result.converged, result.reason
    return result.state.p


@pytest.mark.parametrize(("analysis", "febio"), [("STEADY-STATE", 0.09), ("TRANSIENT", -0.810158)])
def test_a_flux_of_the_mixture_counts_the_motion_where_there_are_rates(
    tmp_path: Path, analysis: str, febio: float
) -> None:
    """The pressure under the flux by FEBio 4.11, which takes the loads outside <Step>."""
    outside, inside = _pressure(tmp_path, analysis, outside=LOADS), _pressure(tmp_path, analysis, inside=LOADS)
    np.testing.assert_array_equal(outside, inside)
    np.testing.assert_allclose(outside[4:], febio, rtol=1e-3)
