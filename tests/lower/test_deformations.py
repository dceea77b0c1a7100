"""Conditions on whole displacements, and values made of maps and of other parameters."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import febkit
from febkit.model import InputError
from febkit.solver.problem import Prescribed, Problem
from helpers import cube

SOLID = '<material id="1" name="m" type="neo-Hookean"><density>1</density><E>{E}</E><v>0.3</v></material>'
RAMP = ('<LoadData><load_controller id="1" type="loadcurve"><interpolate>LINEAR</interpolate>'
        "<points><pt>0,0</pt><pt>1,2</pt></points></load_controller></LoadData>")
TOP = '<Surface name="topS"><quad4 id="1">5,6,7,8</quad4></Surface>'


def problem(folder: Path, bc: str = "", more: str = "", E: str = "<E>1</E>", mesh: str = "") -> Problem:
    text = cube.text(SOLID.replace("<E>{E}</E>", E), more=more + RAMP)
    text = text.replace("</Boundary>", f"{bc}</Boundary>").replace("</Mesh>", f"{TOP}{mesh}</Mesh>")
    return cube.problem(folder, text)


def displacement(p: Problem, t: float) -> np.ndarray:
    """What the prescribed conditions give at their nodes (node, 3), NaN elsewhere."""
    out = np.full((len(p.X), 3), np.nan)
    for c in p.common.conditions:
        if isinstance(c, Prescribed):
            out[c.nodes, c.column] = c.value(t, p.X[c.nodes], np.arange(len(c.nodes)))
    return out


def test_a_deformation_gradient(tmp_path: Path) -> None:
    F = np.array([[1.1, 0.02, 0], [0, 1, 0], [0.05, 0, 0.9]])
    p = problem(tmp_path, '<bc type="prescribed deformation" node_set="top"><scale lc="1">0.5</scale>'
                f'<F>{",".join(map(str, F.ravel()))}</F></bc>')
    assert np.allclose(displacement(p, 0.5)[4:], 0.5 * p.X[4:] @ (F - np.eye(3)).T)
    assert np.isnan(displacement(p, 0.5)[:4]).all()


def test_a_second_order_deformation_counts_from_its_node(tmp_path: Path) -> None:
    F, G = np.diag([1.1, 1.0, 0.9]), np.arange(18) * 0.01
    p = problem(tmp_path, '<bc type="prescribed deformation 2O" node_set="top"><scale lc="1">1</scale>'
                "<reference>6</reference>"
                f'<F>{",".join(map(str, F.ravel()))}</F><G>{",".join(map(str, G))}</G></bc>')
    full = np.zeros((3, 3, 3))
    for i in range(3):
        for k, (a, b) in enumerate(((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))):
            full[i, a, b] = full[i, b, a] = G[6 * i + k]
    X, X1 = p.X[4:], p.X[6]
    dyads = np.einsum("na,nb->nab", X, X) - np.outer(X1, X1)
    u = (X - X1) @ (F - np.eye(3)).T + 0.5 * np.einsum("iab,nab->ni", full, dyads)
    assert np.allclose(displacement(p, 1.0)[4:], 2.0 * u)
    with pytest.raises(InputError, match="place of a node, 0 to 7, not 8"):
        problem(tmp_path, '<bc type="prescribed deformation 2O" node_set="top"><reference>8</reference></bc>')


def test_along_the_normals_of_a_surface(tmp_path: Path) -> None:
    p = problem(tmp_path, '<bc type="normal displacement" surface="topS"><scale lc="1">-0.05</scale></bc>')
    assert np.allclose(displacement(p, 1.0)[4:], [0, 0, -0.1])
    p = problem(tmp_path, '<bc type="normal displacement" surface="topS"><scale>1</scale>'
                "<surface_hint>1</surface_hint></bc>")
    assert np.allclose(displacement(p, 1.0)[4:], -p.X[4:] / np.linalg.norm(p.X[4:], axis=1)[:, None])


def test_a_rigid_motion(tmp_path: Path) -> None:
    quarter = np.pi / 4
    p = problem(tmp_path, '<bc type="rigid deformation" node_set="top"><pos>0,0,1</pos>'
                f'<rot lc="1">0,0,{quarter}</rot></bc>')
    u = displacement(p, 1.0)[4:]
    x, y, _ = p.X[4:].T
    assert np.allclose(u + p.X[4:], np.stack([-y, x, np.ones(4)], axis=1))  # a quarter turn around z


def test_formulas_take_element_maps_and_parameters_beside_them(tmp_path: Path) -> None:
    more = '<MeshData><ElementData name="Emap" elem_set="cube"><e lid="1">3</e></ElementData></MeshData>'
    p = problem(tmp_path, more=more, E='<E type="math">2*Emap + 10*v + Z</E>')
    value = p.blocks[0].solid.E
    got = value(0.0, np.array([[0, 0, 0], [0, 0, 1.0]]), np.array([0, 0]))
    assert np.allclose(got, [9.0, 10.0]) and not value.constant and value.steady
    with pytest.raises(InputError, match="unknown variable Emapp; did you mean"):
        problem(tmp_path, more=more, E='<E type="math">2*Emapp</E>')
    with pytest.raises(InputError, match="refers to itself"):
        problem(tmp_path, E='<E type="math">2*E</E>')


def test_formulas_take_node_maps_on_conditions(tmp_path: Path) -> None:
    more = ('<MeshData><NodeData name="uz" node_set="top"><node lid="1">-0.1</node><node lid="2">-0.2</node>'
            '<node lid="3">-0.3</node><node lid="4">-0.4</node></NodeData></MeshData>')
    p = problem(tmp_path, '<bc type="prescribed displacement" node_set="top"><dof>z</dof>'
                '<value lc="1" type="math">0.5*uz + 0.02*X</value></bc>', more)
    assert np.allclose(displacement(p, 1.0)[4:, 2], 2 * (0.5 * np.array([-0.1, -0.2, -0.3, -0.4]) + 0.02 * p.X[4:, 0]))


def test_formulas_take_node_maps_on_nodal_loads(tmp_path: Path) -> None:
    """By the places of the nodes in the set, as decks of febio-python have them; FEBio gives the same displacements."""
    more = ('<MeshData><NodeData name="Fx" node_set="top"><node lid="1">1</node><node lid="2">2</node>'
            '<node lid="3">3</node><node lid="4">4</node></NodeData></MeshData><Loads>{}</Loads>')
    load = '<nodal_load type="nodal_load" node_set="top"><dof>x</dof><scale lc="1"{}</scale></nodal_load>'
    one, two = load.format(">1*Fx"), load.format(' type="map">Fx')
    p = problem(tmp_path, more=more.format(one + two))
    for force in p.common.loads:
        assert np.allclose(force.scale(1.0, p.X[4:], np.arange(4)), [2, 4, 6, 8])


def test_maps_of_facets_are_pressures_in_the_order_of_the_file(tmp_path: Path) -> None:
    """Facets of two kinds: the map's rows follow their ids, not their kinds."""
    surface = ('<Surface name="s"><quad4 id="1">5,6,7,8</quad4><tri3 id="2">1,2,3</tri3>'
               '<quad4 id="3">1,2,6,5</quad4></Surface>')
    more = ('<Loads><surface_load type="pressure" surface="s"><pressure lc="1" type="map">pm</pressure></surface_load>'
            '</Loads><MeshData><SurfaceData name="pm" surface="s"><face lid="1">1</face><face lid="2">2</face>'
            '<face lid="3">3</face></SurfaceData></MeshData>')
    load = problem(tmp_path, more=more, mesh=surface).common.loads[0]
    found = {p.conn.shape[1]: load.pressure(0.5, p.points, p.items) for p in load.surface}
    assert np.allclose(found[4], np.repeat([1.0, 3.0], len(found[4]) // 2)) and np.allclose(found[3], 2.0)
    with pytest.raises(InputError, match='map "pm" must have one number for each of the 3 facets of "s"'):
        problem(tmp_path, more=more.replace('<face lid="2">2</face>', ""), mesh=surface)


def test_a_value_of_version_25_stands_in_for_the_scale_and_keeps_its_curve(tmp_path: Path) -> None:
    path = tmp_path / "old.feb"
    nodes = "".join(f'<node id="{k + 1}">{x},{y},{z}</node>' for k, (x, y, z) in enumerate(cube._NODES))
    path.write_text("""<febio_spec version="2.5"><Module type="solid"/>
<Control><time_steps>1</time_steps><step_size>1</step_size><analysis type="static"/></Control>
<Material><material id="1" name="m" type="neo-Hookean"><E>1</E><v>0.3</v></material></Material>
<Geometry><Nodes>""" + nodes + """</Nodes>
<Elements type="hex8" mat="1" name="P"><elem id="1">1,2,3,4,5,6,7,8</elem></Elements>
<NodeSet name="top"><node id="5"/><node id="6"/><node id="7"/><node id="8"/></NodeSet></Geometry>
<MeshData><NodeData name="uz" node_set="top"><node lid="1">1</node><node lid="2">2</node><node lid="3">3</node>
<node lid="4">4</node></NodeData></MeshData>
<Boundary><prescribe bc="z" node_set="top"><scale lc="1">1.0</scale><value node_data="uz"/></prescribe>
<prescribe bc="x" node_set="top"><scale lc="1">1.0</scale><value>0.3</value></prescribe></Boundary>
<LoadData><loadcurve id="1" type="linear"><point>0,0</point><point>1,2</point></loadcurve></LoadData></febio_spec>""")
    from febkit.lower import lower

    u = displacement(lower(febkit.read(path)), 1.0)[4:]
    assert np.allclose(u[:, 2], [2, 4, 6, 8]) and np.allclose(u[:, 0], 0.6)
