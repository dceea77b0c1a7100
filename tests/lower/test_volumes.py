"""Micro-materials: solids whose stress is the mean of a representative volume in another file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import febkit
from febkit.lower import lower
from febkit.model import InputError, UnsupportedError
from febkit.solver.run import run
from helpers import cube, scenes

MICRO = '<material id="1" name="m" type="micro-material"><density>1</density><RVE>{}</RVE>{}</material>'
TIGHT = '<solver type="solid"><dtol>1e-9</dtol><etol>1e-16</etol><max_refs>50</max_refs></solver>'
CONTROL = f"<time_steps>2</time_steps><step_size>0.5</step_size>{TIGHT}"
SHEAR = """<bc node_set="top" type="prescribed displacement"><dof>x</dof><value lc="1">0.4</value></bc>
<bc node_set="top" type="prescribed displacement"><dof>z</dof><value lc="1">0.2</value></bc>
</Boundary><LoadData><load_controller id="1" type="loadcurve"><interpolate>LINEAR</interpolate>
<points><pt>0,0</pt><pt>1,1</pt></points></load_controller></LoadData>"""


def volume(folder: Path, materials: str = "", name: str = "v.rve", more: str = "") -> None:
    """Eight elements by turns of two materials, their inner node off the middle."""
    X, conn = scenes.grid((2, 2, 2))
    X[13] += (0.1, -0.05, 0.08)
    nodes = "\n".join(f'<node id="{k + 1}">{x},{y},{z}</node>' for k, (x, y, z) in enumerate(X.tolist()))
    parts, domains = "", ""
    for k, q in enumerate((conn[::2], conn[1::2])):
        nodes_of = [",".join(str(n + 1) for n in e) for e in q]
        rows = "\n".join(f'<elem id="{4 * k + i + 1}">{of}</elem>' for i, of in enumerate(nodes_of))
        parts += f'<Elements type="hex8" name="part{k}">\n{rows}\n</Elements>\n'
        domains += f'<SolidDomain name="part{k}" mat="m{k}"/>\n'
    solids = materials or "\n".join(
        f'<material id="{k + 1}" name="m{k}" type="neo-Hookean"><E>{E}</E><v>{v}</v></material>'
        for k, (E, v) in enumerate(((1, 0.3), (9, 0.2)))
    )
    control = TIGHT.replace("50", "25")
    (folder / name).write_text(f"""<?xml version="1.0"?>
<febio_spec version="4.0"><Module type="solid"/>
<Control><analysis>STATIC</analysis><time_steps>1</time_steps><step_size>1</step_size>{control}</Control>
<Material>{solids}
</Material>
<Mesh><Nodes name="nodes">
{nodes}
</Nodes>
{parts}<NodeSet name="some">1,2,3</NodeSet></Mesh>
<MeshDomains>{domains}</MeshDomains>{more}
</febio_spec>
""")


def model(folder: Path, name: str = "v.rve", more: str = "") -> febkit.Model:
    text = cube.text(MICRO.format(name, more), control=CONTROL).replace("</Boundary>", SHEAR)
    return cube.read(folder, text.replace("<Globals><Constants></Constants></Globals>\n", ""))


def test_answer_of_febio(tmp_path: Path) -> None:
    """A sheared and stretched element whose sides are free, by FEBio 4.11."""
    volume(tmp_path)
    result = run(lower(model(tmp_path)))
    assert result.converged, result.reason
    y = (0.03020999, 0.03013979, -0.02917642, -0.02897175)
    np.testing.assert_allclose(result.state.u[4:], [(0.4, v, 0.2) for v in y], atol=2e-7)
    np.testing.assert_allclose(result.state.u[:4], 0.0)


def test_boundary(tmp_path: Path) -> None:
    """Nodes on faces of one element alone, or those of a set."""
    volume(tmp_path)
    (block,) = lower(model(tmp_path)).blocks
    assert block.solid.RVE.boundary.tolist() == [n for n in range(27) if n != 13]  # type: ignore[attr-defined]
    (block,) = lower(model(tmp_path, more="<bc_set>some</bc_set><scale>2</scale>")).blocks
    rve = block.solid.RVE  # type: ignore[attr-defined]
    assert rve.boundary.tolist() == [0, 1, 2] and np.ptp(rve.state.X) == pytest.approx(2.0)


@pytest.mark.parametrize(("name", "more", "says"), [
    ("w.rve", "", 'there is no file "w.rve"'),
    ("../v.rve", "", 'there is no file "../v.rve" in the folder'),
    ("cube.feb", "", "volumes within volumes"),
    ("v.rve", "<rve_type>1</rve_type>", "<rve_type> other than 0"),
    ("v.rve", "<bc_set>most</bc_set>", 'no node set "most"'),
])  # fmt: skip
def test_faults_are_named(tmp_path: Path, name: str, more: str, says: str) -> None:
    volume(tmp_path)
    with pytest.raises((InputError, UnsupportedError), match=says) as e:
        lower(model(tmp_path, name, more))
    assert e.value.where is not None and e.value.where.line


def test_a_model_is_read_without_its_volume(tmp_path: Path) -> None:
    assert len(model(tmp_path, "w.rve").materials) == 1


def test_a_volume_that_something_acts_on_is_refused(tmp_path: Path) -> None:
    volume(tmp_path, more='<Loads><body_load type="body force"><force>0,0,1</force></body_load></Loads>')
    with pytest.raises(UnsupportedError, match="under no loads"):
        lower(model(tmp_path))
