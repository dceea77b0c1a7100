"""Element data that take the place of a material's <fiber>, as FEBio has it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import febkit
from febkit.model import InputError
from helpers import cube

FIBER = '<material id="1" name="m" type="coupled trans-iso Mooney-Rivlin"><c1>1</c1><k>10</k><c3>5</c3><c4>2</c4>'
PLAIN = FIBER + "<c5>30</c5><lam_max>1.2</lam_max>{}</material>"
MIXED = ('<material id="1" name="m" type="solid mixture"><solid type="neo-Hookean"><E>3</E><v>0.2</v></solid>'
         '<solid type="fiber-exp-pow"><alpha>1</alpha><beta>3</beta><ksi>5</ksi>{}</solid></material>')
GIVEN = '<fiber type="vector"><vector>0.6,0,0.8</vector></fiber>'
OTHER = '<fiber type="vector"><vector>0,1,0</vector></fiber>'
DATA = ('<MeshData><ElementData name="Fibers" type="{}" elem_set="cube"><e lid="1">0.3,0,0.4</e></ElementData>'
        "</MeshData>")
CONTROL = ("<time_steps>5</time_steps><step_size>0.2</step_size>"
           '<solver type="solid"><dtol>1e-7</dtol><etol>1e-12</etol></solver>')
PULL = ('<Loads><nodal_load type="nodal_load" node_set="top"><dof>z</dof><scale lc="1">0.3</scale></nodal_load></Loads>'
        '<LoadData><load_controller id="1" type="loadcurve"><points><pt>0,0</pt><pt>1,1</pt></points></load_controller>'
        "</LoadData>")  # fmt: skip


def solved(folder: Path, material: str, data: str = "") -> np.ndarray:
    model = cube.read(folder, cube.text(material, control=CONTROL, more=data + PULL))
    result = febkit.solve(model)
    assert result.converged, result.reason
    return np.asarray(result.state.u)


@pytest.mark.parametrize(("material", "path", "febio"), [
    (PLAIN, "fiber", (-0.123764776, -0.0313036889, 0.132662132)),
    (MIXED, "solid[1].fiber", (-0.20249632, -0.0266440902, 0.26242587)),
])  # fmt: skip
@pytest.mark.parametrize("own", [OTHER, '<fiber type="vector"/>', ""])
def test_element_data_count_more_than_the_material_s_own(
    tmp_path: Path, material: str, path: str, febio: tuple[float, ...], own: str
) -> None:
    """A name beside the type is only a name. FEBio 4.11's displacement of node 7."""
    u = solved(tmp_path, material.format(own), DATA.format(path))
    np.testing.assert_allclose(u, solved(tmp_path, material.format(GIVEN)), rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(u[6], febio, rtol=1e-6)
    assert np.abs(u - solved(tmp_path, material.format(OTHER))).max() > 1e-3


def test_each_element_needs_its_fiber(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="three numbers for each element"):
        solved(tmp_path, PLAIN.format(""), DATA.format("fiber").replace("0.3,0,0.4", "0.3,0"))
