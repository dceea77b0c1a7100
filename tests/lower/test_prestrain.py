"""Prestrain gradients given element by element."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from febkit.solver.points import Points
from helpers import cube

F0 = (1.1, 0.02, 0.0, 0.03, 0.9, 0.01, 0.0, 0.04, 1.05)
MATERIAL = """<material id="1" name="m" type="prestrain elastic">
<elastic type="neo-Hookean"><E>1</E><v>0.3</v></elastic>
<prestrain type="prestrain gradient"><ramp>0.5</ramp>{}</prestrain></material>"""


def gradient(folder: Path, leaf: str, more: str = "") -> np.ndarray:
    solid = cube.problem(folder, cube.text(MATERIAL.format(leaf), more=more)).blocks[0].solid
    pts = Points(np.eye(3)[None], np.ones(1), np.zeros((1, 3)), np.zeros(1, int))
    return np.asarray(solid.prestrain.gradient(pts)[0])


def test_a_map_gives_the_nine_numbers_of_each_element(tmp_path: Path) -> None:
    numbers = ",".join(map(str, F0))
    element = f'<e lid="1">{numbers}</e>'
    data = f'<MeshData><ElementData name="F0_map" elem_set="cube" data_type="mat3">{element}</ElementData></MeshData>'
    expected = 0.5 * np.eye(3) + 0.5 * np.reshape(F0, (3, 3))
    np.testing.assert_allclose(gradient(tmp_path, '<F0 type="map">F0_map</F0>', data), expected)
    np.testing.assert_allclose(gradient(tmp_path, f"<F0>{numbers}</F0>"), expected)
