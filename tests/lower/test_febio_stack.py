"""What joins rigid bodies and nodes, beside FEBio 4.11: a soft block between a held body and a free one."""

from __future__ import annotations

import numpy as np
import pytest

import febkit

PLANE = [(0.1, 0), (1.1, 0), (1.1, 1.2), (0.1, 1.2)]
SMALL = [(0.3, 0.3), (0.8, 0.3), (0.8, 0.7), (0.3, 0.7)]
X = [(x, y, z) for z in (0.0, 1.0, 2.1, 3.0) for x, y in PLANE] + [(x, y, z) for z in (1.2, 1.9) for x, y in SMALL]
DOFS = "".join(f"<{q}_dof>1</{q}_dof>" for q in ("Rx", "Ry", "Rz", "Ru", "Rv", "Rw"))
DECK = """<febio_spec version="4.0"><Module type="solid"/><Control><analysis>STATIC</analysis><time_steps>4</time_steps>
<step_size>0.25</step_size><solver type="solid"><symmetric_stiffness>0</symmetric_stiffness><dtol>1e-9</dtol>
<etol>1e-15</etol><rtol>0</rtol><max_refs>50</max_refs><qn_method type="BFGS"><max_ups>0</max_ups></qn_method></solver>
</Control><Material><material id="1" name="a" type="rigid body"><density>1</density></material>
<material id="2" name="m" type="neo-Hookean"><E>3</E><v>0.2</v></material>
<material id="3" name="b" type="rigid body"><density>1</density></material></Material><Mesh>
<Nodes name="N">{nodes}</Nodes>
{elements}<DiscreteSet name="d"><delem>1,14</delem><delem>7,13</delem></DiscreteSet></Mesh>
<MeshDomains>{domains}
</MeshDomains><Rigid><rigid_bc type="rigid_fixed"><rb>a</rb>{dofs}</rigid_bc>{rigid}</Rigid>{more}<LoadData>
<load_controller id="1" type="loadcurve"><points><pt>0,0</pt><pt>1,1</pt></points></load_controller></LoadData>
</febio_spec>"""
FORCE = '<rigid_load type="rigid_force"><rb>b</rb><dof>{}</dof><value lc="1">{}</value></rigid_load>'
PULL = FORCE.format("Rz", 0.6) + FORCE.format("Rx", 0.3)
AXIAL = """<rigid_load type="rigid_axial_force"><rbA>a</rbA><rbB>b</rbB><ra>0.2,0.3,0.5</ra><rb>{}</rb>
<force lc="1">{}</force><relative>{}</relative></rigid_load>"""
CABLE = """<rigid_load type="rigid_cable"><force lc="1">0.1</force><force_direction>1,0.5,1</force_direction>
<relative>0</relative><rigid_cable_point><rigid_body_id>a</rigid_body_id><position>0.2,0.3,0.5</position>
</rigid_cable_point><rigid_cable_point><rigid_body_id>b</rigid_body_id><position>1.4,0.8,2.6</position>
</rigid_cable_point></rigid_load>"""
JOINT = """<rigid_connector type="generic rigid joint" name="j"><body_a>a</body_a><body_b>b</body_b>
<joint>0.4,0.5,1.5</joint><penalty>20</penalty><prescribe_x lc="1">0.2</prescribe_x><prescribe_z>0</prescribe_z>{}
</rigid_connector>"""
SPRINGS = '<Discrete><discrete_material id="1" name="k" {}</discrete_material><discrete dmat="1" discrete_set="d"/>'
SPRINGS += "</Discrete>"
TORSION = 'type="torsion spring"><r>0.8</r>'
PAIRS = ((17, 5), (18, 6), (19, 7), (20, 8))
ON_NODES = "".join(f'<constraint type="node-on-node"><a>{a}</a><b>{b}</b></constraint>' for a, b in PAIRS)
CASES = {  # <Rigid>, other sections, displacements in FEBio of node 14 and of another
    "axial": (
        AXIAL.format("1.4,0.8,2.6", 0.2, 0), "",
        (0.016928492, -0.078572594, -0.098455615), (11, 0.0058006439, -0.063544534, -0.077991277)),
    "axial, from the centres": (
        AXIAL.format("0.4,0.2,0.1", 0.5, 1), "",
        (0.35127434, 0.31969666, -0.19426119), (11, 0.0026586973, 0.11139043, -0.36431286)),
    "cable": (
        CABLE, "", (0.1186481, 0.056847483, -0.025181487), (11, 0.033088628, 0.032282837, -0.053099215)),
    "generic joint": (
        PULL + JOINT.format('<prescribe_Rz lc="1">0.3</prescribe_Rz>'), "",
        (0.57905686, 0.092292085, -0.16176665), (11, 0.065689102, 0.082834415, -0.01612895)),
    "generic joint, augmented": (
        PULL + JOINT.format("<prescribe_Ry>0</prescribe_Ry><laugon>AUGLAG</laugon><tolerance>1e-6</tolerance>"), "",
        (0.22252211, -0.061234027, -0.030941758), (11, 0.17323327, -0.012853336, 0.038927976)),
    "experimental springs": (
        PULL, SPRINGS.format('type="experimental spring"><E>1.5</E><sM>0.2</sM><sm>0.3</sm>'),
        (0.59546304, -0.10236362, -0.15329552), (11, 0.35774052, -0.041530706, -0.030333729)),
    "torsion springs": (
        PULL, SPRINGS.format(TORSION),
        (0.34980738, -0.089158267, 0.051506426), (11, 0.31923509, -0.077823661, 0.0673493)),
    "composite springs": (
        PULL,
        SPRINGS.format(f'type="discrete composite"><mat type="linear spring"><E>0.7</E></mat><mat {TORSION}</mat>'),
        (0.32529253, -0.13928048, -0.012621231), (11, 0.33849725, -0.099981919, 0.042414434)),
    "node on node": (
        PULL, f"<Constraints>{ON_NODES}</Constraints>",
        (0.63560736, 0.0, -0.055911168), (23, -0.027910184, -0.032484066, -0.31793293)),
}  # fmt: skip


