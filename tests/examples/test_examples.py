"""Examples are tests: each runs small and gives its pinned number."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import febkit
from febkit import study, templates
from helpers.files import load

FOLDER = Path(__file__).parents[2] / "examples"


def example(name: str) -> Any:
    return load(FOLDER / f"{name}.py")


def test_confined_compression_meets_the_series() -> None:
    assert example("confined_compression").main(10, 0.05) < 0.015


def test_unconfined_compression_is_what_its_script_writes() -> None:
    assert (FOLDER / "unconfined_compression.feb").read_text() == example("unconfined_compression").text()


def test_unconfined_compression(tmp_path: Path) -> None:
    """Before fluid has left, an incompressible plug carries a third of its axial stress as pressure."""
    share = example("unconfined_compression").main(tmp_path, n=2, layers=2, end=150.0)
    assert share == pytest.approx(PINNED_SHARE, rel=2e-3)
    assert share == pytest.approx(1 / 3, abs=0.05)


def test_edit_and_solve(tmp_path: Path) -> None:
    """At equilibrium the force is proportional to Young's modulus."""
    (tmp_path / "m.feb").write_text(example("unconfined_compression").text(2, 2, 20000.0))
    assert example("edit_and_solve").main(febkit.read(tmp_path / "m.feb")) == pytest.approx(2.0, rel=2e-3)


STUDIES = ["biomultiscale", "study_depths", "study_full", "study_reduced", "study_size", "study_triphasic"]


@pytest.mark.parametrize("name", STUDIES)
def test_studies_can_be_planned(name: str) -> None:
    assert study.make_plan(study.read(FOLDER / f"{name}.toml")).metrics


def test_the_matrix_of_biomultiscales_cells_is_its_tissue_where_they_are() -> None:
    s = study.read(FOLDER / "biomultiscale.toml")
    table = np.genfromtxt(FOLDER / "biomultiscale_tissue.csv", delimiter=",", names=True, skip_header=3)
    for k, (_, _, z) in enumerate(s.points):
        cell = s.cells(k, 0)
        for name, column in (("ecm_E", "E"), ("ecm_beta", "beta"), ("phi0", "phi0")):
            assert cell[name] == pytest.approx(np.interp(1 - z / 0.5, table["depth"], table[column]), rel=1e-5)


def test_the_smallest_cube_has_a_cell_for_each_seed_of_the_study_of_sizes() -> None:
    s = study.read(FOLDER / "study_size.toml")
    for seed in s.seeds:
        model = templates.new("cell", **(s.cells(0, 0) | {"seed": seed}))
        assert model.mesh.part_lists["cells"] == ("cell_1",)


def test_donnan_swelling() -> None:
    """Charged tissue in 150 mmol/l of salt swells by half, as the balance of stress and Donnan pressure has it."""
    found, expected = example("donnan_swelling").main(150.0, n=2)
    assert found == pytest.approx(PINNED_SWELLING, rel=1e-5) and found == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize("height", [0.333, 0.667, 0.889])
def test_a_published_fit_comes_out(height: float) -> None:
    """E and beta as their authors print them, of a closed form that no finite elements are in."""
    here = example("fit_over_depth")
    layer = next(q for q in here.LAYERS if q.height == height)
    f = here.fitted(layer)
    assert f.converged and f["tissue.solid.E"] == pytest.approx(layer.E, rel=1e-3)
    assert f["tissue.solid.beta"] == pytest.approx(layer.beta, rel=1e-3, abs=1e-5)


def test_the_model_of_the_page_on_mixtures_is_that_of_the_example() -> None:
    """The page's block of Python, run as it stands."""
    page = (FOLDER.parent / "docs" / "mixtures.md").read_text()
    there: dict[str, Any] = {}
    exec(page.split("```python\n")[1].split("```")[0], there)
    assert there["result"].converged
    swelling = (1 + there["result"].state.u.max(axis=0)).prod()
    assert swelling == pytest.approx(PINNED_SWELLING, rel=1e-4)


PINNED_SHARE = 0.37553
PINNED_SWELLING = 1.48612
