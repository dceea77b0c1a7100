"""Exit codes of every verb, as docs/commands.md has them, of the command as a process."""

from __future__ import annotations

import os
import re
import shutil
from pathlib import Path

import pytest

from febkit.cli.main import VERBS
from helpers import forked
from helpers.command import febkit

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory, plug: str) -> Path:
    """A solved plug, its metrics, and files of every wrong kind."""
    d = tmp_path_factory.mktemp("exits")
    text = plug
    (d / "plug.feb").write_text(text)
    (d / "other.feb").write_text(text.replace("<E>0.6</E>", "<E>0.7</E>"))
    (d / "bad.feb").write_text(text.replace('mat="cartilage"', 'mat="bone"'))
    (d / "refused.feb").write_text(text.replace('type="neo-Hookean"', 'type="no such solid"'))
    (d / "units.feb").write_text(text.replace('<Module type="biphasic"/>',
                                              '<Module type="biphasic"><units>SI</units></Module>'))  # fmt: skip
    turned = text.replace(">-0.05<", ">-1.5<")
    start, end = turned.index("<time_stepper"), turned.index("</time_stepper>")
    (d / "turned.feb").write_text(turned[:start] + turned[end + len("</time_stepper>") :])
    (d / "page.feb").write_text("<html/>")
    (d / "study.toml").write_text('name = "s"\nno_such_entry = 3\n')
    fit = 'model = "plug.feb"\ndata = "force.csv"\nobserve = "reaction top z"\n'
    start = '[parameters]\n"cartilage.solid.E" = [0.1, 0.5, 3]\n'
    (d / "force.csv").write_text("time,force\n2,-0.002\n5,-0.005\n10,-0.01\n")
    (d / "fit.toml").write_text(fit + start)
    (d / "short.toml").write_text(f"most = 1\n{fit}{start}")
    (d / "bone.toml").write_text(fit + start.replace("cartilage", "bone"))
    (d / "optimise.feb").write_text("<febio_optimize version='2.0'><Options type='genetic'/></febio_optimize>")
    for ending in ("feb", "xplt", "nc", "stl", "toml"):
        (d / f"empty.{ending}").touch()
        (d / f"binary.{ending}").write_bytes(bytes(range(256)) * 8)
        (d / f"folder.{ending}").mkdir()
    for args in (("run", "plug.feb", "-silent"), ("run", "other.feb", "-silent"),
                 ("metrics", "plug.xplt", "-c", "plug", "-o", "cells.nc", "--style", "csv")):  # fmt: skip
        done = forked.febkit(*args, folder=d)
        assert done.returncode == 0, done.stderr
    shutil.copy(d / "plug.xplt", d / "plot.feb")
    return d