def deck(rigid: str, more: str, small: bool) -> str:
    parts = {"p": ("a", 1), "q": ("m", 5), "r": ("b", 9), **({"s": ("m", 17)} if small else {})}
    element = '<Elements type="hex8" name="{}"><elem id="{}">{}</elem></Elements>'
    elements = "".join(
        element.format(n, i, ",".join(map(str, range(k, k + 8)))) for i, (n, (_, k)) in enumerate(parts.items(), 1)
    )
    nodes = "".join(f'<node id="{k}">{x},{y},{z}</node>' for k, (x, y, z) in enumerate(X if small else X[:16], 1))
    domains = "".join(f'<SolidDomain name="{n}" mat="{m}"/>' for n, (m, _) in parts.items())
    return DECK.format(nodes=nodes, elements=elements, domains=domains, dofs=DOFS, rigid=rigid, more=more)


@pytest.mark.parametrize("name", CASES)
def test_displacements_are_febios(name, tmp_path):
    rigid, more, u, (node, *v) = CASES[name]
    (tmp_path / "stack.feb").write_text(deck(rigid, more, name == "node on node"))
    result = febkit.solve(tmp_path / "stack.feb")
    assert result.converged, result.reason
    np.testing.assert_allclose(result.state.u[[13, node - 1]], [u, v], rtol=1e-6, atol=1e-9)


def test_bodies_held_and_led_by_their_old_names(tmp_path):
    """As "rigid_fixed" and "rigid_displacement" have them."""
    lead = '<rigid_bc type="{}"><rb>b</rb><dof>Rz</dof><value lc="1">0.2</value></rigid_bc>'
    turn = "<Ru_dof>1</Ru_dof><Rv_dof>1</Rv_dof><Rw_dof>1</Rw_dof>"
    new = lead.format("rigid_displacement") + f'<rigid_bc type="rigid_fixed"><rb>b</rb>{turn}</rigid_bc>'
    old = lead.format("rigid_prescribed_old")
    old += '<rigid_bc type="rigid_fixed_old"><rb>b</rb><dofs>Ru,Rv,Rw</dofs></rigid_bc>'
    states = []
    for rigid in (new, old):
        (tmp_path / "stack.feb").write_text(deck(rigid, "", False))
        states.append(febkit.solve(tmp_path / "stack.feb").state.u)
    np.testing.assert_array_equal(*states)
    assert states[0][13, 2] == pytest.approx(0.2)
