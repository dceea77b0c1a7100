"""The study's templates as charged mixtures: materials, bath, initial equilibrium, names of one's own."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from febkit.feb import read, write
from febkit.model import Component, InputError, Model, Where
from febkit.templates import new
from febkit.templates.expression import evaluate

R, T = 8.314e-6, 298.0  # N mm / (nmol K), K


def charged(name: str, **given: Any) -> Model:
    return new(name, size="small", physics="triphasic", **given)


def leaves(c: Component) -> list[Component]:
    return [c] if not c.children else [x for child in c for x in leaves(child)]


def value(c: Component) -> float:
    return c.need("value").as_float()


@pytest.mark.parametrize("name", ["tissue", "cell", "embedded"])
def test_every_material_is_a_mixture_of_the_same_ions(name: str) -> None:
    model = charged(name, ecm_charge=-120.0)
    assert model.module == "multiphasic" and model.constants == {"T": T, "R": R, "Fc": 9.65e-5}
    assert [m.type for m in model.materials] == ["multiphasic"] * (1 if name == "tissue" else 3)
    assert model.materials[0].float("fixed_charge_density") == -120.0
    for m in model.materials:
        assert [s.attrs["sol"] for s in m.all("solute")] == ["Na+", "Cl-"]
        assert [s.need("diffusivity").float("free_diff") for s in m.all("solute")] == [1.33e-3, 2.03e-3]


@pytest.mark.parametrize("name", ["tissue", "embedded"])
@pytest.mark.parametrize("case", "AB")
def test_drained_faces_lie_in_the_bath_and_everything_starts_in_equilibrium_with_it(name: str, case: str) -> None:
    model = charged(name, case=case, bath=140.0)
    bc = {c.name: c for c in model.common.boundary}
    faces = ["top", "bottom"] if case == "A" else ["top"]
    assert {n for n in bc if n.startswith(("drained", "bath"))} == {
        *(f"drained {f}" for f in faces), *(f"bath {f} c{k}" for f in faces for k in (1, 2))}
    # no pressure in the bath: its effective pressure is minus the osmotic pressure of its two ions
    assert value(bc["drained top"]) == pytest.approx(-R * T * 2 * 140.0, rel=1e-11)
    assert value(bc["bath top c2"]) == 140.0
    start = {c.type: c for c in model.common.initial}
    assert value(start["initial fluid pressure"]) == pytest.approx(-R * T * 2 * 140.0, rel=1e-11)
    assert [value(c) for c in model.common.initial if c.type == "initial concentration"] == [140.0, 140.0]
    assert np.array_equal(model.mesh.node_sets["all"].nodes, np.arange(len(model.mesh.X)))


def test_a_biphasic_model_holds_nothing_of_it() -> None:
    model = new("embedded", size="small")
    assert "all" not in model.mesh.node_sets and not model.common.initial and not model.unknown
    assert model.constants == {"T": 0.0, "R": 0.0, "Fc": 0.0}


@pytest.mark.parametrize("name", ["tissue", "cell"])
def test_a_charged_file_reads_back(name: str, tmp_path: Path) -> None:
    model = charged(name)
    write(model, tmp_path / "m.feb")
    back = read(tmp_path / "m.feb")
    assert back.module == "multiphasic"
    assert [c.text for m in back.materials for c in leaves(m)] == [c.text for m in model.materials for c in leaves(m)]
    assert len(back.common.initial) == 3
    kinds = {v.type for v in back.output.plot}
    assert {"effective solute concentration", "electric potential", "solute flux"} <= kinds


def test_names_of_a_template_of_ones_own(tmp_path: Path) -> None:
    (tmp_path / "template.toml").write_text(
        'title = "mine"\nbase = "tissue"\n[names]\nbath_pressure = "-7.0"\n[parameters]\nphysics = "triphasic"\n')
    model = new("tissue", template=tmp_path, size="small")
    assert value(next(c for c in model.common.boundary if c.name == "drained top")) == -7.0
    (tmp_path / "template.toml").write_text('title = "mine"\nbase = "tissue"\n[names]\nbath_pressure = "2 * nothing"\n')
    with pytest.raises(InputError, match=r"\[names\].*nothing"):
        new("tissue", template=tmp_path, size="small", physics="triphasic")


def test_expressions_put_lists_into_lists() -> None:
    assert evaluate("[0, *x, 9]", {"x": [1, 2]}) == [0, 1, 2, 9]
    with pytest.raises(InputError, match="not iterable"):
        evaluate("[*x]", {"x": 1}, Where("here"))


def test_a_choice_brings_values_along_that_may_be_given_all_the_same() -> None:
    times = [t for t, _ in charged("tissue").controllers[1].points]
    assert charged("tissue").controllers[0].points[1] == (10, 1) and times[-1] == 200
    assert charged("tissue", ramp=5.0).controllers[0].points[1] == (5, 1)
    assert new("tissue", size="small").controllers[0].points[1] == (0.1, 1)
