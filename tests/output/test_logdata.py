"""Nodal and element data of <logfile>: the files hold what the final state says."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import febkit
from febkit.model import ElementSet, InputError, LogEntry, sets
from febkit.output.records import elements as records
from febkit.solver.physics.biphasic import BiphasicWork
from febkit.solver.physics.standard import StandardWork

EXAMPLE = Path(__file__).parents[2] / "examples" / "unconfined_compression.feb"


def _model(*entries: LogEntry, steps: int = 2) -> object:
    m = febkit.read(EXAMPLE).record
    return replace(m, output=replace(m.output, log=tuple(entries)))


def _last(path: Path) -> tuple[float, np.ndarray]:
    blocks = path.read_text().split("*Step")
    lines = blocks[-1].splitlines()
    rows = [[float(x) for x in line.split(",")] for line in lines if line and line[0].isdigit()]
    return float(lines[1].split("=")[1]), np.array(rows)


def test_nodal_and_element_data(tmp_path):
    m = _model(
        LogEntry("node_data", "uz;p", file="nodes.csv", delim=","),
        LogEntry("element_data", "J;sz", file="elements.csv", delim=",", items=(2, 5)),
    )
    result = febkit.solve(m, logfile=tmp_path / "m.log")
    assert result.converged
    t, rows = _last(tmp_path / "nodes.csv")
    assert t == pytest.approx(result.state.time)
    assert rows[:, 0].astype(int).tolist() == m.mesh.node_ids.tolist()
    np.testing.assert_allclose(rows[:, 1], result.state.d[:, 2], rtol=1e-8, atol=1e-14)
    np.testing.assert_allclose(rows[:, 2], result.state.d[:, 3], rtol=1e-8, atol=1e-14)
    _, rows = _last(tmp_path / "elements.csv")
    assert rows[:, 0].tolist() == [2, 5]
    assert (np.abs(rows[:, 1] - 1) < 0.5).all()


def test_unknown_data_is_named_and_left_out(tmp_path):
    said = []
    febkit.solve(_model(LogEntry("node_data", "nonsense", file="n.csv")), logfile=tmp_path / "m.log", warn=said.append)
    assert any("nonsense" in s for s in said)
    assert not (tmp_path / "n.csv").exists()


def test_a_node_that_does_not_exist_is_refused(tmp_path):
    with pytest.raises(InputError, match="999999"):
        febkit.solve(_model(LogEntry("node_data", "uz", items=(999999,))), logfile=tmp_path / "m.log")


def test_columns_of_one_field_evaluate_it_once_a_state(tmp_path, monkeypatch):
    asked, rows = [], []
    elements = sets.element_ids
    out = StandardWork.outputs | {"stress": lambda w: asked.append(w) or w.total_stress()}
    monkeypatch.setattr(BiphasicWork, "outputs", BiphasicWork.outputs | out)
    monkeypatch.setattr(records, "element_ids", lambda *args: rows.append(args) or elements(*args))
    m = _model(LogEntry("element_data", "sx;sy;sz;sxy;syz;sxz;s1;s2;s3", file="e.csv", delim=",", set="tissue"))
    ids = m.mesh.blocks[0].ids
    m = replace(m, mesh=replace(m.mesh, element_sets={"tissue": ElementSet("tissue", ids)}))
    result = febkit.solve(m, logfile=tmp_path / "m.log")
    text = (tmp_path / "e.csv").read_text()
    assert len(asked) == text.count("*Step") * len(m.mesh.blocks) and len(rows) == 1 and result.converged
    _, table = _last(tmp_path / "e.csv")
    x, y, z, xy, yz, xz = table[:, 1:7].T
    T = np.array([[x, xy, xz], [xy, y, yz], [xz, yz, z]]).transpose(2, 0, 1)
    # the mean of the largest principal values is no less than that of the mean stress; traces are the same
    np.testing.assert_allclose(table[:, 7:].sum(axis=1), np.trace(T, axis1=1, axis2=2), rtol=1e-9)
    assert (table[:, 7] >= np.linalg.eigvalsh(T)[:, 2] * (1 - 1e-9) - 1e-12).all()
