"""Plans, the store, and runs that fail, stop and carry on."""

from __future__ import annotations

import contextlib
import os
import socket
from pathlib import Path

import numpy as np
import pytest

from febkit import study
from febkit.model import InputError, Where
from febkit.study import work
from febkit.study.config import Method, Resources
from febkit.study.run import Outcome, do, fitting_workers
from febkit.study.store import Store
from helpers.forked import febkit

TINY = """
cases = ["A"]
methods = ["1", "2/1"]
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
at = [[0, 0, 0], [0.1, 0, 0.05], [0, -0.1, 0.1]]
"""


def written(folder: Path, text: str = TINY) -> Path:
    path = folder / "tiny.toml"
    path.write_text(text)
    return path


def plan_of(folder: Path, *overrides: str) -> study.Plan:
    return study.make_plan(study.read(written(folder), overrides))


@pytest.fixture
def pretended(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Steps that only write a file; the list says which kinds were done, in order."""
    done: list[str] = []

    def pretend(kind: str) -> object:
        def step(job: work.Job) -> None:
            done.append(kind)
            (job.folder / "out").write_text(kind)
        return step

    monkeypatch.setattr(work, "KINDS", {k: pretend(k) for k in work.KINDS})
    return done


@pytest.mark.parametrize(("entry", "word"), [
    ('cases = ["E"]', "case"), ('methods = ["4"]', "method"), ("nonsense = 1", "nonsense"),
    ('methods = ["2 splines"]', "splines"), ("[coupling]\nbox = 0", "box"),
    ("[points]\nat = [[0, 0]]", "three numbers"), ("[points]\nat = [[0, 0, 0], [0, 0, 0]]", "twice"),
    ('[points]\nfile = "none.csv"', "none.csv"), ('[cell]\nfile = "none.feb"', "none.feb"),
    ('[run]\nkeep = "some"', "keep"), ("[run]\ncores = 3", "cores"), ("cases = [", "TOML"),
    ("[cell]\nseed = []", "seeds must be"), ("[cell]\nseed = [1, 1]", "twice"),
    ("[cell]\nseed = [true]", "whole numbers"), ("[cell]\nseed = [1]\nfile = 'x.feb'", "no file"),
    ("[cell]\nseed = [1]\n[embedded]\nresults = 'x.xplt'", "no results"),
    ('[measure]\nexchange = "surface"', "nodal or consistent"), ("[measure]\nrho = 1", "rho"),
])
def test_bad_studies_are_refused_clearly(tmp_path, entry, word):
    with pytest.raises(InputError, match=word) as e:
        study.read(written(tmp_path, entry))
    assert "tiny.toml" in str(e.value)


@pytest.mark.parametrize(("entry", "said"), [
    ("name = 3", "name must be a text, not 3"),
    ("folder = 3", "folder must be a text"),
    ('control = "no"', "control must be true or false, not 'no'"),
    ("cases = 7", "case 7"),
    ("cases = []", "cases must"),
    ("cases = [['A']]", "case \\['A'\\]"),
    ('cases = ["A", "A"]', "twice"),
    ("methods = {a = 1}", "methods must be a list"),
    ("methods = [[1]]", "method"),
    ("methods = []", "methods must"),
    ('methods = ["1", "2", " 1"]', "a method is given twice"),
    ("", "there is nothing in it"),
    ("[point]\nat = [[0, 0, 0]]", "unknown entry 'point' in a study; did you mean .points."),
    ("[tissue]\ntemplate = 'cartilege'", "template of .tissue.: 'cartilege' is neither.*did you mean .cartilage."),
    ("[variants]\nedge = []", "edge of .variants. must be a list with an entry for each variant"),
    ("[variants]\nedge = [0.05, 0.1]\ncels = [1, 2]", r"\[cell\] with \[variants\]: 'cels' is no parameter"),
    ("[cases.a]\ndepht = 0.1", r"\[tissue\] with \[cases.a\]: 'depht' is no parameter"),
    ("points = 3", r"\[points\] must be a table"),
    ("[points]\nat = 5", "point 1"),
    ("[points]\nat = []", "at of .points. must"),
    ("[points]\nwhere = 5", "'where'"),
    ("[points]\nat = [[0, 0, nan]]", "three numbers"),
    ("[points]\nat = [[0, 0, true]]", "three numbers"),
    ("[points]\nat = ['abc']", "three numbers"),
    ("[points]\nfile = 3", "file of .points. must be a text"),
    ("[points]\nfile = 'tiny.toml'", "point"),
    ("[run]\nthreads = 1.5", "threads of .run. must be a whole number"),
    ('[run]\nthreads = "2"', "threads"),
    ("[run]\nthreads = true", "threads"),
    ("[run]\nthreads = -2", "from 1"),
    ("[run]\nmemory = 0", "memory of .run. must be a number above 0"),
    ("[run]\nmemory = nan", "memory"),
    ('[run]\nmemory = "2 GB"', "memory"),
    ("[run]\nworkers = -1", "workers"),
    ("[run]\nkeep = ['all']", "keep"),
    ("[measure]\nsides = ['cell']", "sides of .measure. must be"),
    ("[measure]\ndensity = 'x'", "density of .measure."),
    ("[measure]\ncells = 3", "cells of .measure."),
    ("[measure]\ncells = {a = 3}", "cells of .measure."),
    ("[coupling]\nrecovery = 'spline'", "recovery of .coupling. must be element or"),
    ("[coupling]\norder = 2", "'order'"),
    ("[coupling]\nown_part = 1", "own_part"),
    ("[tissue]\nn = 'x'", r"tiny.toml: \[tissue\]: n must be of kind integer"),
    ("[tissue]\nn = 2026-01-01", r"\[tissue\]: n must"),
    ("[cell]\nname = 'x'", r"\[cell\]: 'name' is no parameter"),
    ("[cell]\nsize = [1]", r"\[cell\]: size must be one of"),
    ("[cell]\nfile = 3", "file of .cell. must be a text"),
    ("[cell]\nseed = 1.5", r"\[cell\]: seed must"),
    ("[cell]\nfile = '.'", "must be a file"),
    ("[tissue]\ntemplate = 'tiny.toml'", "must be a folder"),
    ("tissue = 3", r"\[tissue\] must be a table"),
])
def test_entries_of_a_wrong_kind_are_named(tmp_path, entry, said):
    """No entry, whatever it is, ends in a traceback: the sentence names the file, the table and the entry."""
    with pytest.raises(InputError, match=said) as e:
        study.make_plan(study.read(written(tmp_path, entry)))
    assert "tiny.toml" in str(e.value)


@pytest.mark.parametrize("said", ["nothing", "=3", "cell.=3", "cell..seed=3", "name.first=3", "points.at.x=3"])
def test_overrides_that_say_nothing(tmp_path, said):
    with pytest.raises(InputError, match="--set"):
        study.read(written(tmp_path, 'name = "x"\n' + TINY), [said])


@pytest.mark.parametrize("folder", ["/tmp/elsewhere", "..", "../x", ".", "", "a/../..", "link"])
def test_results_stay_below_the_study(tmp_path, folder):
    """What is in the folder of the results may be deleted: a file from elsewhere does not choose it."""
    (tmp_path / "home").mkdir()
    (tmp_path / "home" / "link").symlink_to(tmp_path)
    path = written(tmp_path / "home", f'folder = "{folder}"\n' + TINY)
    with pytest.raises(InputError, match="folder"):
        study.read(path)
    assert study.read(written(tmp_path, 'folder = "a/b"\n' + TINY)).folder == tmp_path / "a" / "b"


def test_the_command_may_name_any_folder(tmp_path):
    path = written(tmp_path)
    assert study.read(path, [f"folder={tmp_path.parent}"]).folder == tmp_path.parent
    done = febkit("study", "status", path, "--set", f"folder={tmp_path / 'x'}", folder=tmp_path)
    assert done.returncode == 0 and "solve" in done.stdout
    path.write_text('folder = "/"\n' + TINY)
    done = febkit("study", "run", path, "--scheduler", "serial", folder=tmp_path)
    assert done.returncode == 2 and "--set folder=PATH" in done.stderr and "Traceback" not in done.stderr


def test_only_what_a_run_left_is_deleted(tmp_path, pretended):
    """``making`` may be a folder of the user's own, or a link to one."""
    p = plan_of(tmp_path)
    making, key = p.study.folder / "making", next(iter(p.steps()))
    mine, left = making / "thesis", making / f"{key}-abcd1234"
    for folder in (mine, left):
        folder.mkdir(parents=True)
        (folder / "x").write_text("x")
    (making / f"{key}-zzzz9999").symlink_to(mine)
    assert study.carry_out(p, "serial").complete
    assert (mine / "x").is_file() and not left.exists()
    for link in making.glob("*-zzzz9999"):
        link.unlink()
    left.mkdir()
    making.rename(tmp_path / "elsewhere")
    making.symlink_to(tmp_path / "elsewhere")
    assert study.carry_out(p, "serial").complete
    assert (tmp_path / "elsewhere" / left.name).is_dir()


@pytest.mark.parametrize("left", [
    "", "one", "a b c d", "\x00\xff\n", f"{socket.gethostname()} 999999999", "other 1",
    f"{socket.gethostname()} {os.getpid()}",
], ids=["empty", "a word", "words", "bytes", "a dead process", "another host", "a living process"])  # fmt: skip
def test_what_a_lock_file_says_does_not_matter(tmp_path, pretended, left):
    """A run that was killed leaves its lock file, empty or with anything in it; the lock itself went with it."""
    p = plan_of(tmp_path)
    p.study.folder.mkdir()
    (p.study.folder / "running").write_bytes(left.encode("latin-1"))
    assert study.carry_out(p, "serial").complete
    assert study.carry_out(p, "serial").reused == len(p.steps())


def test_damaged_records_are_made_again(tmp_path, pretended):
    p = plan_of(tmp_path)
    assert study.carry_out(p, "serial").complete
    store = Store(p.study.folder)
    last = [k for k, s in p.steps().items() if s.kind == "measure"]
    for key, text in zip(last, ("", "{", "[]", "\x00")):
        (store.path(key) / "step.json").write_text(text)
    rows = {r["kind"]: r for r in study.status(p)}
    assert rows["measure"]["to do"] == 4
    assert study.carry_out(p, "serial").complete and all(store.has(k) for k in last)
    (store.root / "failed").mkdir(exist_ok=True)
    (store.root / "failed" / f"{last[0]}.json").write_text("{")
    assert study.failures(p) == []


def test_points_from_a_file(tmp_path):
    (tmp_path / "p.csv").write_text("x,y,z\n0,0,0\n0.1,0.2,-0.3\n")
    s = study.read(written(tmp_path, '[points]\nfile = "p.csv"'))
    assert s.points == ((0, 0, 0), (0.1, 0.2, -0.3))


def test_the_graph_shares_what_is_shared(tmp_path):
    p = plan_of(tmp_path)
    kinds = [s.kind for s in p.steps().values()]
    # one tissue, one cell model, and for each of 2 methods and 3 points: drive, solve, measure
    assert {k: kinds.count(k) for k in kinds} == {"build": 2, "solve": 7, "series": 2, "drive": 6, "measure": 6}
    with_control = plan_of(tmp_path, "control=true")
    assert len(with_control.agreement) == 2
    assert [k for k in with_control.metrics if k[1] == "control"] == [study.Place("A", "control")]


def test_addresses_follow_content(tmp_path):
    a, b = plan_of(tmp_path), plan_of(tmp_path, "cell.seed=5")
    same = set(a.steps()) & set(b.steps())
    assert {a.steps()[k].label for k in same} == {
        "A tissue: build", "A tissue: solve",
        "A tissue: series of order 1 at 3 points", "A tissue: series of order 2 at 3 points"}
    assert set(a.steps()) == set(plan_of(tmp_path, "run.threads=2", 'name="other"').steps())
    # a file counts by what is in it, not by where it lies
    (tmp_path / "one").mkdir()
    (tmp_path / "one" / "c.feb").write_text("<a/>")
    (tmp_path / "c.feb").write_text("<a/>")
    keys = [set(plan_of(tmp_path, f'cell={{file="{f}"}}').steps()) for f in ("c.feb", "one/c.feb")]
    assert keys[0] == keys[1]
    (tmp_path / "c.feb").write_text("<b/>")
    assert set(plan_of(tmp_path, 'cell={file="c.feb"}').steps()) != keys[0]


def test_consistent_exchange_has_velocities_written(tmp_path):
    """The models with cells change, the tissue does not; nodal exchange, named or not, asks for nothing."""
    nodal, own = (plan_of(tmp_path, "control=true", f'measure.exchange="{e}"') for e in ("nodal", "consistent"))
    builds = {s.label: s.params["values"].get("velocity") for s in own.steps().values() if s.kind == "build"}
    assert builds == {"A tissue: build": None, "cell: build": True, "A embedded: build": True}
    assert set(plan_of(tmp_path).steps()) - {s.key for s in plan_of(tmp_path).metrics.values()} < set(nodal.steps())
    assert all(s.params == {"exchange": "consistent"} for s in own.metrics.values())


def test_units_of_a_study_go_where_results_are_read(tmp_path):
    """Only results that name none need them, so addresses are as before where the study says nothing."""
    plain, told = plan_of(tmp_path), plan_of(tmp_path, "units=um-nN-s")
    for step in told.steps().values():
        reads = step.kind in ("series", "measure")
        assert step.params.get("units") == ("um-nN-s" if reads else None), step.label
    assert all("units" not in s.params for s in plain.steps().values())
    (overlay,) = (s for s in plan_of(tmp_path, 'methods=["overlay"]', "points={}", "units=SI").steps().values()
                  if s.kind == "drive")  # fmt: skip
    assert overlay.params["units"] == "SI"
    for bad in ("inch", 3):
        with pytest.raises(InputError, match="units must be SI or mm-N-s"):
            plan_of(tmp_path, f"units={bad}")


def test_seeds_share_the_tissue(tmp_path):
    one, three = (plan_of(tmp_path, "control=true", f"cell.{s}") for s in ("seed=2", "seed=[1, 2, 3]"))
    kinds = [s.kind for s in three.steps().values()]
    assert kinds.count("build") == 1 + 3 + 3 and kinds.count("series") == 2
    # a seed among several is the same model as the one seed of [cell]
    assert set(one.steps()) < set(three.steps())
    for place, step in one.metrics.items():
        assert three.metrics[place._replace(seed=1)].key == step.key
    labels = [s.label for s in three.steps().values()]
    assert len(set(labels)) == len(labels) and "A order 1 point 3 seed 2: solve" in labels


def test_results_of_several_seeds(tmp_path, monkeypatch):
    """Each at its own place of one dataset."""
    import xarray as xr

    p = plan_of(tmp_path, "cell.seed=[4, 7]")

    def measured(plan):
        for n, place in enumerate(plan.metrics):
            yield place, xr.Dataset({"volume": (("cell", "time"), [[float(n)]])}, {"cell": ["a"], "time": [1.0]})

    monkeypatch.setattr("febkit.study.gather.finished", measured)
    ds = study.results(p)
    assert ds["volume"].dims == ("case", "handoff", "point", "seed", "cell", "time")
    for n, place in enumerate(p.metrics):
        seed = p.study.seeds[place.seed]
        assert ds["volume"].sel(case="A", handoff=place.method, point=place.point, seed=seed).item() == n


def test_results_are_gathered_in_one_unit(tmp_path, monkeypatch):
    """What an older febkit measured in MPa beside kPa; plain numbers beside named ones are refused."""
    import xarray as xr

    p = plan_of(tmp_path)
    monkeypatch.setattr(work, "KINDS", {k: lambda job: None for k in work.KINDS})
    units = iter(["kPa", "MPa", "kPa", "Pa", "kPa", "kPa"])

    def measure(job):
        unit = next(units)
        value = {"kPa": 2.0, "MPa": 2e-3, "Pa": 2e3}[unit]
        data = {"effective_stress": (("cell", "time"), [[value]], {"units": unit})}
        xr.Dataset(data, {"cell": ["a"], "time": [1.0]}).to_netcdf(job.folder / work.METRICS)

    work.KINDS["measure"] = measure
    assert study.carry_out(p, "serial").complete
    found = study.results(p)["effective_stress"]
    assert found.attrs["units"] == "kPa"
    np.testing.assert_allclose(found, 2.0, rtol=1e-15)
    path = next(tmp_path.rglob(work.METRICS))
    with xr.open_dataset(path) as ds:
        plain = ds.load()
    del plain["effective_stress"].attrs["units"]
    plain.to_netcdf(path)
    with pytest.raises(InputError, match="units that nobody named"):
        study.results(p)


def test_nothing_is_done_twice(tmp_path, pretended):
    p = plan_of(tmp_path)
    first = study.carry_out(p, "serial")
    assert first.complete and len(first.done) == len(p.steps()) == len(pretended)
    again = study.carry_out(plan_of(tmp_path), "serial")
    assert not again.done and again.reused == len(p.steps())
    more = study.carry_out(plan_of(tmp_path, 'methods=["1","2/1","3"]'), "serial")
    assert len(more.done) == 10  # its own series; drive, solve, measure at 3 points


def test_what_was_dropped_is_made_again_only_when_asked_for(tmp_path, pretended):
    p = plan_of(tmp_path, 'run.keep="metrics"')
    study.carry_out(p, "serial")
    rows = {r["kind"]: r for r in study.status(p)}
    assert rows["drive"]["done, files dropped"] == 6 and rows["measure"]["done"] == 6
    assert not study.carry_out(p, "serial").done
    store = Store(p.study.folder)
    store.drop(p.metrics[study.Place("A", "1")].key)
    pretended.clear()
    study.carry_out(p, "serial")
    assert pretended == ["drive", "solve", "measure"]


def test_a_failure_is_told_and_tried_again(tmp_path, pretended, monkeypatch):
    good = dict(work.KINDS)

    def fails(job: work.Job) -> None:
        raise work.SolveFailed("element 7 turned inside out at t = 0.1")

    monkeypatch.setattr(work, "KINDS", {**good, "series": fails})
    p = plan_of(tmp_path)
    s = study.carry_out(p, "serial")
    assert {o.label for o in s.failed} == {f"A tissue: series of order {n} at 3 points" for n in (1, 2)}
    assert len(s.skipped) == 18
    assert "element 7" in study.failures(p)[0][1]
    assert not list((p.study.folder / "making").iterdir())
    monkeypatch.setattr(work, "KINDS", good)
    s = study.carry_out(p, "serial")
    assert s.complete and len(s.done) == 20 and not study.failures(p)


def test_an_unexpected_error_leaves_no_half_result(tmp_path, pretended, monkeypatch):
    def breaks(job: work.Job) -> None:
        (job.folder / "half").write_text("half")
        raise KeyboardInterrupt

    p = plan_of(tmp_path)
    step = next(iter(p.steps().values()))
    monkeypatch.setattr(work, "KINDS", {**work.KINDS, step.kind: breaks})
    with pytest.raises(KeyboardInterrupt):
        do(str(p.study.folder), step.spec())
    assert not Store(p.study.folder).has(step.key)


def test_two_workers_at_one_step_keep_one_result(tmp_path):
    store = Store(tmp_path)
    with store.making("ab12", {"n": 1}) as (one, _), store.making("ab12", {"n": 2}) as (two, _):
        (one / "x").write_text("1")
        (two / "x").write_text("2")
    assert store.has("ab12") and store.record("ab12")["n"] == 2  # the inner one finished first
    assert len(list((tmp_path / "store" / "ab").iterdir())) == 1


def test_one_run_at_a_time(tmp_path, pretended):
    p = plan_of(tmp_path)
    store = Store(p.study.folder)
    with store.alone(), pytest.raises(InputError, match="another run"):
        study.carry_out(p, "serial")
    assert study.carry_out(p, "serial").complete


def test_workers_fit_the_machine(monkeypatch):
    monkeypatch.setattr("febkit.study.run.free_memory", lambda: 10.0)
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: range(16), raising=False)
    assert fitting_workers(Resources(threads=2, memory=1.0)) == 8
    assert fitting_workers(Resources(threads=1, memory=4.0)) == 2
    assert fitting_workers(Resources(threads=1, memory=99.0)) == 1
    assert fitting_workers(Resources(workers=3)) == 3


