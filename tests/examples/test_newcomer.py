"""What a newcomer asks for first, each in few lines of ordinary code: counted, run as they stand, and checked."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
from scipy.optimize import brentq

import febkit

FOLDER = Path(__file__).parents[2] / "examples" / "newcomer"
MOST = {"plug": 15, "plug_numpy": 15, "plug_gmsh": 15, "sweep": 8, "reaction": 3, "strain": 3, "paraview": 1, "edit": 3}
WIDEST = 110


def lines_of_code(path: Path) -> int:
    """Lines that hold code: without the docstring, imports, comments and blank lines."""
    text = path.read_text()
    body = ast.parse(text).body
    asides = [s for s in body if isinstance(s, (ast.Import, ast.ImportFrom))] + body[:1]
    aside = {n for s in asides for n in range(s.lineno, (s.end_lineno or s.lineno) + 1)}
    lines = enumerate(text.splitlines(), 1)
    return sum(n not in aside and bool(s.strip()) and not s.strip().startswith("#") for n, s in lines)


def run(name: str) -> dict[str, Any]:
    """The names that a script leaves, run in the present folder."""
    there: dict[str, Any] = {}
    exec(compile((FOLDER / f"{name}.py").read_text(), f"{name}.py", "exec"), there)
    return there


@pytest.fixture(scope="module")
def solved(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Any]]:
    """A folder with plug.feb and plug.xplt, and what the script that builds them leaves."""
    folder = tmp_path_factory.mktemp("newcomer")
    there = run("plug")
    there["m"].write(folder / "plug.feb")
    there["m"].solve(folder / "plug.xplt")
    return folder, there


@pytest.fixture
def here(solved: tuple[Path, dict[str, Any]], monkeypatch: pytest.MonkeyPatch) -> Path:
    pytest.importorskip("matplotlib").use("agg")
    monkeypatch.chdir(solved[0])
    return solved[0]


def equilibrium(E: float, v: float, strain: float) -> tuple[float, float]:
    """Axial Cauchy stress and area ratio of a neo-Hookean body shortened by ``strain`` whose sides are free.

    sigma = (mu (b - 1) + lambda ln J) / J (Bonet & Wood, eq 5.29)
    """
    mu, lam, axial = E / 2 / (1 + v), E * v / (1 + v) / (1 - 2 * v), 1 - strain

    def stress(stretch: float, side: float) -> float:
        J = axial * side**2
        return (mu * (stretch**2 - 1) + lam * np.log(J)) / J

    side = float(brentq(lambda s: stress(s, s), 0.9, 1.2))
    return stress(axial, side), side**2


@pytest.mark.parametrize("name", MOST)
def test_it_takes_few_lines(name: str) -> None:
    assert lines_of_code(FOLDER / f"{name}.py") <= MOST[name]
    assert max(map(len, (FOLDER / f"{name}.py").read_text().splitlines())) <= WIDEST
    assert {p.stem for p in FOLDER.glob("*.py")} == set(MOST)


def test_the_count_counts(tmp_path: Path) -> None:
    path = tmp_path / "a.py"
    path.write_text('"""Two\nlines."""\n\nimport os\nfrom os import (\n path\n)\n\n# aside\na = [\n    1\n]\nb = a')
    assert lines_of_code(path) == 4


def test_a_plug_relaxes_to_the_stress_of_its_solid(solved: tuple[Path, dict[str, Any]]) -> None:
    m, force = solved[1]["m"], solved[1]["force"]
    stress, grown = equilibrium(0.6, 0.1, 0.05)
    (quads,) = m.faces(z="max").facets.values()
    a, b = (m.X[quads[:, k + 2], :2] - m.X[quads[:, k], :2] for k in (0, 1))
    area = 0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum()
    assert solved[1]["result"].converged
    assert float(force[-1]) == pytest.approx(stress * grown * area, rel=1e-4)
    assert float(force.min()) < 1.2 * float(force[-1])  # what the fluid bears at first


def test_a_block_of_arrays(here: Path) -> None:
    there = run("plug_numpy")
    stress = plane(0.6, 0.1, 0.05)
    force = -there["result"].dataset["reaction_forces"].values[-1, there["X"][:, 2] == 1, 2].sum()
    assert there["result"].converged and force == pytest.approx(stress, rel=1e-3)


def plane(E: float, v: float, strain: float) -> float:
    """Nominal axial stress of the same body held in y."""
    mu, lam, axial = E / 2 / (1 + v), E * v / (1 + v) / (1 - 2 * v), 1 - strain
    side = float(brentq(lambda s: mu * (s**2 - 1) + lam * np.log(axial * s), 0.9, 1.2))
    return float(mu * (axial**2 - 1) + lam * np.log(axial * side)) / axial


def test_a_mesh_of_gmsh(here: Path) -> None:
    """The plug's own mesh, written as gmsh writes physical groups, gives the plug's force."""
    m = febkit.read("plug.feb")
    side = m.faces(where=lambda X: X[:, 0] ** 2 + X[:, 1] ** 2 > 0.998)
    groups = {"bottom": m.faces(z="min"), "top": m.faces(z="max"), "side": side}
    cells = [("hexahedron", m.mesh.blocks[0].conn), *(("quad", g.facets["quad4"]) for g in groups.values())]
    tags = [np.full(len(c), k + 1) for k, (_, c) in enumerate(cells)]
    names = {"plug": np.array([1, 3])} | {n: np.array([k + 2, 2]) for k, n in enumerate(groups)}
    mesh = meshio.Mesh(m.X, cells, cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags}, field_data=names)
    meshio.write("plug.msh", mesh, "gmsh22", binary=False)
    there = run("plug_gmsh")
    expected = febkit.open_results("plug.xplt").febkit.reaction("top").sel(xyz="z")
    assert np.allclose(there["force"].values, expected.values, rtol=1e-5, atol=1e-9)


def test_a_sweep_gives_what_edited_files_give(here: Path) -> None:
    there = run("sweep")
    assert (here / "sweep.png").stat().st_size > 5000
    text = Path("plug.feb").read_text()
    Path("soft.feb").write_text(text.replace("<E>0.6</E>", "<E>0.3</E>"))
    assert text != Path("soft.feb").read_text()
    force = febkit.read("soft.feb").solve().dataset.febkit.reaction("top").sel(xyz="z")
    assert float(there["peaks"][0]) == pytest.approx(-float(force.min()), rel=1e-9)
    assert np.all(np.diff(there["peaks"]) > 0)


def test_reaction_and_strain_of_a_plotfile(here: Path, solved: tuple[Path, dict[str, Any]]) -> None:
    assert np.array_equal(run("reaction")["force"].values, solved[1]["force"].values)
    strain = run("strain")["strain"]
    assert float(strain[-1]) == pytest.approx(0.5 * (0.95**2 - 1), rel=1e-4)


def test_a_series_for_paraview(here: Path) -> None:
    run("paraview")
    states = sorted(here.glob("plug*.vtu")) or sorted(here.glob("plug*/*.vtu"))
    ds = febkit.open_results("plug.xplt")
    assert Path("plug.pvd").read_text().count("<DataSet") == ds.sizes["time"] == len(states)
    last = meshio.read(states[-1])
    assert np.allclose(last.point_data["displacement"], ds["displacement"].values[-1])


def test_one_line_of_the_file_changes(here: Path) -> None:
    run("edit")
    before, after = Path("plug.feb").read_text().splitlines(), Path("stiffer.feb").read_text().splitlines()
    changed = [(a, b) for a, b in zip(before, after, strict=True) if a != b]
    assert [(a.strip(), b.strip()) for a, b in changed] == [("<E>0.6</E>", "<E>0.8</E>")]


def test_nothing_of_it_imports_numba_but_solving(here: Path) -> None:
    """Opening, editing, converting: what is looked at needs no compiler."""
    program = "".join((FOLDER / f"{n}.py").read_text() for n in ("edit", "paraview", "strain", "reaction"))
    done = subprocess.run(
        [sys.executable, "-c", program + "\nimport sys\nprint('numba' in sys.modules)\n"], cwd=here, check=False,
        capture_output=True, text=True, env={**os.environ, "MPLBACKEND": "agg"})  # fmt: skip
    assert done.stdout.strip() == "False", done.stderr
