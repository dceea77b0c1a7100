"""febkit plot as a user types it."""

from __future__ import annotations

import pytest

from febkit.results import write
from helpers.forked import febkit

from .test_figures import tensor_block

pytest.importorskip("matplotlib")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("plots")
    write(tensor_block(), folder / "run.xplt")
    return folder


def test_xy_writes_vectors_with_units(folder):
    args = ("-y", "stress:first", "-p", "ecm", "-p", "cell1", "-o", "c.svg")
    done = febkit("plot", "xy", "run.xplt", *args, folder=folder)
    assert (done.returncode, done.stdout) == (0, "wrote c.svg\n"), done.stderr
    text = (folder / "c.svg").read_text()
    assert "mean of stress, 1st principal value (MPa)" in text and "time (s)" in text and "cell1" in text


def test_a_section_of_a_component(folder):
    args = ("-v", "stress:third", "--at", "0.3", "--colours", "cividis", "--limits", "0", "9", "--no-arrows")
    done = febkit("plot", "section", "run.xplt", *args, "-o", "s.svg", folder=folder)
    assert done.returncode == 0, done.stderr
    assert "stress, 3rd principal value (MPa)" in (folder / "s.svg").read_text()


def test_what_is_wrong_is_a_sentence(folder):
    for args, words in (
        (("xy", "run.xplt", "-y", "stres"), "has no 'stres'"),
        (("xy", "run.xplt", "-y", "stress", "-n", "1"), "lives on elements: ask for it at a part, not at node 1"),
        (("section", "run.xplt", "-v", "stress:zx"), "say which component"),
        (("section", "run.xplt", "-v", "stress:zz", "--colours", "parola"), "no colour map is called 'parola'"),
        (("section", "run.xplt", "--limits", "2", "1"), "low must lie below high"),
    ):
        done = febkit("plot", *args, "-o", "x.png", folder=folder)
        assert done.returncode == 2 and words in done.stderr and "Traceback" not in done.stderr, done.stderr
    assert not (folder / "x.png").exists()


def test_scene_as_pdf_and_movie(folder):
    pytest.importorskip("pyvista", reason="scenes need pyvista")
    for verb, out in (("scene", "s.pdf"), ("movie", "m.gif")):
        args = ("-v", "stress:zz", "--camera", "iso", "--plane", "y=0.3", "--size", "300", "240")
        done = febkit("plot", verb, "run.xplt", *args, "-o", out, folder=folder)
        assert (done.returncode, done.stdout) == (0, f"wrote {out}\n"), done.stderr
    assert (folder / "s.pdf").read_bytes()[:4] == b"%PDF" and (folder / "m.gif").read_bytes()[:3] == b"GIF"
