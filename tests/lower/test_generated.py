"""Element data made of surfaces."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from febkit.lower import lower
from febkit.lower.nearest import distances
from febkit.model import InputError, UnsupportedError
from febkit.model.mesh import Surface
from febkit.solver.points import Points
from febkit.solver.run import run
from helpers import cube

SOLID = """<material id="1" name="m" type="trans iso Mooney-Rivlin"><c1>1</c1><c3>1</c3><c4>1</c4><k>10</k>
<fiber type="map"><map>way</map></fiber></material>"""
SIDES = """<Surface name="low"><quad4 id="1">1,4,3,2</quad4></Surface>
<Surface name="high"><quad4 id="1">5,6,7,8</quad4></Surface>
<Surface name="left"><quad4 id="1">1,5,8,4</quad4></Surface>
<Surface name="right"><quad4 id="1">2,3,7,6</quad4></Surface>"""
DATA = '<MeshData><ElementData name="way" elem_set="cube" type="surface-to-surface vector">{}</ElementData></MeshData>'
ACROSS = "<surface1>left</surface1><surface2>right</surface2>"


def way(folder: Path, inside: str) -> np.ndarray:
    problem = cube.problem(folder, cube.text(SOLID, more=DATA.format(inside)).replace("</Mesh>", f"{SIDES}</Mesh>"))
    pts = Points(np.eye(3)[None], np.ones(1), np.zeros((1, 3)), np.zeros(1, int))
    return np.asarray(problem.blocks[0].solid.fiber(pts)[0])  # type: ignore[attr-defined]


@pytest.mark.parametrize(("inside", "expected"), [
    (ACROSS, (1, 0, 0)),
    ("<surface1>high</surface1><surface2>low</surface2>", (0, 0, -1)),
    (ACROSS + "<cross>1</cross>", (0, -1, 0)),
    (ACROSS + "<cross>1</cross><normal>0,2,2</normal>", (0, -1, 1)),
    (ACROSS + "<in_angle>30</in_angle>", (np.sqrt(3), 1, 0)),
    (ACROSS + "<out_angle>30</out_angle>", (np.sqrt(3), 0, 1)),  # about x cross z = -y
])  # fmt: skip
def test_the_way_from_one_surface_to_the_other(tmp_path: Path, inside: str, expected: tuple[float, ...]) -> None:
    np.testing.assert_allclose(way(tmp_path, inside), np.array(expected) / np.linalg.norm(expected), atol=1e-15)


def test_the_field_is_harmonic(tmp_path: Path) -> None:
    """Around a wedge of rings the field grows with the angle: its gradient is the circumference's tangent."""
    angles, radii, nodes = np.linspace(0.0, 1.2, 13), (1.0, 1.1), []
    for z in (0.0, 0.1):
        nodes += [(r * np.cos(a), r * np.sin(a), z) for a in angles for r in radii]
    n, k = 2 * len(angles), np.arange(2 * len(angles)).reshape(-1, 2)
    hexes = [[*q, *(i + n for i in q)] for q in ([k[i, 0], k[i, 1], k[i + 1, 1], k[i + 1, 0]] for i in range(12))]
    text = cube.text(SOLID, more=DATA.format(ACROSS))
    at, end = text.index("<Nodes"), text.index("</Mesh>")
    mesh = '<Nodes name="all">' + "".join(f'<node id="{i + 1}">{x},{y},{z}</node>' for i, (x, y, z) in enumerate(nodes))
    mesh += '</Nodes><Elements type="hex8" name="cube">'
    mesh += "".join(f'<elem id="{i + 1}">{",".join(str(j + 1) for j in h)}</elem>' for i, h in enumerate(hexes))
    mesh += '</Elements><NodeSet name="base">1</NodeSet>'
    for name, (a, b) in (("left", k[0]), ("right", k[-1])):
        mesh += f'<Surface name="{name}"><quad4 id="1">{a + 1},{b + 1},{b + 1 + n},{a + 1 + n}</quad4></Surface>'
    solid = lower(cube.read(tmp_path, text[:at] + mesh + text[end:])).blocks[0].solid
    pts = Points(np.eye(3)[None], np.ones(1), np.zeros((1, 3)), np.arange(12))
    middle = 0.5 * (angles[1:] + angles[:-1])
    tangent = np.stack([-np.sin(middle), np.cos(middle), 0.0 * middle], axis=1)
    np.testing.assert_allclose(solid.fiber(pts), tangent, atol=1e-12)  # type: ignore[attr-defined]


@pytest.mark.parametrize(("inside", "error", "says"), [
    ("<surface1>left</surface1>", InputError, "<surface2>"),
    (ACROSS.replace("right", "write"), InputError, 'no surface "write"'),
    (ACROSS + "<sharpness>2</sharpness>", UnsupportedError, "<sharpness>"),
])  # fmt: skip
def test_faults_are_named(tmp_path: Path, inside: str, error: type[Exception], says: str) -> None:
    with pytest.raises(error, match=says) as e:
        way(tmp_path, inside)
    assert e.value.where is not None and e.value.where.line  # type: ignore[attr-defined]


