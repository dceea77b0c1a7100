"""Whether a plot variable is computed is found without reading what no part can be."""

from pathlib import Path

import numpy as np
import pytest

import febkit
from febkit.model import Mesh, Model, Output, PlotVariable
from febkit.output import plot, plotfile
from febkit.results.variables import VARIABLES


@pytest.fixture
def read(monkeypatch):
    names, load = [], plot.physics.load
    monkeypatch.setattr(plot.physics, "load", lambda name: names.append(name) or load(name))
    return names


def test_a_biphasic_variable_asks_no_mixed_element(read):
    assert plot.find("fluid flux", False)
    assert "three-field" not in read


def test_a_variable_of_no_plotfile_asks_no_physics(read, tmp_path):
    said = []
    asked = (PlotVariable("nonsense"), PlotVariable("displacement"))
    mesh = Mesh(np.zeros(0, int), np.zeros((0, 3)))
    model = Model("4.0", "solid", mesh, (), (), output=Output(plot=asked))
    plotfile.PlotListener(model, tmp_path / "a.xplt", said.append).writer.discard()
    assert len(said) == 1 and "nonsense" in said[0] and read == []


def test_every_variable_is_in_the_file_that_the_table_says():
    for file, names in plot.FILES.items():
        for name in names:
            assert plot.find(name) is not None
            source = (Path(plot.__file__).parent / f"{file}.py").read_text()
            assert f'"{name}"' in source, f"{name} is not registered in {file}.py"
            assert name in VARIABLES, f"{name} has no storage in febkit/results/variables.py"
    assert set(plot.base.table) == {n for names in plot.FILES.values() for n in names}


@pytest.mark.parametrize(
    "strange", ["mesh_data['none']", "parameter['fem.material[7].E']", "field['none']", "stress['solid[0]']", "strain"]
)
def test_a_variable_that_does_not_exist_is_named_and_left_out(tmp_path, strange):
    text = (Path(__file__).parent / "data" / "maps.feb").read_text()
    variables = f'<var type="{strange}"/><var type="displacement"/>'
    asked = f'<Output><plotfile type="febio">{variables}</plotfile></Output>'
    (tmp_path / "a.feb").write_text(text.replace("<Output/>", asked))
    told: list[str] = []
    written = plotfile.PlotListener(febkit.read(tmp_path / "a.feb").record, tmp_path / "a.xplt", told.append)
    assert told == [f'plot variable "{strange}" is not computed by febkit and is left out']
    assert [v.name for v in written.variables] == ["displacement"]
    written.__exit__()
