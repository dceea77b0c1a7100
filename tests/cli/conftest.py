"""The command, and a model that it solves in no time."""

from __future__ import annotations

import importlib.util
import multiprocessing
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from helpers import forked

CUBE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]


def pulled(steps: int = 5, to: float = 0.1, e: float = 1.0, log: str = "", more: str = "") -> str:
    """One cube, its bottom held and its top pulled by ``to`` in ``steps`` equal steps; -1.5 turns it inside out."""
    nodes = "".join(f'<node id="{k}">{x},{y},{z}</node>\n' for k, (x, y, z) in enumerate(CUBE, 1))
    return f"""<?xml version="1.0"?>
<febio_spec version="4.0">
<Module type="solid"/>
<Control><analysis>STATIC</analysis><time_steps>{steps}</time_steps><step_size>{1 / steps!r}</step_size></Control>
<Material><material id="1" name="m" type="neo-Hookean"><E>{e}</E><v>0.3</v></material></Material>
<Mesh><Nodes>{nodes}</Nodes>
<Elements type="hex8" name="part"><elem id="1">1,2,3,4,5,6,7,8</elem></Elements>
<NodeSet name="bottom">1,2,3,4</NodeSet><NodeSet name="top">5,6,7,8</NodeSet></Mesh>
<MeshDomains><SolidDomain name="part" mat="m"/></MeshDomains>
<Boundary><bc node_set="bottom" type="zero displacement"><x_dof>1</x_dof><y_dof>1</y_dof><z_dof>1</z_dof></bc>
<bc node_set="top" type="prescribed displacement"><dof>z</dof><value lc="1">{to}</value></bc></Boundary>
<LoadData><load_controller id="1" type="loadcurve"><interpolate>LINEAR</interpolate>
<points><pt>0,0</pt><pt>1,1</pt></points></load_controller></LoadData>
<Output><plotfile type="febio"><var type="displacement"/><var type="stress"/></plotfile>
<logfile>{log}</logfile></Output>
{more}</febio_spec>
"""


@pytest.fixture
def model() -> Callable[..., str]:
    """``model(steps=5, to=0.1, e=1, log="")``: the text of a cube that is pulled."""
    return pulled


@pytest.fixture
def febkit(tmp_path: Path) -> Callable[..., subprocess.CompletedProcess[str]]:
    """``febkit("run", "m.feb")``: the command, run in ``tmp_path``; never a traceback."""

    def call(*args: Any, **options: Any) -> subprocess.CompletedProcess[str]:
        done = forked.febkit(*args, **{"folder": tmp_path, **options})
        assert "Traceback" not in done.stderr, done.stderr
        return done

    return call


@pytest.fixture(autouse=True)
def nothing_goes_on(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Processes that a test leaves, where it fails halfway, end with it."""
    begun: list[subprocess.Popen[Any]] = []
    begin = subprocess.Popen.__init__

    def noted(self: subprocess.Popen[Any], *args: Any, **options: Any) -> None:
        begin(self, *args, **options)
        begun.append(self)

    monkeypatch.setattr(subprocess.Popen, "__init__", noted)
    yield
    for job in begun:
        if job.poll() is None:
            job.kill()
            job.communicate()
    for child in multiprocessing.active_children():
        child.kill()


@pytest.fixture
def start(tmp_path: Path) -> Callable[..., forked.Job]:
    """``start("run", "m.feb")``: the command as a process that goes on; killed when the test ends."""
    return lambda *args: forked.Job(*args, folder=tmp_path)


@pytest.fixture(scope="session")
def plug() -> str:
    """Text of a .feb: a biphasic plug, pressed and held."""
    path = Path(__file__).parents[2] / "examples" / "unconfined_compression.py"
    spec = importlib.util.spec_from_file_location("plug", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return str(module.text(1, 1, 150.0))
