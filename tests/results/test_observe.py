"""Observables in words, against the same questions asked of the dataset."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

import febkit
from febkit.model import InputError
from febkit.observe import observable, observables, variables


@pytest.fixture(scope="module")
def ds() -> xr.Dataset:
    """A bar of eight elements in two sets, held across below and drawn out and sheared above."""
    m = febkit.Model("solid", units="mm-N-s")
    m.add_block("bar", (1, 1, 2), (2, 2, 2))
    m.element_sets["above"], m.element_sets["below"] = range(5, 9), range(1, 5)
    m.materials["soft"] = febkit.materials.NeoHookean(E=2, v=0.3)
    m.node_sets["top"], m.surfaces["face"] = m.nodes(z="max"), m.faces(z="max")
    m.fix(m.nodes(z="min"), "x", "y", "z")
    m.prescribe("top", z=0.2, x=0.1, curve=[(0, 0), (1, 1)])
    m.step(time=1, dt=0.5)
    return m.solve().dataset


def test_words_say_what_the_accessor_gives(ds: xr.Dataset) -> None:
    f = ds.febkit
    wanted = {
        "reaction top z": f.reaction("top").sel(xyz="z"),
        "reaction top": np.sqrt((f.reaction("top") ** 2).sum("xyz")),
        "displacement set top z": f.node_set("top")["displacement"].sel(xyz="z").mean("node"),
        "displacement node 14 x": f.node(14)["displacement"].sel(xyz="x"),
        "stress part above zz": f.mean("stress:zz", part="above"),
        "stress element 7 zz": f.element(7)["stress"].sel(voigt="zz"),
        "principal_strain part below first": f.mean("principal_strain:first", part="below"),
        "reaction forces surface face z": f.node_set("face")["reaction_forces"].sel(xyz="z").sum("node"),
    }
    for words, value in wanted.items():
        got = observable(words)(ds)
        assert got.dims == ("time",) and got.name == words and np.abs(value).max() > 1e-6
        np.testing.assert_allclose(got.values, value.values, rtol=1e-6, err_msg=words)
    assert observable("reaction top z")(ds).attrs["units"] == "N"


def test_functions_and_names(ds: xr.Dataset) -> None:
    def peak(d: xr.Dataset) -> float:
        return float(d.febkit.reaction("top").sel(xyz="z").max())

    chosen = observables({"force": "reaction top z", "peak": peak})
    assert float(chosen["peak"](ds)) == chosen["force"](ds).max() > 0 and chosen["peak"](ds).name == "peak"
    assert list(observables([peak, "reaction top z"])) == ["peak", "reaction top z"]
    with pytest.raises(InputError, match="one for each state"):
        observable(lambda d: np.zeros((2, 2)))(ds)


def test_what_a_run_must_keep(ds: xr.Dataset) -> None:
    record = febkit.Model("solid").record
    said = observables(["reaction top z", "stress part above zz", "effective_strain part above"])
    assert variables(said, record) == ["reaction forces", "stress", "displacement"]
    assert variables(observables([lambda d: 0.0]), record) is None
    assert observable("pressure part plug").variables == ("effective fluid pressure", "displacement")


@pytest.mark.parametrize(
    ("words", "why"),
    [
        ("top z", "reaction top z"),
        ("strss part above", "'stress'"),
        ("displacement node top z", "no id"),
        ('reaction "top', "quotation"),
    ],
)
def test_words_that_say_nothing(words: str, why: str) -> None:
    with pytest.raises(InputError, match=why):
        observable(words)
