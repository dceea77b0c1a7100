"""Each cell of the table in docs/outputs.md, by the installed command."""

from __future__ import annotations

import os
import shlex
import shutil
import signal
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

import pytest

import febkit
from febkit.results.xplt.reader import PlotFile
from helpers import command, forked, outputs

pytestmark = pytest.mark.skipif(os.name == "nt", reason="signals, limits and permissions differ on Windows")

# stops a verb where a file is opened, or put in place, until it is told to go on
PAUSE = """
import os, sys, time
flag = {flag!r}
def pause(event, args):
    if event == {event!r} and {name!r} in [os.path.basename(str(a)) for a in args[:2]] and not os.path.exists(flag):
        open(flag, "w").close()
        while os.path.exists(flag):
            time.sleep(0.01)
sys.addaudithook(pause)
"""

STUDY = """
cases = ["A"]
methods = ["1"]
control = false
[model]
times = [0.0, 0.1, 1.0]
[tissue]
n = 3
[cell]
n = 5
cells = 1
layers = [1, 1, 1]
edge = 0.05
[points]
at = [[0, 0, 0]]
"""
FIT = """
model = "few.feb"
data = "few.csv"
observe = "reaction top z"
[parameters]
"m.E" = [0.1, 1.0, 5.0]
"""


@pytest.fixture(scope="module")
def kit(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The inputs of all verbs, made once."""
    from cli.conftest import pulled
    from febkit.metrics import cell_metrics

    folder = tmp_path_factory.mktemp("kit")
    (folder / "m.feb").write_text(pulled(steps=200))
    assert febkit.solve(febkit.read(folder / "m.feb"), folder / "m.xplt", threads=1).converged
    with febkit.open_results(folder / "m.xplt") as ds:
        febkit.results.write(ds, folder / "m.nc")
        for name in ("a.nc", "b.nc"):
            cell_metrics(ds, febkit.read(folder / "m.feb"), ["part"]).to_netcdf(folder / name)
    (folder / "f.csv").write_text("time,Fzz\n0,1\n1,0.9\n")
    (folder / "p.feb").write_text("n = 3\n")
    (folder / "bad.feb").write_text(pulled(e="soft"))
    (folder / "few.feb").write_text(pulled())
    (folder / "few.csv").write_text("time,force\n0.5,-0.1\n1,-0.2\n")
    (folder / "fit.toml").write_text(FIT)
    for name in ("junk.feb", "junk.xplt", "junk.nc", "junk.csv", "bad.toml"):
        (folder / name).write_bytes(b"\x01junk, of no kind = at all\n")
    (folder / "s.toml").write_text(STUDY)
    for work in ("study run s.toml --scheduler serial", f"sweep {outputs.VERBS['sweep'].good.removesuffix(' -o OUT')}"):
        done = forked.febkit(*shlex.split(work), "-q", folder=folder, env={"FEBKIT_THREADS": "1"})
        assert done.returncode == 0, done.stderr
    return folder


class Scene:
    """A verb in a folder of its own."""

    def __init__(self, kit: Path, folder: Path, name: str) -> None:
        self.name, self.verb, self.folder = name, outputs.VERBS[name], folder / "here"
        shutil.copytree(kit, self.folder)
        os.link(self.folder / "a.nc", self.folder / "linked.png")
        os.link(self.folder / "m.feb", self.folder / "linked.xplt")
        self.out = self.folder / self.verb.out if self.verb.out else None
        self.before = self.files()

    def args(self, which: str, *more: str) -> list[str]:
        words = shlex.split(getattr(self.verb, which))
        return [self.name, *(self.verb.out if w == "OUT" else w for w in words), *more]

    def __call__(self, which: str, *more: str, start=forked.febkit, **options) -> subprocess.CompletedProcess[str]:
        done = start(*self.args(which, *more), folder=self.folder, **options)
        assert "Traceback" not in done.stderr, done.stderr
        return done

    def files(self) -> dict[Path, bytes]:
        found = [p for p in self.folder.rglob("*") if p.is_file() and not p.name.startswith("pause")]
        return {p: p.read_bytes() for p in found if "__pycache__" not in p.parts}

    def changed(self) -> set[str]:
        """Files that are new, gone, or other than when the test began."""
        now = self.files()
        names = {p for p in {*now, *self.before} if now.get(p) != self.before.get(p)}
        return {str(p.relative_to(self.folder)) for p in names}

    def earlier(self) -> bytes:
        """Put an earlier output in place, of the kind that the verb writes."""
        assert self.out is not None
        self.out.parent.mkdir(exist_ok=True)
        if self.verb.kind == "runs":
            assert self("good").returncode == 0
        else:  # it must be told from what is written later
            self.out.write_bytes(b"an earlier one")
        self.before = self.files()
        return self.out.read_bytes()

    def force(self) -> list[str]:
        return ["--force"] if self.verb.kind == "makes" else []

    def whole(self) -> bool:
        """Whether the output is a file of its kind, complete."""
        assert self.out is not None
        if self.out.suffix == ".feb":
            return bool(febkit.read(self.out).materials) or self.name == "new"
        if self.out.suffix == ".nc":
            import xarray as xr

            with xr.open_dataset(self.out) as ds:
                return all(v.load().size for v in ds.values())
        if self.out.suffix == ".png":
            return self.out.read_bytes().endswith(b"IEND\xaeB`\x82")
        with PlotFile(self.out) as f:
            return f.container.leftover == 0 and len(f.states) == 201

    def paused(self, *more: str) -> forked.Job:
        """The verb, stopped before its output is put in place (or its input is opened)."""
        put = "os.link" if self.verb.kind == "makes" and not more else "os.rename"  # a link is never put over a file
        event, name = (put, self.out.name) if self.out else ("open", self.verb.reads)
        flag = self.folder / "pause"
        pause = PAUSE.format(event=event, name=name, flag=str(flag))
        job = forked.Job(*self.args("good", *more), folder=self.folder, before=pause)
        until = time.monotonic() + 60
        while not flag.exists():
            assert job.poll() is None and time.monotonic() < until, job.communicate()
            time.sleep(0.01)
        return job


@pytest.fixture
def scene(kit: Path, tmp_path: Path) -> Callable[[str], Scene]:
    return lambda name: Scene(kit, tmp_path, name)


def hidden(folder: Path) -> list[str]:
    return [p.name for p in folder.rglob(".febkit*")]


def good_input(s: Scene) -> None:
    done = s("good", start=command.febkit)
    assert done.returncode == 0, done.stderr
    if s.out is None:
        assert s.changed() == set()
    else:
        assert s.whole() and not hidden(s.folder)
        beside = {"run": {"m.log"}, "study": {"report/report.md"}}.get(s.name, set())
        assert s.changed() == {s.verb.out, *beside}


def bad_input(s: Scene) -> None:
    done = s("bad")
    assert done.returncode == 2 and done.stderr + done.stdout
    assert s.changed() == set()


def missing_file(s: Scene) -> None:
    done = s("missing")
    assert done.returncode == 2 and "none." in done.stderr
    assert s.changed() == set()


def output_onto_input(s: Scene) -> None:
    for more in ([], s.force()):
        done = s("onto", *more)
        assert done.returncode == 2, done.stdout
        assert "which the same call reads" in done.stderr
    assert s.changed() == set()


def existing_output(s: Scene) -> None:
    before = s.earlier()
    if s.verb.kind == "makes":
        done = s("good")
        assert done.returncode == 2 and "--force" in done.stderr and s.out.read_bytes() == before
        assert s("good", "--force").returncode == 0
    elif s.verb.kind == "runs":
        done = s("good")
        assert done.returncode == 0 and "over an earlier one" in done.stdout
        (s.folder / s.verb.out).write_bytes(b"a thesis")
        assert s("good").returncode == 2
        assert s.out.read_bytes() == b"a thesis"
        return
    else:
        assert s("good").returncode == 0
    assert s.whole()


def obedient() -> None:
    """Root, too, asks for permission: gives up what lets it pass over that of files (capabilities 1 and 2)."""
    if os.geteuid() == 0:
        import ctypes

        for capability in (1, 2):
            ctypes.CDLL(None).prctl(24, capability, 0, 0, 0)  # PR_CAPBSET_DROP


def read_only_folder(s: Scene) -> None:
    folders = [s.folder, *(p for p in s.folder.rglob("*") if p.is_dir())]
    for p in folders:
        p.chmod(0o555)
    try:
        probe = subprocess.run(["touch", "x"], cwd=s.folder, preexec_fn=obedient, check=False, capture_output=True)
        if probe.returncode == 0:
            pytest.skip("this user may write anywhere")
        done = s("good", start=command.febkit, preexec_fn=obedient)
    finally:
        for p in folders:
            p.chmod(0o755)
    assert done.returncode == 2, (done.returncode, done.stderr)
    assert "nothing can be written in the folder" in done.stderr or "report: Permission denied" in done.stderr
    assert s.changed() == set() and not hidden(s.folder)


def full_disk(s: Scene) -> None:
    def small(size: int) -> str:
        return f"import resource; resource.setrlimit(resource.RLIMIT_FSIZE, ({size}, {size}))"

    before = s.earlier()
    done = s("good", *s.force(), before=small(400))
    assert done.returncode == 2, (done.returncode, done.stderr)
    assert (Path(s.verb.out).name in done.stderr) or (s.name == "run" and "m.log" in done.stderr)
    assert s.out.read_bytes() == before and not hidden(s.folder)
    if s.name == "run":
        done = s("good", before=small(len(before) // 2))
        assert done.returncode == 2
        with PlotFile(s.out) as f:
            assert f.container.leftover == 0 and len(f.states) < 201


def killed_in_mid_run(s: Scene) -> None:
    """At the worst moment: all is written, and not yet in place."""
    before = s.earlier() if s.out else b""
    job = s.paused(*s.force())
    job.kill()
    job.communicate()
    assert s.changed() <= {str(p.relative_to(s.folder)) for p in s.folder.rglob(".febkit*")}
    if s.out is not None:
        assert s.out.read_bytes() == before
    if s.verb.kind in ("makes", "runs"):
        assert s("good", *s.force()).returncode == 0, "what a dead one left blocks nothing"
        assert s.whole()


def ctrl_c(s: Scene) -> None:
    before = s.earlier() if s.out else b""
    job = s.paused(*s.force())
    job.send_signal(signal.SIGINT)
    (s.folder / "pause").unlink(missing_ok=True)
    _, said = job.communicate(timeout=60)
    assert job.returncode == 130, said
    assert "interrupted" in said and "Traceback" not in said
    assert not hidden(s.folder)
    if s.out is not None:
        assert s.out.read_bytes() == before
        assert s.changed() <= {"m.log"}
    if s.name == "run":
        assert "E R R O R   T E R M I N A T I O N" in (s.folder / "m.log").read_text()


def two_at_once(s: Scene) -> None:
    first = s.paused()
    second = s("good")
    if s.verb.kind == "runs":
        assert second.returncode == 2 and f"process {first.pid} is writing to this file" in second.stderr
    else:
        assert second.returncode == 0 and s.whole()
    (s.folder / "pause").unlink()
    _, said = first.communicate(timeout=60)
    if s.verb.kind == "makes":
        assert first.returncode == 2 and "exists already" in said
    else:
        assert first.returncode == 0, said
    assert s.whole() and not hidden(s.folder)


CHECKS = (good_input, bad_input, missing_file, output_onto_input, existing_output, read_only_folder, full_disk,
          killed_in_mid_run, ctrl_c, two_at_once)  # fmt: skip


@pytest.mark.parametrize(("name", "situation"), outputs.cells(), ids=lambda x: x.replace(" ", "-"))
def test_cell(scene: Callable[[str], Scene], name: str, situation: str) -> None:
    CHECKS[outputs.SITUATIONS.index(situation)](scene(name))


def test_the_page_has_the_table() -> None:
    text = outputs.PAGE.read_text()
    assert outputs.renewed(text) == text, "run: python tests/helpers/outputs.py --write"


def test_every_verb_is_in_the_table() -> None:
    from febkit.cli.main import VERBS

    # features touches no file; view serves a page until Ctrl-C: tests/plots/test_viewer.py
    assert set(outputs.VERBS) | {"features", "view"} == set(VERBS)


@pytest.mark.parametrize("content", [None, b"no plotfile"])
def test_view_names_what_it_cannot_read(content: bytes | None, tmp_path: Path) -> None:
    if content is not None:
        (tmp_path / "junk.xplt").write_bytes(content)
    done = forked.febkit("view", "--no-browser", "junk.xplt", folder=tmp_path)
    assert done.returncode == 2 and "junk.xplt" in done.stderr
