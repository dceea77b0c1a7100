"""Whether a plot variable is computed is found without reading what no part can be."""

import numpy as np
import pytest

from febkit.model import Mesh, Model, Output, PlotVariable
from febkit.output import fields, plotfile


@pytest.fixture
def read(monkeypatch):
    names, load = [], fields.physics.load
    monkeypatch.setattr(fields.physics, "load", lambda name: names.append(name) or load(name))
    return names


def test_a_biphasic_variable_asks_no_mixed_element(read):
    assert fields.known("fluid flux", False)
    assert "three-field" not in read


def test_a_variable_of_no_plotfile_asks_no_physics(read, tmp_path):
    said = []
    asked = (PlotVariable("nonsense"), PlotVariable("sbm concentration", surface="top"))
    mesh = Mesh(np.zeros(0, int), np.zeros((0, 3)))
    model = Model("4.0", "solid", mesh, (), (), output=Output(plot=asked))
    plotfile.PlotListener(model, tmp_path / "a.xplt", said.append).writer.discard()
    assert len(said) == 2 and read == []