BENT = """<febio_spec version="4.0"><Module type="solid"/><Control><analysis>STATIC</analysis><time_steps>2</time_steps>
<step_size>0.5</step_size><solver type="solid"><dtol>1e-9</dtol><etol>1e-14</etol><rtol>0</rtol><max_refs>50</max_refs>
<qn_method type="BFGS"><max_ups>0</max_ups></qn_method></solver></Control><Material>
<material id="1" name="m" type="neo-Hookean"><E type="map">stiff</E><v>0.3</v></material></Material><Mesh>
<Nodes name="N">{nodes}</Nodes><Elements type="hex8" name="p">{hexes}</Elements><NodeSet name="b">{base}</NodeSet>
<NodeSet name="t">{top}</NodeSet><Surface name="low">{low}</Surface><Surface name="high">{high}</Surface>
<ElementSet name="some">1,2</ElementSet></Mesh><MeshDomains><SolidDomain name="p" mat="m"/></MeshDomains>
<MeshData><ElementData name="stiff" elem_set="p" type="surface-to-surface map"><bottom_surface>low</bottom_surface>
<top_surface>high</top_surface>{function}</ElementData></MeshData>
<Boundary><bc type="zero displacement" node_set="b"><x_dof>1</x_dof><y_dof>1</y_dof><z_dof>1</z_dof></bc>
<bc type="prescribed displacement" node_set="t"><dof>z</dof><value lc="1">0.2</value></bc></Boundary>
<LoadData><load_controller id="1" type="loadcurve"><interpolate>LINEAR</interpolate><points><pt>0,0</pt><pt>1,1</pt>
</points></load_controller></LoadData></febio_spec>"""
FORMULA = '<function type="math"><math>1+4*x^2</math></function>'
POINTS = """<function type="point"><interpolate>LINEAR</interpolate><points>
<pt>0,1</pt><pt>0.3,2</pt><pt>1,6</pt></points>
</function>"""


def bent(function: str) -> str:
    """A bent block of 2 x 2 x 2 hexahedra whose modulus goes from its lower to its upper surface."""
    P = np.array([(x, y, z) for z in (0, 0.4, 1) for y in (0, 0.6, 1) for x in (0, 0.5, 1)], float)
    P[:, 2], P[:, 0] = P[:, 2] * (1 + 0.3 * P[:, 0]) + 0.2 * P[:, 0], P[:, 0] + 0.1 * P[:, 1] * P[:, 2]

    def loop(i: int, j: int, k: int) -> list[int]:
        a = 1 + i + 3 * j + 9 * k
        return [a, a + 1, a + 4, a + 3]

    def listed(tag: str, rows: list[list[int]]) -> str:
        return "".join(f'<{tag} id="{n}">{",".join(map(str, row))}</{tag}>' for n, row in enumerate(rows, 1))

    squares = [(i, j) for j in range(2) for i in range(2)]
    return BENT.format(
        nodes="".join(f'<node id="{n}">{x!r},{y!r},{z!r}</node>' for n, (x, y, z) in enumerate(P.tolist(), 1)),
        hexes=listed("elem", [loop(i, j, k) + loop(i, j, k + 1) for k in range(2) for i, j in squares]),
        base=",".join(map(str, range(1, 10))), top=",".join(map(str, range(19, 28))), function=function,
        low=listed("quad4", [loop(i, j, 0)[::-1] for i, j in squares]),
        high=listed("quad4", [loop(i, j, 2) for i, j in squares]),
    )  # fmt: skip


@pytest.mark.parametrize(("function", "iterations", "expected"), [
    (FORMULA, 6, (0.038892366, -0.0054734247, 0.1225049)), (POINTS, 7, (0.037721634, -0.0055491794, 0.11990328)),
])  # fmt: skip
def test_a_modulus_between_surfaces(
    tmp_path: Path, function: str, iterations: int, expected: tuple[float, float, float]
) -> None:
    """Displacement of the node in the middle, and the iterations, in FEBio 4.11."""
    result = run(lower(cube.read(tmp_path, bent(function))))
    assert result.converged and result.totals.iterations == iterations
    np.testing.assert_allclose(result.state.u[13], expected, rtol=2e-7)


@pytest.mark.parametrize(("old", "new", "error", "says"), [
    (FORMULA, "", InputError, "<function>"),
    ("<top_surface>high", "<top_surface>hight", InputError, 'no surface "hight".*"high"'),
    ('elem_set="p"', 'elem_set="some"', InputError, 'says nothing of element 3 of "p"'),
    ("</ElementData>", "<scale>2</scale></ElementData>", UnsupportedError, "<scale>"),
])  # fmt: skip
def test_faults_of_what_lies_between_are_named(
    tmp_path: Path, old: str, new: str, error: type[Exception], says: str
) -> None:
    with pytest.raises(error, match=says) as e:
        lower(cube.read(tmp_path, bent(FORMULA).replace(old, new)))
    assert e.value.where is not None and e.value.where.line  # type: ignore[attr-defined]


@pytest.mark.parametrize("kind", ["quad4", "tri3"])
def test_distances_from_a_square(kind: str) -> None:
    """Along its normal above it, from its rim and corners beside it."""
    X = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], float)
    conn = np.array([[0, 1, 2, 3]] if kind == "quad4" else [[0, 1, 2], [0, 2, 3]])
    x = np.array([(0.3, 0.6, 2), (0.2, 0.1, -0.5), (1.5, 0.5, 0), (2, 2, 1), (-3, 0.25, 4)])
    expected = (2.0, 0.5, 0.5, np.sqrt(3.0), 5.0)
    np.testing.assert_allclose(distances(X, Surface("s", {kind: conn}), x), expected, rtol=1e-12)
