"""One chondron in a block of its own: three superellipsoids, any materials, a membrane that the metrics see through."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import febkit
from febkit.feb import read, validate, write
from febkit.metrics import cell_metrics
from febkit.metrics.groups import make
from febkit.metrics.selection import select_cells
from febkit.metrics.sources import Sources
from febkit.model import InputError, Where
from febkit.templates import new
from febkit.templates.chondron_block import chondron_block
from febkit.templates.quality import judge, volumes
from febkit.templates.template import load
from helpers.forked import febkit as verb

SHIFTS = {"neutral": 0.0, "thin_top": 0.000195640327, "thin_bottom": -0.000195640327}


def values(**given: Any) -> dict[str, Any]:
    return load("chondron").values([(given, Where())])


@pytest.mark.parametrize("shift", SHIFTS.values(), ids=SHIFTS)
def test_sizes_are_those_of_biomultiscale(shift: float) -> None:
    """Radii of 6, 3, 2 and 6.976, 3.9763, 2.9175 um, squareness 2.3, 90 % of ECM: the YAML's numbers."""
    made = chondron_block(values(shift=shift))
    mesh, parts = made.mesh, made.mesh.parts
    quality = judge(mesh.X, list(parts.values()))
    assert quality.jacobian_min > 0.7 and quality.scaled_jacobian_min > 0.3
    inner = mesh.X[np.intersect1d(parts["cell_1"][1], parts["pcm_1"][1])] - [0, 0, shift]
    outer = mesh.X[np.intersect1d(parts["pcm_1"][1], parts["ecm"][1])]
    for x, radii in ((inner, [6, 3, 2]), (outer, [6.976, 3.9763, 2.9175]),
                     (mesh.X[-len(outer):], np.array([6.976, 3.9763, 2.9175]) * 10 ** (1 / 3))):  # fmt: skip
        assert np.allclose((np.abs(x / (np.array(radii) * 1e-3)) ** 2.3).sum(axis=1), 1.0, rtol=1e-9)


def test_volumes_of_all_three_are_of_second_order() -> None:
    missing = []
    for divisions in (6, 12):
        made = chondron_block(values(divisions=[divisions] * 3, layers=[1, 1, 1], shift=0.0002))
        cell, pcm = made.chondron.volumes
        for name, exact in {"cell_1": cell, "pcm_1": pcm, "ecm": made.whole.volume - cell - pcm}.items():
            missing.append(1.0 - volumes(made.mesh.X, *made.mesh.parts[name]).sum() / exact)
    coarse, fine = np.array(missing).reshape(2, 3)
    assert np.allclose(np.log2(coarse / fine), 2.0, atol=0.1) and (fine < 0.02).all()
    assert cell + pcm == pytest.approx(0.1 * made.whole.volume)


def test_a_turned_block() -> None:
    still, turned = (chondron_block(values(size="small", orientation=o)).mesh for o in ("aligned", [[0.0, 0.0, 0.5]]))
    assert not np.allclose(turned.X, still.X)
    assert np.allclose(np.linalg.norm(turned.X, axis=1), np.linalg.norm(still.X, axis=1))


def test_materials_as_biomultiscale_has_them() -> None:
    model = new("chondron", size="small", ecm_E=0.2, ecm_k=0.004)
    ecm, pcm, cell, membrane = model.materials
    fibres = ecm.need("solid").all("solid")[1]
    assert (fibres.type, fibres.need("ksi").as_floats()) == ("ellipsoidal fiber distribution", (2.8, 1.6, 1.6))
    assert ecm.need("solid").all("solid")[0].float("E") == 0.2
    assert pcm.need("solid").float("E") == pytest.approx(0.02)
    assert pcm.need("permeability").float("perm") == pytest.approx(0.005)
    assert cell.need("solid").float("v") == 0.0 and cell.float("phi0") == 0.1
    assert membrane.need("permeability").float("perm") == 7e-10
    shell = next(d for d in model.domains if d.kind == "shell")
    assert (shell.block, shell.material) == ("membrane_1", "membrane")
    assert shell.spec is not None and shell.spec.float("shell_thickness") == 1e-5
    outwards = model.mesh.surfaces["cell_1_surface"].facets["quad4"]
    assert np.array_equal(next(b for b in model.mesh.blocks if b.type == "quad4").conn, outwards)
    assert model.mesh.part_lists["membranes"] == ("membrane_1",)


def test_no_membrane() -> None:
    model = new("chondron", size="small", membrane_thickness=0.0)
    assert [m.name for m in model.materials] == ["ecm", "pcm", "chondrocyte"]
    assert all(d.kind == "solid" for d in model.domains)


TABLES = """size = "small"
[ecm]
type = "Mooney-Rivlin"
c1 = 0.1
c2 = "${0.1*ecm_E}"
k = 1.0
[pcm]
file = "others.feb"
material = "deep zone"
[cell]
type = "biphasic"
phi0 = 0.3
solid = {type = "neo-Hookean", E = 0.002, v = 0.1}
permeability = {type = "perm-const-iso", perm = 0.001}
"""


