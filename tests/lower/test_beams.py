"""<BeamDomain>: trusses and beams of .feb files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import febkit
from febkit.lower import lower, unsupported
from febkit.model import InputError
from helpers import cube

BEAM = ('<material id="1" name="m" type="linear-beam"><density>2</density><E>200</E><G>80</G><A>0.5</A><A1>0.4</A1>'
        "<A2>0.3</A2><I1>0.05</I1><I2>0.02</I2></material>")  # fmt: skip
TRUSS = '<material id="1" name="m" type="linear truss"><density>2</density><E>200</E><v>0.3</v></material>'
SOLID = '<material id="1" name="m" type="neo-Hookean"><density>2</density><E>200</E><v>0.3</v></material>'
AREA = "<cross_sectional_area>0.5</cross_sectional_area>"
FORCE = '<body_load type="body force"><force>0,0,1</force></body_load>'
PLOT = ("rotation", "stress", "beam stress", "beam stress couple", "beam strain", "beam curvature",
        "beam reference stress", "beam reference stress couple", "truss stretch", "relative volume")  # fmt: skip


def text(material: str, domain: str, *, kind: str = "line2", more: str = "", control: str = "") -> str:
    """Five nodes in a line along (1, 1, 0), the first held, with four or two elements."""
    elements = {"line2": ("1,2", "2,3", "3,4", "4,5"), "line3": ("1,3,2", "3,5,4")}[kind]
    lines = "".join(f'<elem id="{k + 1}">{e}</elem>' for k, e in enumerate(elements))
    out = cube.text(material, more=more, control=control)
    nodes = "".join(f'<node id="{k + 1}">{k},{k},0</node>' for k in range(5))
    head, rest = out.split("<Mesh>")
    tail = rest.split("<Boundary>")[1]
    held = '<bc node_set="held" type="zero rotation"><u_dof>1</u_dof><v_dof>1</v_dof><w_dof>1</w_dof></bc></Boundary>'
    tail = tail.replace("base", "held", 1).replace("</Boundary>", held)
    return f"""{head}<Mesh><Nodes name="all">{nodes}</Nodes><Elements type="{kind}" name="line">{lines}</Elements>