def test_a_killed_worker_costs_no_result(tmp_path):
    """Real solves over a local cluster, one worker killed half way: all there, once, equal to a serial run."""
    psutil = pytest.importorskip("psutil")
    pytest.importorskip("distributed")
    killed: list[int] = []

    def kill_all(done: int, total: int, outcome: Outcome) -> None:
        """After the first result, whose model and plotfile are dropped: they must not be made again."""
        workers = []
        for c in psutil.Process().children(recursive=True):
            with contextlib.suppress(psutil.Error):  # one that has just ended
                workers += [c] if "spawn_main" in " ".join(c.cmdline()) else []
        if outcome.label.endswith("measure") and not killed and workers:
            for w in workers:
                w.kill()
                killed.append(w.pid)

    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    few = ("methods=['2/1']", "points={depth=[0.4, 0.5]}", "coupling.background=tissue",
           "zones={upper={depth=[0,0.45],cell_E=0.002}, lower={depth=[0.45,1]}}")  # fmt: skip
    p, q = plan_of(tmp_path / "a", *few, "run.workers=2", "run.keep=metrics"), plan_of(tmp_path / "b", *few)
    over = study.carry_out(p, "local", kill_all)
    assert killed and over.complete
    assert sorted(o.key for o in over.done) == sorted(p.steps())
    rows = {r["kind"]: r for r in study.status(p)}
    assert rows["drive"]["done, files dropped"] == rows["solve"]["done, files dropped"] == 2
    assert study.carry_out(q, "serial").complete
    a, b = study.results(p), study.results(q)
    assert a["zone"].values.tolist() == ["upper", "lower"]
    assert a.sizes == {"case": 1, "handoff": 1, "point": 2, "cell": 1, "time": 3, "axis": 3, "xyz": 3}
    assert np.isfinite(a["effective_strain"]).all()
    for name in a.data_vars:
        # other numbers of BLAS threads round otherwise
        np.testing.assert_allclose(a[name], b[name], rtol=1e-8, atol=1e-14, err_msg=str(name))


