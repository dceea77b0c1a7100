"""Element data made of surfaces."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from febkit.lower import lower
from febkit.model import InputError, UnsupportedError
from febkit.solver.points import Points
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