<NodeSet name="held">1</NodeSet><NodeSet name="end">5</NodeSet></Mesh>
<MeshDomains>{domain}</MeshDomains><Boundary>{tail}"""


def domain(kind: str, inside: str = "") -> str:
    return f'<BeamDomain name="line" mat="m" type="{kind}">{inside}</BeamDomain>'


def load(dof: str, value: float) -> str:
    return f'<nodal_load type="nodal_load" node_set="end"><dof>{dof}</dof><scale>{value}</scale></nodal_load>'


VARS = "".join(f'<var type="{v}"/>' for v in ("displacement", *PLOT))
OUTPUT = f'<Output><plotfile type="febio">{VARS}</plotfile></Output>'


def solved(folder: Path, content: str) -> xr.Dataset:
    (folder / "m.feb").write_text(content)
    result = febkit.solve(folder / "m.feb", plotfile=folder / "m.xplt")
    assert result.converged, result.reason
    return febkit.open_results(folder / "m.xplt")


@pytest.mark.parametrize("kind", ["line2", "line3"])
def test_a_beam_under_a_moment(tmp_path: Path, kind: str) -> None:
    """M about z, perpendicular to the beam: curvature M / E I, and the variables that FEBio writes."""
    more = f"<Loads>{load('w', 0.7)}</Loads>{OUTPUT}"
    ds = solved(tmp_path, text(BEAM, domain("linear-beam"), kind=kind, more=more)).isel(time=-1)
    d = np.array([1.0, 1.0, 0.0]) / np.sqrt(2)
    E2 = np.cross(d, [0.0, 1.0, 0.0])  # along z
    I = 0.02 if abs(E2 @ [0, 0, 1]) > 0.5 else 0.05
    # two points a linear element see the shear of bending: it is stiffer by G A1 h^2 / 12 E I
    k, n = 0.7 / (200 * I) / (1.0 if kind == "line3" else 1.0 + 80 * 0.4 * 2.0 / (12 * 200 * I)), len(ds.element)
    np.testing.assert_allclose(ds["beam_curvature"], np.tile([0, 0, k], (n, 1)), atol=1e-3 * k)
    for name in ("beam_stress_couple", "beam_reference_stress_couple"):
        np.testing.assert_allclose(ds[name], np.tile([0, 0, 200 * I * k], (n, 1)), rtol=1e-3, atol=1e-4)
    length = 4 * np.sqrt(2)
    np.testing.assert_allclose(ds["rotation"][-1], [0, 0, k * length], rtol=2e-3, atol=1e-4)
    assert "truss_stretch" not in ds or np.isnan(ds["truss_stretch"]).all()


def test_a_linear_truss(tmp_path: Path) -> None:
    """Pulled along its line by prescribed ends: tau = E ln(lambda), stress tau / J."""
    lam = 1.2
    pulled = "".join(
        f'<bc type="prescribed displacement" node_set="all"><dof>{q}</dof><value type="math">{v}</value></bc>'
        for q, v in (("x", "0.2*X"), ("y", "0.2*Y"), ("z", "0"))
    )
    content = text(TRUSS, domain("linear-truss", AREA), more=OUTPUT).replace("<Boundary>", f"<Boundary>{pulled}")
    content = content.replace('<NodeSet name="held">', '<NodeSet name="all">1,2,3,4,5</NodeSet><NodeSet name="held">')
    ds = solved(tmp_path, content).isel(time=-1)
    n = len(ds.element)
    s = 200 * np.log(lam) / lam**0.4 / 2
    np.testing.assert_allclose(ds["stress"], np.tile([s, s, 0, s, 0, 0], (n, 1)), rtol=1e-5, atol=1e-4)
    np.testing.assert_allclose(ds["truss_stretch"], n * [lam], rtol=1e-6)


@pytest.mark.parametrize(("material", "spec", "says"), [
    (TRUSS, '<BeamDomain name="line" mat="m">' + AREA + "</BeamDomain>", ""),
    (TRUSS, domain("linear-truss"), "positive <cross_sectional_area>"),
    (SOLID, domain("linear-truss", AREA), 'takes a material of type "linear truss", not "neo-Hookean"'),
    (SOLID, domain("linear-beam"), 'takes a material of type "linear-beam"'),
    (BEAM.replace("<A>", '<A lc="1">'), domain("linear-beam"), "a load curve of <A>"),
    (BEAM, '<BeamDomain name="line" mat="m"/>', "a beam domain of .*linear-beam.* without a type"),
    (SOLID, domain("elastic-truss", AREA + "<v>0.3</v>"), ""),
    (BEAM.replace("<G>", "<H>1</H><G>"), domain("linear-beam"), "<H>"),
])  # fmt: skip
def test_what_a_domain_must_be(tmp_path: Path, material: str, spec: str, says: str) -> None:
    model = cube.read(tmp_path, text(material, spec))
    if not says:
        assert not unsupported(model) and lower(model).blocks[0].element == "line2"
        return
    with pytest.raises(InputError, match=says):
        lower(model)


def test_three_nodes_make_no_truss(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="takes line2, not line3"):
        cube.problem(tmp_path, text(TRUSS, domain("linear-truss", AREA), kind="line3"))


@pytest.mark.parametrize(("material", "spec", "more", "says"), [
    (SOLID, domain("elastic-truss", AREA), FORCE, "a body load on"),
    (BEAM, domain("linear-beam"), '<body_load type="mass damping"><C>1</C></body_load>', "follows the motion"),
    (BEAM, domain("linear-beam"), FORCE, ""),
])  # fmt: skip
def test_body_loads(tmp_path: Path, material: str, spec: str, more: str, says: str) -> None:
    found = [str(e) for e in unsupported(cube.read(tmp_path, text(material, spec, more=f"<Loads>{more}</Loads>")))]
    assert len(found) == bool(says) and all(says in f for f in found)


def test_rotations_without_beams_do_nothing(tmp_path: Path) -> None:
    """As in FEBio: degrees of freedom that no element has are passed over."""
    more = '<bc node_set="top" type="zero rotation"><u_dof>1</u_dof></bc>'
    p = cube.problem(tmp_path, cube.text(SOLID).replace("</Boundary>", f"{more}</Boundary>"))
    assert not p.layout.turns and len(p.common.conditions) == 3


STEPS = """<Control><analysis>STATIC</analysis><time_steps>{steps}</time_steps><step_size>{size}</step_size><solver
type="solid"><symmetric_stiffness>0</symmetric_stiffness><dtol>1e-9</dtol><etol>1e-16</etol><lstol>0</lstol>
<min_residual>1e-24</min_residual><max_refs>500</max_refs><qn_method type="BFGS"><max_ups>0</max_ups></qn_method>
</solver></Control>"""
CURVES = """<LoadData><load_controller id="1" type="loadcurve"><interpolate>LINEAR</interpolate><points><pt>0,0</pt>
<pt>0.4,1</pt></points></load_controller><load_controller id="2" type="loadcurve"><interpolate>LINEAR</interpolate>
<points><pt>0,0</pt><pt>0.2,0.2</pt><pt>0.4,1</pt></points></load_controller></LoadData>"""
HELD = '<bc type="zero displacement" node_set="held"><x_dof>1</x_dof><y_dof>1</y_dof><z_dof>1</z_dof></bc>'


def whole(steps: str, material: str, mesh: str, spec: str, boundary: str, loads: str) -> str:
    return f"""<febio_spec version="4.0"><Module type="solid"/>{steps}<Material>{material}</Material><Mesh>{mesh}</Mesh>