def test_materials_from_tables_and_from_another_model(tmp_path: Path) -> None:
    deep = {"type": "Holmes-Mow", "E": 0.07, "v": 0.1, "beta": 1.2, "phi0": 0.25}
    other = new("chondron", size="small", ecm=deep)
    text = write_text(other, tmp_path / "others.feb").replace('name="ecm" type="bi', 'name="deep zone" type="bi')
    (tmp_path / "others.feb").write_text(text)
    (tmp_path / "mine.toml").write_text(TABLES)
    (tmp_path / "elsewhere").mkdir()
    made = verb("new", "chondron", "--params", "../mine.toml", "-o", "c.feb", folder=tmp_path / "elsewhere")
    assert made.returncode == 0, made.stderr
    ecm, pcm, cell, _ = read(tmp_path / "elsewhere/c.feb").materials
    assert ecm.need("solid").type == "Mooney-Rivlin" and ecm.need("solid").float("c2") == pytest.approx(0.0049439)
    assert ecm.need("permeability").float("perm") == pytest.approx(0.002805295) and ecm.float("phi0") == 0.103996
    assert pcm.need("solid").float("beta") == 1.2 and pcm.float("phi0") == 0.25
    assert cell.float("phi0") == 0.3 and cell.need("solid").float("E") == 0.002
    assert not [f for f in validate(tmp_path / "elsewhere/c.feb", solvable=True) if f.severity != "hint"]


SOLID = {"type": "neo-Hookean", "E": 1.0, "v": 0.1}


@pytest.mark.parametrize("given", [{"membrane_thickness": 1e-5}, {"pcm": SOLID}, {"cell": SOLID}])
def test_materials_by_tables_and_parameters_are_in_order(given: dict[str, Any], tmp_path: Path) -> None:
    """FEBio counts materials from 1, in the order of the file."""
    write(new("cell", n=6, cells=1, edge=0.05, layers=[1, 1, 1], **given), tmp_path / "m.feb")
    assert not [f for f in validate(tmp_path / "m.feb", solvable=True) if f.severity in ("error", "unsupported")]


def write_text(model: Any, path: Path) -> str:
    write(model, path)
    return path.read_text()


@pytest.mark.parametrize(("given", "words"), [
    ({"ecm": {"E": 1.0}}, "a material needs its type"),
    ({"ecm": {"type": "Holms-Mow", "E": 1.0}}, "material 'ecm': unknown .*Holmes-Mow"),
    ({"pcm": {"type": "neo-Hookean", "E": 1.0, "nu": 0.2}}, "material 'pcm': <nu> is not a parameter of neo-Hookean"),
    ({"cell": {"type": "neo-Hookean", "E": 1.0, "v": 0.6}}, "material 'chondrocyte': .*v"),
    ({"membrane": {"type": "neo-Hookean", "E": 1.0, "v": 0.1, "a b": 1}}, "'a b' cannot be a tag"),
    ({"ecm": {"type": "neo-Hookean", "E": "${nothing}", "v": 0.1}}, "'nothing' is no parameter"),
    ({"ecm": {"file": "none.feb", "material": "x"}}, "none.feb"),
    ({"shift": 0.00095}, "PCM of cell 1 does not enclose it"),
    ({"physics": "triphasic"}, "one of biphasic"),
    ({"divisions": [4, 4]}, "3 entries"),
])  # fmt: skip
def test_what_cannot_be_is_refused(given: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        new("chondron", **{"size": "small", **given})


@pytest.fixture(scope="module")
def solved(tmp_path_factory: pytest.TempPathFactory) -> tuple[Any, Any]:
    """A coarse chondron in its membrane, every step of it written."""
    folder = tmp_path_factory.mktemp("membrane")
    model = new("chondron", divisions=[2, 2, 2], layers=[1, 1, 1], ramp=0.4, times=[0, 0.1, 0.2, 0.4], first_step=0.1,
                ramp_step=0.1, dtol=1e-6, etol=1e-10, ptol=1e-6)  # fmt: skip
    text = write_text(model, folder / "c.feb").replace("PLOT_MUST_POINTS", "PLOT_MAJOR_ITRS")
    (folder / "c.feb").write_text(text)
    made = febkit.read(folder / "c.feb")
    return made, made.solve().dataset


def test_exchange_through_a_membrane_is_the_loss_of_volume(solved: tuple[Any, Any]) -> None:
    model, ds = solved
    m = cell_metrics(ds, model, exchange="consistent")
    assert list(m["cell"].values) == ["cell_1"] and not m.attrs["missing"]
    rate, loss = m["mass_exchange_rate"].values[0, 1:], m["volume_loss_rate"].values[0, 1:]
    assert (loss > 0).all() and np.allclose(rate, loss, rtol=2e-3)
    assert np.isfinite(cell_metrics(ds, model)["mass_exchange_rate"].values[0, 1:]).all()


def test_a_membrane_holds_the_fluid_back(solved: tuple[Any, Any]) -> None:
    model, ds = solved
    last, kinds = ds.isel(time=-1), list(ds.attrs["element_types"])
    front = np.unique(ds["connectivity"].values[ds["element_type"].values == kinds.index("quad4")][:, :4])
    outside, inside = (last[v].values[front] for v in ("effective_fluid_pressure", "effective_shell_fluid_pressure"))
    assert inside.min() > 2 * outside.max() > 0
    seen = Sources(ds, model)
    group = make(ds, *(select_cells(ds).rows, select_cells(ds).owner), seen.parts)[0]
    p = seen.pressure(group, -1)  # at the nodes of the cell's elements: what is inside the membrane
    on = np.isin(group.nodes, front)
    assert on.any() and p[on].min() == inside.min() and p[on].max() == inside.max()
