"""``febkit new`` from the command line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

from febkit.cli.new import command
from febkit.feb import read
from febkit.model import InputError


def run(*args: str) -> Result:
    return CliRunner().invoke(command, list(args))


@pytest.mark.parametrize("name", ["tissue", "cell", "embedded", "chondron"])
def test_writes_a_model_and_says_what_it_is(name: str, tmp_path: Path) -> None:
    out = tmp_path / "m.feb"
    result = run(name, "--case", "B", "--set", "size=small", "-o", str(out))
    assert result.exit_code == 0, result.output
    model = read(out)
    assert f"elements: {sum(len(b.ids) for b in model.mesh.blocks)}" in result.output
    assert "scaled Jacobian" in result.output
    assert model.module == "biphasic"


def test_values_from_file_and_command_line(tmp_path: Path) -> None:
    (tmp_path / "p.toml").write_text('case = "D"\nn = 5\necm_E = 3.0\n')
    out = tmp_path / "m.feb"
    result = run("tissue", "--params", str(tmp_path / "p.toml"), "--set", "n=3", "--set", "times=0,0.1,2",
                 "-o", str(out))
    assert result.exit_code == 0, result.output
    model = read(out)
    assert len(model.mesh.blocks[0].ids) == 27
    assert model.materials[0].need("solid").float("E") == 3.0
    assert [t for t, _ in model.controllers[1].points] == [0, 0.1, 2]
    top = next(c for c in model.common.boundary if c.name == "top")
    assert top.need("value").type == "math"


def test_mesh_file_is_beside_the_parameters(tmp_path: Path) -> None:
    meshio = pytest.importorskip("meshio")
    X = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
    meshio.Mesh(X, [("tetra", np.array([[0, 1, 2, 3]]))]).write(tmp_path / "one.vtk")
    (tmp_path / "p.toml").write_text('mesh_file = "one.vtk"\ndrive = "none"\n')
    result = run("cell", "--params", str(tmp_path / "p.toml"), "-o", str(tmp_path / "m.feb"))
    assert result.exit_code == 0, result.output
    assert read(tmp_path / "m.feb").mesh.blocks[0].type == "tet4"


def test_profiles_of_cartilage_come_from_csv_files(tmp_path: Path) -> None:
    """Relative to the file that names them; never written over."""
    (tmp_path / "E.csv").write_text("depth,E\n0,0.2\n1,0.8\n")
    (tmp_path / "p.toml").write_text('size = "small"\nE = "E.csv"\nzones = {all = 1.0}\nfibres = "none"\n')
    out = tmp_path / "m.feb"
    k0 = "k0=[[0, 1e-3], [1, 2e-3]]"
    result = run("cartilage", "--params", str(tmp_path / "p.toml"), "--set", k0, "-o", str(out))
    assert result.exit_code == 0, result.output
    assert "all: 10 elements, depth 0.05 to 0.95" in result.output
    maps = {d.name: d.values for d in read(out).mesh_data}
    assert np.allclose(maps["E_all"], 0.23 + 0.06 * np.arange(10)[:, None])
    assert np.allclose(maps["k0_all"], 1.05e-3 + 1e-4 * np.arange(10)[:, None])
    (tmp_path / "E.feb").write_text("0 1\n1 2\n")  # whatever its name
    result = run("cartilage", "--set", f"E={tmp_path / 'E.feb'}", "-o", str(tmp_path / "E.feb"), "--force")
    assert isinstance(result.exception, InputError) and (tmp_path / "E.feb").read_text() == "0 1\n1 2\n"


def test_lists_its_parameters() -> None:
    result = run("cell", "--parameters")
    assert result.exit_code == 0
    for words in ("diameter = 0.01 mm", "seed = 1", "case = A", "size = small"):
        assert words in result.output


@pytest.mark.parametrize(("args", "words"), [
    (("tissue", "--set", "n"), "name=value"), (("tissue", "--set", "m=3"), "no parameter"),
    (("bone",), "no template"), (("cartilage", "--set", "E=none.csv"), "cannot read none.csv"),
    (("cartilage", "--set", "E=[[0, 1], [0, 2]]"), "must rise"),
])
def test_mistakes_are_named(args: tuple[str, ...], words: str) -> None:
    result = run(*args)
    assert isinstance(result.exception, InputError)
    assert words in str(result.exception)
