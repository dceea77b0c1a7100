"""Plotfiles that are exchanged, rewritten or cut while they are open: earlier values or a message, never a mixture."""

from __future__ import annotations

import pickle
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest

from febkit import results
from febkit.model import InputError
from febkit.results.variables import VARIABLES
from febkit.results.xplt.reader import PlotFile
from febkit.results.xplt.records import PlotDomain, PlotMesh
from febkit.results.xplt.writer import PlotWriter
from helpers import descriptors

NODES = 50_000  # a state of 600 kB, which is not read whole


def write(path: Path, value: float, states: int = 4, nodes: int = NODES) -> None:
    """Every displacement is ``value``."""
    X = np.zeros((nodes, 3), np.float32)
    mesh = PlotMesh(np.arange(1, nodes + 1), X, [PlotDomain("tet4", 1, "p", np.array([1]), np.array([[0, 1, 2, 3]]))],
                    parts=[(1, "m")])  # fmt: skip
    with PlotWriter(path, mesh, [VARIABLES["displacement"]]) as w:
        for t in range(states):
            w.state(t, {"displacement": np.full((nodes, 3), value, np.float32)})


def rewrite_in_place(path: Path, *args: float, **options: int) -> None:
    """What FEBio does: the file is cut to nothing and written anew."""
    other = path.with_suffix(".other")
    write(other, *args, **options)
    with open(path, "rb+") as f:
        f.truncate(0)
        f.write(other.read_bytes())


@pytest.mark.parametrize("nodes", [10, NODES], ids=["small", "large"])
def test_each_dataset_of_a_sweep_keeps_its_own_run(tmp_path: Path, nodes: int) -> None:
    path, runs = tmp_path / "s.xplt", {}
    for value in (1.0, 2.0, 3.0):
        write(path, value, nodes=nodes)
        runs[value] = results.open(path)
    for value in (1.0, 2.0):
        with pytest.warns(UserWarning, match=r"s\.xplt: another file has taken its place"):
            assert (runs[value]["displacement"].values == value).all()
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # said once
            assert (runs[value]["displacement"].isel(node=3).values == value).all()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert (runs[3.0]["displacement"].values == 3.0).all()


@pytest.mark.parametrize("nodes", [10, NODES], ids=["small", "large"])
@pytest.mark.parametrize(("states", "word"), [(4, "written anew"), (7, "written anew"), (2, "shorter")])
def test_rewritten_in_place(tmp_path: Path, nodes: int, states: int, word: str) -> None:
    path = tmp_path / "r.xplt"
    write(path, 1.0, nodes=nodes)
    ds = results.open(path)
    assert (ds["displacement"].isel(time=1).values == 1.0).all()
    rewrite_in_place(path, 2.0, states=states, nodes=nodes)
    with pytest.raises(InputError, match=rf"r\.xplt: the file .*{word} while it was open: open it again"):
        _ = ds["displacement"].isel(time=0).values
    assert (results.open(path)["displacement"].values == 2.0).all()


def test_a_file_that_grows_is_read_on(tmp_path: Path) -> None:
    whole, path = tmp_path / "whole.xplt", tmp_path / "g.xplt"
    write(whole, 1.0, states=6)
    data = whole.read_bytes()
    cut = len(data) * 2 // 3
    path.write_bytes(data[:cut])
    with pytest.warns(UserWarning, match="no complete state"):
        ds = results.open(path)
    n = ds.sizes["time"]
    with open(path, "ab") as f:
        f.write(data[cut:])
    assert (ds["displacement"].values == 1.0).all() and 0 < n < 6
    f = PlotFile(path)
    assert len(f.states) == 6


def test_a_removed_file_can_be_read_on(tmp_path: Path) -> None:
    path = tmp_path / "d.xplt"
    write(path, 1.0)
    ds = results.open(path)
    path.unlink()
    assert (ds["displacement"].values == 1.0).all()
    assert (ds["X"].values == 0.0).all()


def test_another_process_is_not_given_another_file(tmp_path: Path) -> None:
    path = tmp_path / "p.xplt"
    write(path, 1.0)
    sent = pickle.dumps(results.open(path)["displacement"].variable._data)
    pickle.loads(sent)
    write(path, 2.0)
    with pytest.raises(InputError, match=r"p\.xplt: the file was written anew"):
        pickle.loads(sent)


def test_a_closed_dataset_says_so(tmp_path: Path) -> None:
    path = tmp_path / "c.xplt"
    write(path, 1.0)
    ds = results.open(path)
    ds.close()
    with pytest.raises(InputError, match=r"c\.xplt: the file has been closed"):
        _ = ds["displacement"].values


def test_cutting_a_file_under_a_reader_ends_in_words(tmp_path: Path) -> None:
    """A mapped file that another program cuts ends its reader by SIGBUS."""
    path = tmp_path / "b.xplt"
    write(path, 1.0, states=20)
    program = (
        "import os\nfrom febkit.results.xplt.reader import PlotFile\nfrom febkit.model import InputError\n"
        f"f = PlotFile({str(path)!r})\n"
        "values = [v for t in range(20) for _, v in f.floats(0, t)]\n"  # looked at, not read
        f"os.truncate({str(path)!r}, 4096)\n"
        "said = 0\n"
        "for v in values:\n"
        "    try:\n        v.read()\n"
        "    except InputError as e:\n        said += 'became shorter' in str(e)\n"
        "print(said)\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.returncode == 0 and done.stdout.strip() == "20", (done.returncode, done.stderr)


@descriptors.listed
def test_opening_leaves_one_descriptor_and_closing_none(tmp_path: Path) -> None:
    path = tmp_path / "n.xplt"
    write(path, 1.0)
    ds = results.open(path)
    _ = ds["displacement"].values
    assert descriptors.held(tmp_path) == [str(path)]
    ds.close()
    assert descriptors.held(tmp_path) == []
    for _ in range(3):
        results.open(path)
    assert descriptors.held(tmp_path) == [], "datasets that nobody holds are closed"
