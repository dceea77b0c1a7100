"""Data files of <logfile>: in the log's folder, onto nothing else, refused before anything is solved."""

from __future__ import annotations

from pathlib import Path

import pytest


def line(text: str, of: str) -> int:
    return text[: text.index(of)].count("\n") + 1


@pytest.mark.parametrize(("name", "word"), [
    ("{tmp}/../elsewhere.txt", "outside the folder of the log"),
    ("../elsewhere.txt", "outside the folder of the log"),
    ("below/../../elsewhere.txt", "outside the folder of the log"),
    ("..\\\\elsewhere.txt", "outside the folder of the log"),
    ("link/x.txt", "outside the folder of the log"),
    ("m.feb", "this is the model"),
    ("./below/../m.feb", "this is the model"),
    ("hard.feb", "this is the model"),
    ("part.feb", "this is the model"),
    ("m.xplt", "this is the plotfile"),
    ("m.log", "this is the log"),
    ("below", "a folder"),
    ("none/x.txt", "does not exist"),
    ("thesis.txt", "is no data file"),
])  # fmt: skip
def test_refused_with_the_line_before_solving(tmp_path: Path, febkit, model, name: str, word: str) -> None:
    run = tmp_path / "run"
    (run / "below").mkdir(parents=True)
    (run / "link").symlink_to(tmp_path)
    name = name.format(tmp=run).replace("\\\\", "\\")
    text = model(log=f'\n<node_data data="x" file="{name}"/>', more='<Include>part.feb</Include>\n')
    (run / "m.feb").write_text(text)
    constants = "<Globals><Constants><T>0</T></Constants></Globals>"
    (run / "part.feb").write_text(f'<febio_spec version="4.0">{constants}</febio_spec>')
    (run / "hard.feb").hardlink_to(run / "m.feb")
    (run / "thesis.txt").write_text("Chapter 1\n")
    before = {p: p.read_bytes() for p in tmp_path.rglob("*") if p.is_file()}
    done = febkit("run", "m.feb", folder=run)
    assert done.returncode == 2
    assert word in done.stderr and f"m.feb:{line(text, '<node_data')}" in done.stderr, done.stderr
    assert before == {p: p.read_bytes() for p in tmp_path.rglob("*") if p.is_file()}, "nothing is written"


def test_two_records_into_one_file(tmp_path: Path, febkit, model) -> None:
    text = model(log='\n<node_data data="x" file="x.txt"/>\n<element_data data="J" file="./x.txt"/>')
    (tmp_path / "m.feb").write_text(text)
    done = febkit("run", "m.feb")
    assert done.returncode == 2
    assert f"m.feb:{line(text, '<element_data')}" in done.stderr and "another data file" in done.stderr
    assert [p.name for p in tmp_path.iterdir()] == ["m.feb"]


def test_the_option_lets_them_out(tmp_path: Path, febkit, model) -> None:
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "m.feb").write_text(model(log='<node_data data="x" file="../x.txt"/>'))
    assert febkit("run", "run/m.feb").returncode == 2
    done = febkit("run", "run/m.feb", "--data-anywhere")
    assert done.returncode == 0 and "--data-anywhere" not in done.stdout + done.stderr
    assert (tmp_path / "x.txt").read_text().count("*Step") == 6


def test_a_file_in_the_folder_of_a_log_elsewhere_is_no_warning(tmp_path: Path, febkit, model) -> None:
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "m.feb").write_text(model(log=f'<node_data data="x" file="{tmp_path}/x.txt"/>'))
    done = febkit("run", "run/m.feb", "-o", tmp_path / "m.log")
    assert done.returncode == 0 and "--data-anywhere" not in done.stdout + done.stderr
    assert (tmp_path / "x.txt").exists()


def test_a_failed_run_leaves_earlier_data(tmp_path: Path, febkit, model) -> None:
    log = '<node_data data="uz" file="u.txt"/>'
    (tmp_path / "m.feb").write_text(model(log=log))
    assert febkit("run", "m.feb").returncode == 0
    before = (tmp_path / "u.txt").read_bytes()
    (tmp_path / "m.feb").write_text(model(steps=1, to=-1.5, log=log))
    assert febkit("run", "m.feb").returncode == 1
    assert (tmp_path / "u.txt").read_bytes() == before
    assert not (tmp_path / ".febkit.u.txt").exists()


@pytest.mark.parametrize(("name", "severity"), [("../x.txt", "warning"), ("m.feb", "error")])
def test_validate_says_what_run_says(tmp_path: Path, febkit, model, name: str, severity: str) -> None:
    text = model(log=f'\n<node_data data="x" file="{name}"/>')
    (tmp_path / "m.feb").write_text(text)
    done = febkit("validate", "m.feb")
    said = next(x for x in done.stdout.splitlines() if severity in x)
    assert f"m.feb:{line(text, '<node_data')}" in said
    ran = febkit("run", "m.feb")
    assert ran.returncode == 2 and said.partition(f"{severity}: ")[2] in ran.stderr
