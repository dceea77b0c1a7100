"""``febkit diff`` and ``febkit info`` on results."""

from __future__ import annotations

import struct
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from febkit import results
from febkit.cli import diff as diff_cli
from febkit.cli import info as info_cli
from febkit.results.difference import difference
from helpers import forked


@pytest.fixture
def pair(tmp_path: Path, make_modern) -> tuple[Path, Path]:
    a, b = tmp_path / "a.xplt", tmp_path / "b.xplt"
    a.write_bytes(make_modern())
    b.write_bytes(make_modern())
    return a, b


def changed(path: Path, name: str, t: int, item: int, by: float) -> None:
    ds = results.open(path).load()
    ds[name][t, item] += by
    results.write(ds, path)


def run(command, *args: object) -> tuple[int, str]:
    r = CliRunner().invoke(command, [str(a) for a in args])
    return r.exit_code, r.output


def test_equal_files_agree(pair: tuple[Path, Path]) -> None:
    code, said = run(diff_cli.command, *pair)
    assert code == 0
    assert "agree" in said
    assert all(s.norm == 0 for v in difference(*pair).variables for s in v.states)


def test_one_value_is_found_with_its_norm_and_place(pair: tuple[Path, Path]) -> None:
    changed(pair[1], "effective_fluid_pressure", 2, 7, 0.5)
    d = difference(*pair)
    by_name = {v.name: v for v in d.variables}
    p = by_name["effective fluid pressure"]
    worst = p.worst
    assert worst is not None
    assert (worst.time, worst.largest, worst.item) == (pytest.approx(0.2), 0.5, 108)  # ids begin at 101
    assert p.relative(worst) == pytest.approx(0.5 / np.linalg.norm(200.5 * (np.arange(12) == 7)
                                                                   + (200 + np.arange(12)) * (np.arange(12) != 7)
                                                                   + 7 * (np.arange(12) == 7)), rel=1e-6)
    assert not by_name["displacement"].bad(0, 0)
    code, said = run(diff_cli.command, *pair)
    assert code == 1
    assert "differs" in said
    assert run(diff_cli.command, *pair, "--rtol", "1e-2")[0] == 0
    assert run(diff_cli.command, *pair, "-v", "displacement")[0] == 0
    assert run(diff_cli.command, *pair, "--rtol", 0, "--atol", 1)[0] == 0


def test_other_order_of_nodes_and_elements_is_matched_by_id(pair: tuple[Path, Path]) -> None:
    ds = results.open(pair[0]).load()
    rng = np.random.default_rng(0)
    nodes = rng.permutation(12)
    back = np.argsort(nodes)
    other = ds.isel(node=nodes)
    other["connectivity"] = (("element", "local"), back[ds["connectivity"].values].astype(np.int32))
    for v in ("facets", "node_set_members"):
        old = ds[v].values
        other[v] = (ds[v].dims, np.where(old < 0, -1, back[old]).astype(np.int32), ds[v].attrs)
    results.write(other, pair[1])
    d = difference(*pair)
    assert d.agrees(0, 0), d.notes


def test_missing_states_variables_and_nodes_are_noted(pair: tuple[Path, Path], make_modern) -> None:
    pair[1].write_bytes(make_modern(states=2))
    d = difference(*pair)
    assert d.notes == ["1 states only in the first file: t = 0.2"]
    ds = results.open(pair[0]).load().drop_vars("stress")
    results.write(ds, pair[1])
    assert difference(*pair).notes == ["variables only in the first file: stress"]
    assert run(diff_cli.command, *pair)[0] == 1


def test_nan_in_one_file_differs(pair: tuple[Path, Path]) -> None:
    changed(pair[1], "stress", 1, 0, np.nan)
    assert run(diff_cli.command, *pair, "--rtol", 1)[0] == 1


def test_unknown_variable_and_unlike_files(pair: tuple[Path, Path], tmp_path: Path) -> None:
    done = forked.febkit("diff", *pair, "-v", "porosity", folder=tmp_path)
    assert done.returncode == 2
    assert "neither file has a variable 'porosity'" in done.stderr
    assert run(diff_cli.command, pair[0], Path(__file__))[0] == 2


def test_info_says_what_is_there(pair: tuple[Path, Path]) -> None:
    code, said = run(info_cli.command, pair[0], "--ranges", "--times")
    assert code == 0
    for words in ("version 0x35", "mm-N-s", "nodes     12", "part left: 1 hex8, material tissue", "fix (2)",
                  "front (2)", "states    3, t = 0 to 0.2", "x[0, 53] y[1, 54] z[2, 55]"):
        assert words in said
    assert "x[20, 53]" in run(info_cli.command, pair[0])[1]


def test_info_of_a_cut_and_a_log(tmp_path: Path, make_modern) -> None:
    (tmp_path / "a.xplt").write_bytes(make_modern()[:-5])
    assert "not complete" in run(info_cli.command, tmp_path / "a.xplt")[1]
    (tmp_path / "a.log").write_text(" N O R M A L   T E R M I N A T I O N\n")
    assert "normal termination" in run(info_cli.command, tmp_path / "a.log")[1]


def test_info_and_diff_stay_light(pair: tuple[Path, Path]) -> None:
    code = ("import sys; from click.testing import CliRunner; from febkit.cli import info, diff;"
            f"r = CliRunner().invoke(info.command, [{str(pair[0])!r}]); assert r.exit_code == 0, r;"
            f"r = CliRunner().invoke(diff.command, [{str(pair[0])!r}, {str(pair[1])!r}]); assert r.exit_code == 0, r;"
            "print([m for m in ('numba', 'xarray', 'scipy', 'pandas', 'meshio') if m in sys.modules])")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_status_of_states_that_did_not_converge(tmp_path: Path, make_modern) -> None:
    raw = make_modern()
    bad = raw.replace(struct.pack("<III", 0x02010003, 4, 0), struct.pack("<III", 0x02010003, 4, 2), 1)
    (tmp_path / "a.xplt").write_bytes(bad)
    assert "1 states did not converge" in run(info_cli.command, tmp_path / "a.xplt")[1]