# arguments, exit code, words on stdout or stderr
CASES = [
    ("--version", 0, "febkit, version"),
    ("help", 0, "Verbs:"),
    ("help run", 0, "Usage: febkit run"),
    ("", 2, "Verbs:"),
    ("vlaidate plug.feb", 2, "vlaidate is no verb and no model; did you mean validate?"),
    ("info plug.feb", 0, "febio_spec 4.0"),
    ("info plug.xplt", 0, "states    32"),
    ("info cells.nc", 0, "Dimensions"),
    ("info page.feb", 2, "no .feb file"),
    ("info plug.fbe", 2, "did you mean plug.feb?"),
    ("features contact", 0, "sliding-elastic"),
    ("features contactz", 2, 'no kind is called "contactz"'),
    ("validate plug.feb", 0, "febkit can solve it"),
    ("validate bad.feb", 2, 'no material "bone"'),
    ("validate refused.feb", 2, "no such solid"),
    ("validate -q refused.feb", 2, "no such solid"),
    ("validate plug.feb bad.feb", 2, 'no material "bone"'),
    ("validate plot.feb", 2, "plot.feb"),
    ("convert plug.feb out/old.feb --to 2.5", 0, "wrote"),
    ("convert plug.feb out/mesh.vtu", 0, "wrote"),
    ("convert plug.xplt out/run.pvd", 0, "wrote"),
    ("convert plug.xplt out/run.nc -v displacement", 0, "wrote"),
    ("convert plug.xplt out/less.xplt -v displacement", 0, "wrote"),
    ("convert units.feb out/strict.feb --to 2.5 --strict", 1, "<Module><units>"),
    ("convert plug.feb out/m.k", 2, 'meshio writes no files that end in ".k"'),
    ("convert plug.feb out/plug.nc", 2, "febkit run makes them"),
    ("convert plug.feb out/plug.xplt", 2, "febkit run makes them"),
    ("convert plug.feb out/plug.stl", 2, "holds 0 of the mesh's 3 cells"),
    ("convert empty.stl out/empty.vtu", 2, "no cells to write"),
    ("convert plug.xplt out/mesh.stl", 2, "results are converted"),
    ("convert plug.xplt out/run.nc --to 2.5", 2, "--to means nothing"),
    ("convert plug.xplt out/run.nc -v displacemnt", 2, 'did you mean "displacement"?'),
    ("convert plug.feb nowhere/m.feb", 2, "the folder nowhere does not exist"),
    ("run turned.feb -p out/t.xplt -o out/t.log", 1, "at time"),
    ("run bad.feb", 2, 'no material "bone"'),
    ("run refused.feb", 2, "no such solid"),
    ("run plot.feb", 2, "plot.feb"),
    ("run plug.feb -o out/r.xplt", 2, "-o names the log; a plotfile is named by -p out/r.xplt"),
    ("run plug.feb --threads -3", 2, "-3 is not in the range"),
    ("run plug.feb --linear mumps", 2, "mumps"),
    ("run plug.feb --accuracy 2", 2, "2"),
    ("run plug.feb --tolerance 1", 2, "1"),
    ("run plug.feb --memory nan", 2, "finite"),
    ("run plug.feb --resume", 2, "there is no checkpoint"),
    ("run plug.feb --changed", 2, "--resume"),
    ("run plug.feb --from missing.xplt", 2, "missing.xplt"),
    ("run plug.feb --from plug.xplt", 2, "which the same call reads"),
    ("run plug.feb --checkpoint often", 2, "every=10min"),
    ("run plug.feb -p out/p.vtk", 2, ".pvd"),
    ("run plug.feb -o nowhere/o.log", 2, "the folder nowhere does not exist"),
    ("run", 2, "which model?"),
    ("run plug.feb -i other.feb", 2, "two models"),
    ("new cell --parameters", 0, "diameter"),
    ("new bone -o out/n.feb", 2, "bone"),
    ("new tissue --set nonsense=3 -o out/n.feb", 2, "nonsense"),
    ("new tissue -o out/n.txt", 2, "ends in .feb"),
    ("boundary plug.xplt plug.feb --at 0.1,0.1,0.1 -o out/b.feb", 0, "wrote out/b.feb"),
    ("boundary plug.xplt plug.feb --at 0.1,0.1 -o out/b.feb", 2, "--at 0.1,0.1"),
    ("boundary plug.xplt plug.feb -o out/b.feb", 2, "which point"),
    ("metrics plug.xplt -v displacement:magnitude", 0, "greatest"),
    ("metrics plug.xplt -c nosuch", 2, "nosuch"),
    ("metrics plug.xplt -c plug -o out/m.txt", 2, "ends in .nc or .csv"),
    ("metrics plug.xplt -v displacement:magnitude --at nan", 2, "finite"),
    ("compare cells.nc cells.nc --instantaneous 1", 0, "limits of agreement"),
    ("compare cells.nc cells.nc --instantaneous 0.12", 2, "no state at t = 0.12"),
    ("compare cells.nc plug.feb", 2, "not an FEBio plotfile"),
    ("compare cells.nc cells.nc -l a -l b", 2, "2 labels for 1 files"),
    ("plot histories cells.nc -o out/h.bmp", 2, "ends in .png"),
    ("plot section plug.xplt -f effective_stress --at 0.1 --window 1 0 0 1 -o out/s.png", 2, "--window"),
    ("view page.feb --no-browser", 2, "page.feb"),
    ("fit fit.toml -w out/fitted.feb", 0, "R^2 ="),
    ("fit short.toml", 1, "1 runs are made"),
    ("fit bone.toml", 2, "bone"),
    ("fit optimise.feb", 2, "febkit fit optimise.feb MODEL.feb"),
    ("fit optimise.feb plug.feb", 2, "optimise.feb:1: <febio_optimize> has no <Parameters>"),
    ("run plug.feb -s optimise.feb", 2, "optimise.feb:1: "),
    ("sweep plug.feb --vary cartilage.solid.E=1:-2 --observe x", 2, "low < high"),
    ("sweep plug.feb --vary cartilage.solid.E --observe x", 2, "PATH=LOW:HIGH"),
    ("study status study.toml", 2, "no_such_entry"),
    ("study run missing.toml", 2, "there is no such file"),
    ("diff plug.feb plug.feb", 0, "same meaning"),
    ("diff plug.feb other.feb", 1, "1 difference"),
    ("diff plug.xplt plug.xplt", 0, "agree"),
    ("diff plug.xplt other.xplt", 1, "differ"),
    ("diff plug.xplt other.xplt -q", 1, ""),
    ("diff plug.feb plug.xplt", 2, "two .feb or two .xplt"),
    ("diff plug.feb bad.feb --rtol nan", 2, "finite"),
]
# each code, as the installed command hands it to a shell (one of every verb: test_outputs.py)
STARTED = ("--version", "", "features contact", "diff plug.xplt other.xplt", "view page.feb --no-browser")