<MeshDomains>{spec}</MeshDomains><Boundary>{HELD}{boundary}</Boundary><Loads>{loads}</Loads>{CURVES}</febio_spec>"""


def test_febios_answer_of_a_beam(tmp_path: Path) -> None:
    """A clamp that turns about two axes, one later than the other, a moment, a force and a body force (FEBio 4.11)."""
    nodes = "".join(f'<node id="{k + 1}">{k},{0.5 * k},{0.2 * k}</node>' for k in range(5))
    sets = "".join(f'<NodeSet name="{n}">{k}</NodeSet>' for n, k in (("held", 1), ("end", 5), ("mid", 3)))
    lines = '<elem id="1">1,3,2</elem><elem id="2">3,5,4</elem>'
    mesh = f'<Nodes name="all">{nodes}</Nodes><Elements type="line3" name="p">{lines}</Elements>{sets}'
    turned = "".join(f'<bc type="prescribed rotation" node_set="held"><dof>{d}</dof><value lc="{lc}">{v}</value></bc>'
                     for d, lc, v in (("v", 1, 0.7), ("w", 2, 0.9)))  # fmt: skip
    loads = "".join(f'<nodal_load type="nodal_load" node_set="{n}"><dof>{d}</dof><scale lc="1">{v}</scale></nodal_load>'
                    for n, d, v in (("end", "u", 3), ("mid", "z", 5)))  # fmt: skip
    section = "<density>2</density><E>2000</E><G>800</G><A>0.5</A><A1>0.4</A1><A2>0.3</A2><I1>0.05</I1><I2>0.02</I2>"
    content = whole(
        STEPS.format(steps=20, size=0.02), f'<material id="1" name="m" type="linear-beam">{section}</material>', mesh,
        '<BeamDomain name="p" mat="m" type="linear-beam"/>',
        '<bc type="zero rotation" node_set="held"><u_dof>1</u_dof></bc>' + turned,
        loads + '<body_load type="body force"><force lc="1">0,3,1</force></body_load>',
    )  # fmt: skip
    result = febkit.solve(cube.read(tmp_path, content))
    assert result.converged, result.reason
    answer = [[-1.9335585721, 1.26673544959, -0.600454498198], [-4.05524725147, 2.5333224729, -0.802574008976]]
    np.testing.assert_allclose(result.state.u[[2, 4]], answer, rtol=1e-9)


@pytest.mark.parametrize(("kind", "law", "more", "answer"), [
    ("elastic-truss", "neo-Hookean", "<v>0.3</v>", [0.0806519902514, -0.0565853659578, 0.0370924388256]),
    ("linear-truss", "linear truss", "", [0.0826803593082, -0.0602037168263, 0.0395745189362]),
])  # fmt: skip
def test_febios_answer_of_trusses(tmp_path: Path, kind: str, law: str, more: str, answer: list[float]) -> None:
    """Three trusses that meet in a loaded node (FEBio 4.11)."""
    points = ("0,0,0", "1,0,0", "0,1,0", "0.3,0.2,0.9")
    nodes = "".join(f'<node id="{k}">{x}</node>' for k, x in enumerate(points, 1))
    lines = "".join(f'<elem id="{k}">{e}</elem>' for k, e in enumerate(("1,4", "2,4", "4,3"), 1))
    sets = '<NodeSet name="held">1,2,3</NodeSet><NodeSet name="end">4</NodeSet>'
    mesh = f'<Nodes name="all">{nodes}</Nodes><Elements type="line2" name="p">{lines}</Elements>{sets}'
    material = f'<material id="1" name="m" type="{law}"><density>1</density><E>100</E><v>0.3</v></material>'
    spec = f'<BeamDomain name="p" mat="m" type="{kind}">{AREA.replace("0.5", "0.4")}{more}</BeamDomain>'
    load = '<nodal_load type="nodal_force" node_set="end"><value lc="1">2,-1.5,3</value></nodal_load>'
    result = febkit.solve(cube.read(tmp_path, whole(STEPS.format(steps=4, size=0.1), material, mesh, spec, "", load)))
    assert result.converged, result.reason
    np.testing.assert_allclose(result.state.u[3], answer, rtol=1e-8)
