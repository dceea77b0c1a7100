"""Two blocks that meet, tied, stuck or sliding in every way: displacements of FEBio 4.11's own runs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import febkit

DECK = """<?xml version="1.0"?>
<febio_spec version="4.0">
<Module type="{module}"/>
<Control><analysis>{analysis}</analysis><time_steps>4</time_steps><step_size>0.25</step_size>
<solver type="{module}"><symmetric_stiffness>non-symmetric</symmetric_stiffness><dtol>1e-9</dtol><etol>1e-18</etol>
<max_refs>50</max_refs><qn_method type="BFGS"><max_ups>0</max_ups></qn_method></solver></Control>
{material}
<Mesh>
<Nodes name="all">{nodes}</Nodes>
<Elements type="hex8" name="low"><elem id="1">1,2,5,4,7,8,11,10</elem><elem id="2">2,3,6,5,8,9,12,11</elem></Elements>
<Elements type="hex8" name="high"><elem id="3">13,14,15,16,17,18,19,20</elem></Elements>
<NodeSet name="bottom">1,2,3,4,5,6</NodeSet><NodeSet name="top">17,18,19,20</NodeSet>
<Surface name="under"><quad4 id="1">13,16,15,14</quad4></Surface>
<Surface name="over"><quad4 id="1">7,8,11,10</quad4><quad4 id="2">8,9,12,11</quad4></Surface>
<SurfacePair name="faces"><primary>under</primary><secondary>over</secondary></SurfacePair>
<Edge name="near"><line2 id="1">13,14</line2></Edge>
<Edge name="far"><line2 id="1">7,8</line2><line2 id="2">8,9</line2></Edge>
<Edge name="base"><line2 id="1">1,2</line2><line2 id="2">2,3</line2></Edge>
</Mesh>
<MeshDomains><SolidDomain name="low" mat="m"/><SolidDomain name="high" mat="m"/></MeshDomains>
<Boundary>
<bc node_set="bottom" type="zero displacement"><x_dof>1</x_dof><y_dof>1</y_dof><z_dof>1</z_dof></bc>
<bc node_set="top" type="zero displacement"><x_dof>0</x_dof><y_dof>1</y_dof><z_dof>0</z_dof></bc>
<bc node_set="top" type="prescribed displacement"><dof>x</dof><value lc="1">0.1</value></bc>
<bc node_set="top" type="prescribed displacement"><dof>z</dof><value lc="1">{down}</value></bc>
</Boundary>
{contact}
<LoadData><load_controller id="1" type="loadcurve"><points><pt>0,0</pt><pt>1,1</pt></points></load_controller>
</LoadData>
</febio_spec>
"""
NEO_HOOKEAN = 'type="neo-Hookean"><density>1</density><E>1</E><v>0.3</v>'
SOLID = f'<Material><material id="1" name="m" {NEO_HOOKEAN}</material></Material>'
POROUS = (
    f'<phi0>0.2</phi0><solid {NEO_HOOKEAN}</solid>'
    '<permeability type="perm-const-iso"><perm>0.1</perm></permeability>'
)
BIPHASIC = f'<Material><material id="1" name="m" type="biphasic">{POROUS}</material></Material>'
MULTIPHASIC = (
    "<Globals><Constants><R>1</R><T>1</T><Fc>1</Fc></Constants><Solutes><solute id=\"1\" name=\"s\">"
    "<charge_number>0</charge_number><molar_mass>1</molar_mass><density>1</density></solute></Solutes></Globals>"
    f'<Material><material id="1" name="m" type="multiphasic">{POROUS}<fixed_charge_density>0</fixed_charge_density>'
    '<osmotic_coefficient type="osm-coef-const"><osmcoef>1</osmcoef></osmotic_coefficient><solute sol="1">'
    '<diffusivity type="diff-const-iso"><free_diff>0.1</free_diff><diff>0.1</diff></diffusivity>'
    '<solubility type="solub-const"><solub>1</solub></solubility></solute></material></Material>'
)
BATH = (
    '<Initial><ic node_set="all" type="initial concentration"><dof>c1</dof><value>0.1</value></ic>'
    '<ic node_set="all" type="initial fluid pressure"><value>-0.05</value></ic></Initial>'
)
FRICTION = "<penalty>5</penalty><pressure_penalty>0.5</pressure_penalty><fric_coeff>0.2</fric_coeff>"
# type, parameters, edge of lines; displacements of nodes 13 and 16 and, where there is one, their fluid pressure
CASES = {
    "friction": ("sliding-biphasic", FRICTION + "<contact_frac>0.1</contact_frac>", "", [
        [0.0629002041573, -0.0112403342835, -0.0338264941652, 0.00143560009142],
        [0.0629002041573, 0.0112403342835, -0.0338264941652, 0.00143560009142],
    ]),
    "smooth_fls": (
        "sliding-biphasic", FRICTION + "<contact_frac>0.1</contact_frac><smooth_fls>1</smooth_fls>", "", [
            [0.0775858328101, -0.0100657924035, -0.0366787277353, 0.000421639613971],
            [0.0775858328101, 0.0100657924035, -0.0366787277353, 0.000421639613971],
    ]),
    "bath": (
        "sliding-multiphasic", FRICTION + "<contact_frac>0.1</contact_frac><concentration_penalty>0.5"
        "</concentration_penalty><ambient_pressure>-0.05</ambient_pressure>"
        '<ambient_concentration sol="1">0.1</ambient_concentration>', "", [
            [0.0372023676457, -0.0199066770395, -0.0290588622223, -0.0650156420957],
            [0.0372023676457, 0.0199066770395, -0.0290588622223, -0.0650156420957],
    ]),
    "smooth_aug": (
        "sliding-elastic", "<laugon>AUGLAG</laugon><tolerance>0.01</tolerance><penalty>2</penalty>"
        "<fric_coeff>0.3</fric_coeff><smooth_aug>1</smooth_aug>", "", [
            [0.0688064995614, -0.0071046875016, -0.0255738349192], [0.0688064995614, 0.0071046875016, -0.0255738349192],
    ]),
    "sticky": ("sticky", "<penalty>5</penalty><snap_tol>0.01</snap_tol><max_traction>0.1</max_traction>", "", [
        [0.0474455937359, -0.00272116810229, -0.0275214043907], [0.0474455937359, 0.00272116810229, -0.0275214043907],
    ]),
    "potential": (
        "contact potential", "<kc>1e-4</kc><p>2</p><R_in>0.1</R_in><R_out>0.3</R_out><integration_rule>1"
        "</integration_rule>", "", [
            [0.0976915639069, 0.000335253117359, -0.0606959445064],
            [0.0976915639069, -0.000335253117359, -0.0606959445064],
    ]),
    "multipliers": ("tied-node-on-facet", "<laugon>LAGMULT</laugon><search_tolerance>0.01</search_tolerance>", "", [
        [0.0382872498514, 0.00646558701837, 0.0111182570767], [0.0382872498514, -0.00646558701837, 0.0111182570767],
    ]),
    "tied-line": ("tied-line", "<laugon>AUGLAG</laugon><penalty>2</penalty><tolerance>0.01</tolerance>", "far", [
        [0.0366939092615, -0.0403883421303, 0.0299572993232], [0.0782756995355, -0.0143215686178, 0.0596709054163],
    ]),
    "slide-line": ("slide-line", "<penalty>0.2</penalty><tolerance>0.01</tolerance>", "base", [
        [0.179285857003, 0.069775794873, -0.307307182215], [0.113543980643, 0.0441430691652, 0.0486465447297],
    ]),
}  # fmt: skip


def deck(kind: str, inside: str, edge: str, fluid: bool) -> str:
    X = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1, 2)]
    X += [(0.5 + x, 0.1 + 0.8 * y, 1.02 + z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
    nodes = "".join(f'<node id="{k + 1}">{x:g},{y:g},{z:g}</node>' for k, (x, y, z) in enumerate(X))
    if edge:
        inside += f"<primary>near</primary><secondary>{edge}</secondary>"
        contact = f'<Constraints><constraint type="{kind}">{inside}</constraint></Constraints>'
    else:
        contact = f'<Contact><contact type="{kind}" surface_pair="faces">{inside}</contact></Contact>'
    module, analysis, material = ("biphasic", "TRANSIENT", BIPHASIC) if fluid else ("solid", "STATIC", SOLID)
    if "multiphasic" in kind:
        module, material, contact = "multiphasic", MULTIPHASIC, BATH + contact
    down = 0.05 if edge or kind.startswith("tied") else -0.06
    text = DECK.format(
        module=module, analysis=analysis, material=material, nodes=nodes, contact=contact, down=down
    )  # fmt: skip
    return text.replace("<max_refs>", "<ptol>1e-9</ptol><max_refs>") if fluid else text


@pytest.mark.parametrize("name", CASES)
def test_blocks_meet_as_in_febio(tmp_path: Path, name: str) -> None:
    kind, inside, edge, numbers = CASES[name]
    path = tmp_path / "blocks.feb"
    path.write_text(deck(kind, inside, edge, len(numbers[0]) == 4))
    result = febkit.solve(path)
    assert result.converged, result.reason
    # FEBio's rule of 16 points has six digits
    found = result.state.d[[12, 15], : len(numbers[0])]
    np.testing.assert_allclose(found, numbers, rtol=1e-5 if name == "potential" else 1e-8)