@pytest.mark.parametrize(("line", "code", "words"), CASES, ids=[c[0] or "nothing" for c in CASES])
def test_codes(folder: Path, line: str, code: int, words: str) -> None:
    shutil.rmtree(folder / "out", ignore_errors=True)
    (folder / "out").mkdir()
    done = (febkit if line in STARTED else forked.febkit)(*line.split(), folder=folder)
    said = done.stdout + done.stderr
    assert done.returncode == code, said
    assert words in said and "Traceback" not in said
    assert code != 2 or not done.stderr.count("\n") > 40, "a sentence, not a page"


@pytest.mark.parametrize("verb", [v for v in VERBS if v != "new"])
def test_wrong_files_are_refused_in_a_sentence(folder: Path, verb: str) -> None:
    """A folder, an empty file, a binary one, one that is not there, a pipe nobody writes to."""
    if not hasattr(os, "mkfifo"):
        pytest.skip("no pipes with names here")
    shutil.rmtree(folder / "out", ignore_errors=True)
    (folder / "out").mkdir()
    ending = {"study": "toml", "metrics": "xplt", "compare": "nc", "plot": "nc", "boundary": "xplt",
              "info": "xplt", "diff": "xplt", "fit": "toml"}.get(verb, "feb")  # fmt: skip
    pipe = folder / f"pipe.{ending}"
    if not pipe.exists():
        os.mkfifo(pipe)
    rest = {"convert": ["out/c.vtu"], "compare": ["cells.nc"], "plot": ["-o", "out/p.png"], "diff": ["plug.xplt"],
            "boundary": ["plug.feb", "--at", "0,0,0", "-o", "out/b.feb"],
            "sweep": ["--vary", "a.E=1:2", "--observe", "reaction top z"]}.get(verb, [])  # fmt: skip
    first = {"plot": ["plot", "histories"], "study": ["study", "status"]}.get(verb, [verb])
    for name in ("folder", "empty", "binary", "missing", "pipe"):
        if (verb, name) == ("study", "empty"):
            continue  # an empty study is the published one, reduced
        done = forked.febkit(*first, f"{name}.{ending}", *rest, folder=folder)
        assert done.returncode == 2, (name, done.stdout, done.stderr)
        said = done.stderr or done.stdout
        assert f"{name}." in said and "Traceback" not in said and len(said.splitlines()) <= 3, said


@pytest.mark.skipif(os.name == "nt" or not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root may read all")
def test_files_that_may_not_be_read(folder: Path) -> None:
    secret = folder / "secret.feb"
    secret.write_text("x")
    secret.chmod(0)
    done = febkit("info", "secret.feb", folder=folder)
    assert done.returncode == 2 and "you may not read this file" in done.stderr


def test_the_table_in_the_docs_names_every_verb_and_its_codes() -> None:
    text = (ROOT / "docs" / "commands.md").read_text(encoding="utf-8")
    rows = dict(re.findall(r"^\| `(\w+)` \|(.*)\|$", text, re.M))
    assert list(rows) == list(VERBS)
    tried = {(line.split()[0], code) for line, code, _ in CASES if line and line.split()[0] in VERBS}
    for verb, cells in rows.items():
        for code, cell in zip((0, 1, 2), cells.split("|"), strict=True):
            assert cell.strip(), (verb, code)
            elsewhere = {("run", 0), ("plot", 0), ("study", 0), ("study", 1), ("view", 0),
                             ("sweep", 0), ("sweep", 1)}  # fmt: skip
            if cell.strip() != "-" and (verb, code) not in elsewhere:
                assert (verb, code) in tried, f"febkit {verb}: exit code {code} is in the docs and not tried"
            assert cell.strip() != "-" or (verb, code) not in tried, (verb, code)
