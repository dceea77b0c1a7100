"""Runs that are killed and gone on with, and checkpoints that none can go on from."""

from __future__ import annotations

import errno
import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import febkit
from febkit.model import InputError
from febkit.output import checkpoints
from febkit.results.xplt.reader import PlotFile
from helpers.resumed import KINDS, kill_and_go_on

Command = Callable[..., Any]


@pytest.mark.parametrize("kind", KINDS)
def test_a_killed_run_goes_on_to_the_same_bits(kind: str, tmp_path: Path, start: Command) -> None:
    """tests/benchmarks/resumed.py kills 30 times."""
    kill_and_go_on(tmp_path, kind, steps=24, kills=1, rng=random.Random(3), start=start)


def test_the_installed_command_goes_on(tmp_path: Path, model: Callable[..., str], febkit: Command) -> None:
    """A run that stops where the model fails goes on once the model is mended; it leaves no checkpoint then."""
    from helpers.command import febkit as installed

    text = model(steps=20, to=-1.9, log='<node_data data="uz" file="nodes.txt"/>')
    (tmp_path / "m.feb").write_text(text)
    stopped = installed("run", "m.feb", "--checkpoint", "every=2steps", folder=tmp_path)
    assert stopped.returncode == 1 and (tmp_path / "m.checkpoint").is_file()
    said = febkit("run", "m.feb", "--resume")
    assert said.returncode == 1 and "inside out" in said.stderr
    (tmp_path / "m.feb").write_text(text.replace("<pt>1,1</pt>", "<pt>1,0.2</pt>"))
    edited = febkit("run", "m.feb", "--resume")
    assert edited.returncode == 2 and "--changed" in edited.stderr
    done = febkit("run", "m.feb", "--resume", "--changed")
    assert done.returncode == 0, done.stderr
    assert not (tmp_path / "m.checkpoint").exists()
    log, records = (tmp_path / "m.log").read_text(), (tmp_path / "nodes.txt").read_text()
    assert log.count("going on from the checkpoint") == 1 and "N O R M A L" in log and "E R R O R" not in log
    with PlotFile(tmp_path / "m.xplt") as f:
        assert len(f.states) == 21 == records.count("*Step")


def test_a_kept_checkpoint_is_where_later_steps_begin(tmp_path: Path, model: Callable[..., str]) -> None:
    path, plot = tmp_path / "m.feb", tmp_path / "m.xplt"
    path.write_text(model(steps=4))
    febkit.solve(path, plot, checkpoint="30min,keep")
    longer = model(steps=4).replace("<time_steps>4", "<time_steps>6")
    path.write_text(longer.replace("<pt>1,1</pt>", "<pt>1,1</pt><pt>2,2</pt>"))
    more = febkit.solve(path, plot, resume=True, changed=True)
    whole = febkit.solve(path, tmp_path / "whole.xplt")
    assert more.converged and more.times == whole.times
    assert more.state.d == pytest.approx(whole.state.d, abs=1e-12)
    with PlotFile(plot) as f, PlotFile(tmp_path / "whole.xplt") as g:
        assert len(f.states) == len(g.states)


def _line(data: bytes, k: int, new: bytes) -> bytes:
    lines = data.split(b"\n")
    lines[k] = new
    return b"\n".join(lines)


def test_what_cannot_be_gone_on_with_is_refused_by_name(tmp_path: Path, model: Callable[..., str]) -> None:
    text, path = model(steps=4), tmp_path / "m.feb"
    path.write_text(text)
    febkit.solve(path, tmp_path / "m.xplt", checkpoint="1steps,keep")
    kept, plot = (tmp_path / "m.checkpoint").read_bytes(), (tmp_path / "m.xplt").read_bytes()
    other = text.replace('type="neo-Hookean"', 'type="isotropic elastic"')
    cases: list[tuple[str, bytes | None, bytes | None, str, dict[str, Any]]] = [
        ("there is no checkpoint", None, plot, text, {}),
        ("is no checkpoint", b"<html>", plot, text, {}),
        ("damaged", kept[:-40], plot, text, {}),
        ("damaged", kept.replace(b'"index": 0', b'"index": 1'), plot, text, {}),
        ("format 99", _line(kept, 0, b"febkit checkpoint 99"), plot, text, {}),
        ("another model", kept, plot, text.replace("<E>1.0</E>", "<E>2.0</E>"), {}),
        ("the mesh", kept, plot, text.replace("1,1,1<", "1,1,1.5<", 1), {"changed": True}),
        ("in the checkpoint it is 1 hex8, standard, NeoHookean", kept, plot, other, {"changed": True}),
        ("linear = auto", kept, plot, text, {"linear": "superlu"}),
        ("not there any more", kept, None, text, {}),
        ("or it was cut", kept, plot[:-4], text, {}),
        ("other variables", kept, plot, text.replace('<var type="stress"/>', ""), {"changed": True}),
    ]
    for words, checkpoint, plotfile, feb, options in cases:
        path.write_text(feb)
        for name, data in (("m.checkpoint", checkpoint), ("m.xplt", plotfile)):
            (tmp_path / name).unlink(missing_ok=True)
            if data is not None:
                (tmp_path / name).write_bytes(data)
        with pytest.raises(InputError, match=words) as e:
            febkit.solve(path, tmp_path / "m.xplt", resume=True, **options)
        assert "m.checkpoint" in str(e.value) or "m.xplt" in str(e.value)
        assert plotfile is None or (tmp_path / "m.xplt").read_bytes() == plotfile
        assert not list(tmp_path.glob(".febkit*"))


def test_a_checkpoint_that_finds_no_room_ends_no_run(
    tmp_path: Path, model: Callable[..., str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(checkpoints, "write", full)
    said: list[str] = []
    (tmp_path / "m.feb").write_text(model(steps=3))
    result = febkit.solve(tmp_path / "m.feb", tmp_path / "m.xplt", checkpoint="1steps", warn=said.append)
    assert result.converged and len(said) == 1 and "No space left" in said[0] and "m.checkpoint" in said[0]