def test_report_of_a_small_study(tmp_path, monkeypatch):
    pytest.importorskip("matplotlib")
    kept = []
    monkeypatch.setattr("febkit.process.keep_freed_memory", lambda: kept.append(True))
    p = plan_of(tmp_path, "points={at=[[0,0,0]]}", 'methods=["auto"]')
    assert study.carry_out(p, "serial").complete
    found = study.results(p)
    assert np.isfinite(found["effective_strain_uncertainty"]).all()  # of a hand-off whose error was estimated
    assert (found["effective_strain_uncertainty"].isel(time=-1) > 0).all()
    files = [f.name for f in study.write_report(p, tmp_path / "report")]
    assert {"metrics.nc", "report.md", "histories_A.png", "section_A.png"} <= set(files)
    text = (tmp_path / "report" / "report.md").read_text()
    assert "A order auto: solve" in text and "effective stress (kPa)" in text
    solves = text[text.index("**Solves**") :].splitlines()
    rows = [[c.strip() for c in r.split("|")[1:-1]] for r in solves if r.startswith("| ")][1:]
    total = sum(float(r[3]) for r in rows[:-1])
    assert len(kept) == 2  # as febkit run does
    assert rows[-1][0] == "2 solves" and float(rows[-1][3]) == pytest.approx(total, abs=0.3)
    assert [r[1] for r in rows[:-1]] == ["27", rows[1][1]] and int(rows[1][1]) > 100


