"""What turns and drives the fluid of a biphasic column, two elements on a wall, and blocks in contact, beside FEBio."""

from __future__ import annotations

import numpy as np
import pytest

import febkit

X = [(x, y, z) for z in (0, 0.5, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
NODES = "".join(f'<node id="{k}">{x},{y},{z}</node>' for k, (x, y, z) in enumerate(X, 1))
DECK = """<febio_spec version="4.0"><Module type="biphasic"/><Globals><Constants><R>8.3e-6</R><T>298</T></Constants>
</Globals><Control><analysis>TRANSIENT</analysis><time_steps>5</time_steps><step_size>0.1</step_size>
<solver type="biphasic"><symmetric_stiffness>0</symmetric_stiffness><dtol>1e-9</dtol><ptol>1e-9</ptol><etol>1e-15</etol>
<rtol>0</rtol><max_refs>50</max_refs><qn_method type="BFGS"><max_ups>0</max_ups></qn_method></solver></Control>
<Material><material id="1" name="m" type="biphasic">{}<phi0>0.2</phi0>
<solid type="neo-Hookean"><E>1</E><v>0.2</v></solid><permeability {}</permeability>
<active_supply type="active-const-supply"><supply>0.4</supply></active_supply></material>
</Material><Mesh><Nodes name="N">{}</Nodes><Elements type="hex8" name="p">
<elem id="1">1,2,3,4,5,6,7,8</elem><elem id="2">5,6,7,8,9,10,11,12</elem></Elements><NodeSet name="b">1,2,3,4</NodeSet>
<NodeSet name="t">9,10,11,12</NodeSet></Mesh><MeshDomains><SolidDomain name="p" mat="m"/></MeshDomains>
<Boundary><bc type="zero displacement" node_set="b">
<x_dof>1</x_dof><y_dof>1</y_dof><z_dof>1</z_dof></bc><bc type="zero fluid pressure" node_set="t"/></Boundary>
</febio_spec>"""
BLOCKS = """<febio_spec version="4.0"><Module type="biphasic"/><Control><analysis>TRANSIENT</analysis>
<time_steps>6</time_steps><step_size>0.1</step_size><solver type="biphasic">
<symmetric_stiffness>0</symmetric_stiffness><dtol>0.1</dtol><ptol>0.1</ptol><etol>0.1</etol><rtol>0</rtol>
<max_refs>50</max_refs><qn_method type="BFGS"><max_ups>0</max_ups></qn_method></solver></Control><Material>
<material id="1" name="m" type="biphasic"><phi0>0.2</phi0><solid type="neo-Hookean"><E>1</E><v>0.2</v></solid>
<permeability type="perm-const-iso"><perm>0.1</perm></permeability></material></Material><Mesh>
<Nodes name="N">{}</Nodes><Elements type="hex8" name="p"><elem id="1">1,2,3,4,5,6,7,8</elem>
<elem id="2">9,10,11,12,13,14,15,16</elem></Elements>
<NodeSet name="b">1,2,3,4</NodeSet><NodeSet name="t">13,14,15,16</NodeSet>
<Surface name="low"><quad4 id="1">5,6,7,8</quad4></Surface>
<Surface name="high"><quad4 id="1">9,12,11,10</quad4></Surface>
<SurfacePair name="c"><primary>high</primary><secondary>low</secondary></SurfacePair></Mesh>
<MeshDomains><SolidDomain name="p" mat="m"/></MeshDomains><Boundary><bc type="zero displacement" node_set="b">
<x_dof>1</x_dof><y_dof>1</y_dof><z_dof>1</z_dof></bc><bc type="zero displacement" node_set="t">
<x_dof>1</x_dof><y_dof>1</y_dof></bc><bc type="prescribed displacement" node_set="t"><dof>z</dof>
<value lc="1">1</value></bc></Boundary><Contact><contact type="sliding-biphasic" surface_pair="c">
<penalty>5</penalty><auto_penalty>1</auto_penalty><pressure_penalty>2</pressure_penalty><two_pass>1</two_pass>
</contact></Contact><LoadData><load_controller id="1" type="loadcurve"><interpolate>LINEAR</interpolate><points>
<pt>0,0</pt><pt>0.2,-0.1</pt><pt>0.3,0.3</pt><pt>0.4,-0.1</pt><pt>0.6,-0.15</pt></points></load_controller></LoadData>
</febio_spec>"""
SQUEEZED = """<febio_spec version="4.0"><Module type="biphasic"/><Control><analysis>{}</analysis><time_steps>3
</time_steps>
<step_size>0.1</step_size><solver type="biphasic"><symmetric_stiffness>0</symmetric_stiffness><dtol>0.01</dtol>
<ptol>0.1</ptol><etol>0.01</etol><rtol>0</rtol><lstol>0</lstol><max_refs>50</max_refs><qn_method type="BFGS">
<max_ups>0</max_ups>
</qn_method></solver></Control><Material><material id="1" name="m" type="biphasic"><phi0>0.3</phi0>
<solid type="neo-Hookean"><E>1</E><v>0.2</v></solid><permeability {}</permeability></material></Material><Mesh>
<Nodes name="N">{}</Nodes><Elements type="hex8" name="p"><elem id="1">1,2,3,4,5,6,7,8</elem>
<elem id="2">5,6,7,8,9,10,11,12</elem></Elements><NodeSet name="b">1,2,3,4</NodeSet><NodeSet name="t">9,10,11,12
</NodeSet>
<NodeSet name="side">2,3,6,7</NodeSet><NodeSet name="back">1,5</NodeSet></Mesh><MeshDomains>
<SolidDomain name="p" mat="m"/></MeshDomains>
<Boundary><bc type="zero displacement" node_set="b"><x_dof>1</x_dof><y_dof>1</y_dof><z_dof>1</z_dof></bc>
<bc type="prescribed displacement" node_set="t"><dof>z</dof><value lc="1">-0.3</value></bc>
<bc type="zero fluid pressure" node_set="side"/><bc type="prescribed fluid pressure" node_set="back">
<value lc="1">0.4</value></bc>
</Boundary><LoadData>
<load_controller id="1" type="loadcurve"><interpolate>LINEAR</interpolate><points><pt>0,0</pt><pt>0.3,1</pt></points>
</load_controller></LoadData></febio_spec>"""
HOLMES_MOW = 'type="perm-Holmes-Mow"><perm>0.7</perm><M>1.5</M><alpha>2</alpha>'
ORTHOTROPIC = """type="perm-ref-ortho"><perm0>0.1</perm0><perm1>0.4,0.2,0.6</perm1><perm2>0.3,0.2,0.1</perm2>
<M0>0.5</M0><alpha0>1</alpha0><M>0.2,0.3,0.4</M><alpha>1,1,1</alpha>"""
AXES = '<mat_axis type="vector"><a>0.3,0.2,1</a><d>1,0,0</d></mat_axis>'
CASES = {  # axes of the mixture, permeability, displacement of node 7 and pressures of the first nodes in FEBio
    "along x": ("", HOLMES_MOW, (-0.038669579, 0.042571783, 0.063923143), (-0.20485963, 0.17333227)),
    "along an axis": (AXES, HOLMES_MOW, (-0.023624219, -0.018375576, -0.024113884), (-0.26284614, -0.17568824)),
    "by orthotropic permeability": (
        AXES, ORTHOTROPIC, (-0.02906155, -0.023009287, -0.030104665), (-0.30482614, -0.20204735),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_a_momentum_supply_drives_the_fluid(name, tmp_path):
    axes, permeability, u, p = CASES[name]
    (tmp_path / "column.feb").write_text(DECK.format(axes, permeability, NODES))
    result = febkit.solve(tmp_path / "column.feb")
    assert result.converged, result.reason
    np.testing.assert_allclose(result.state.u[6], u, rtol=1e-6)
    np.testing.assert_allclose(result.state.p[:2], p, rtol=1e-6)


def test_blocks_that_meet_again(tmp_path):
    """Pressures of nodes that drained start from where they were when contact was lost, as FEBio's: loose tolerances
    would show other iterates."""
    X = [(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
    X += [(x, y, z) for z in (0.98, 2) for x, y in ((-0.1, -0.2), (1.1, -0.2), (1.1, 1.3), (-0.1, 1.3))]
    nodes = "".join(f'<node id="{k}">{x},{y},{z}</node>' for k, (x, y, z) in enumerate(X, 1))
    (tmp_path / "blocks.feb").write_text(BLOCKS.format(nodes))
    result = febkit.solve(tmp_path / "blocks.feb")
    assert result.converged, result.reason
    np.testing.assert_allclose(result.state.p[[4, 6, 8]], (0.05493241, 0.05603813, 0.082822606), rtol=1e-6)


STEEP = {"Holmes-Mow": 'type="perm-Holmes-Mow"><perm>0.7</perm><M>3</M><alpha>2</alpha>',
         "orthotropic": ORTHOTROPIC.replace("<M0>0.5", "<M0>2").replace("<M>0.2,0.3,0.4", "<M>2,3,4")}  # fmt: skip
ITERATES = {  # iterations, displacement of node 7, pressures of nodes 4, 8 and 9
    ("TRANSIENT", "Holmes-Mow"): (10, (0.093304813, 0.035671812, -0.13030347), (0.31402683, 0.20311795, 0.2159742)),
    ("TRANSIENT", "orthotropic"): (9, (0.090918645, 0.038874425, -0.13622801), (0.2768586, 0.1663397, 0.15001191)),
    ("STEADY-STATE", "Holmes-Mow"): (12, (0.068806879, 0.038246401, -0.12819277), (0.12090739, 0.11931704, 0.22119828)),
    ("STEADY-STATE", "orthotropic"): (9, (0.059770897, 0.042538662, -0.13399419), (0.03991422, 0.04574229, 0.10844937)),
}  # fmt: skip


@pytest.mark.parametrize(("analysis", "permeability"), ITERATES)
def test_iterates_where_permeability_depends_on_strain(analysis, permeability, tmp_path):
    """FEBio's tangent, which exchanges two indices, and so FEBio's iterates: tolerances are loose."""
    X = [(x, y, z) for z in (0, 0.5, 1.2) for x, y in ((0, 0), (1, 0), (1.1, 1), (0, 1))]
    nodes = "".join(f'<node id="{k}">{x},{y},{z}</node>' for k, (x, y, z) in enumerate(X, 1))
    (tmp_path / "squeezed.feb").write_text(SQUEEZED.format(analysis, STEEP[permeability], nodes))
    result = febkit.solve(tmp_path / "squeezed.feb")
    assert result.converged, result.reason
    iterations, u, p = ITERATES[analysis, permeability]
    assert result.totals.iterations == iterations
    np.testing.assert_allclose(result.state.u[6], u, rtol=1e-6)
    np.testing.assert_allclose(result.state.p[[3, 7, 8]], p, rtol=1e-6)