def test_auto_asks_for_the_size_of_the_cell_model(tmp_path):
    """Nothing else changes its address; a box in [coupling] has all series estimate their error."""
    plain, auto = plan_of(tmp_path), plan_of(tmp_path, 'methods=["1", "2/1", "auto", "auto element"]')
    assert set(plain.steps()) < set(auto.steps())
    told = [s.params for s in auto.steps().values() if s.kind == "series" and s.params["order"] == "auto"]
    assert [t["box"] for t in told] == [0.05, 0.05] and told[1]["recovery"] == "element"
    boxed = plan_of(tmp_path, "coupling.box=0.07", 'methods=["1", "auto"]')
    assert {s.params["box"] for s in boxed.steps().values() if s.kind == "series"} == {0.07}
    (tmp_path / "c.feb").write_text("<a/>")
    with pytest.raises(InputError, match="say its edge, box in"):
        plan_of(tmp_path, 'methods=["auto"]', 'cell={file="c.feb"}')
    assert plan_of(tmp_path, 'methods=["auto"]', 'cell={file="c.feb"}', "coupling.box=0.1").metrics


def test_a_method_names_the_order_of_the_solutes_apart() -> None:
    where = Where("study.toml")
    both = Method.parse("2/1", where), Method.parse("2/2/1 element", where)
    assert [(m.solid, m.fluid, m.solute, m.recovery) for m in both] == [(2, 1, None, None), (2, 2, 1, "element")]
    with pytest.raises(InputError, match="must be an order"):
        Method.parse("1/1/1/1", where)
