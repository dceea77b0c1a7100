"""``febkit.fit`` on models: known truth, several experiments, data of all kinds, fit.toml."""

from __future__ import annotations

import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr

import febkit
from febkit.fitting import data, toml
from febkit.fitting.experiment import Experiment, Measured
from febkit.model import InputError
from helpers.forked import febkit as command
from helpers.specimens import SPECIMENS, Specimen

BAR = SPECIMENS["viscoelastic"]


@pytest.fixture(scope="module")
def measured() -> np.ndarray:
    return BAR.measured()


@pytest.mark.parametrize("name", ["viscoelastic", "unconfined"])
def test_the_truth_is_found(name: str, measured: np.ndarray) -> None:
    s: Specimen = SPECIMENS[name]
    f = febkit.fit(s.model(), s.bounds, measured if s is BAR else s.measured(), s.observe)
    assert f.converged and f.runs <= 22 and f.identifiability == []
    for path, value in s.truth.items():
        assert f[path] == pytest.approx(value, rel=1e-4), path


def test_noise_leaves_the_truth_within_the_intervals(measured: np.ndarray) -> None:
    """Of one draw of noise; tests/benchmarks/fits.py counts a hundred."""
    noisy = measured.copy()
    noisy[:, 1] += 0.001 * np.random.default_rng(3).normal(size=len(noisy))
    f = febkit.fit(BAR.model(), BAR.bounds, noisy, BAR.observe, sigma=0.001)
    for path, (low, high) in f.intervals.items():
        assert low < BAR.truth[path] < high and high - low > 1e-3 * BAR.truth[path]
    rows = f.data()
    assert rows["observed"].unique().tolist() == ["reaction top z"] and 0.4 < rows["residual"].std() < 1.6
    assert f.axis("experiment 1") == "time" and len(f.plot().axes) == 2


def test_runs_bring_derivatives(measured: np.ndarray) -> None:
    """A run a trial: those of the equations are those of differences, through a logarithm and a tie."""
    m = BAR.model()
    spec = {k: v for k, v in BAR.bounds.items() if k != "c.g1"} | {"c.g1": "0.6 * c.elastic.E"}
    f = febkit.fit(m, spec, measured, BAR.observe, exact=True)
    g = febkit.fit(m, spec, measured, BAR.observe, exact=False)
    assert f.converged and f.values == pytest.approx(g.values, rel=1e-4) and f.runs < g.runs
    np.testing.assert_allclose(f.statistics.directions[0].weights, g.statistics.directions[0].weights, rtol=1e-2)


def test_experiments_share_some_parameters_and_have_others_alone(measured: np.ndarray) -> None:
    """A second bar is twice as stiff and pulled half as far; its stretch is given through a load curve."""
    half = "fem.load_controller[0].points[1].y"
    stiff = BAR.model()
    stiff["c.elastic.E"], stiff[half] = 2.0, 0.5
    more = stiff.solve(at=BAR.times, threads=1).dataset.febkit.reaction("top").sel(xyz="z").values
    shared = {k: v for k, v in BAR.bounds.items() if k != "c.elastic.E"}
    f = febkit.fit(
        [febkit.Experiment(BAR.model(), measured, BAR.observe, name="soft",
                           parameters={"c.elastic.E": (0.2, 1.5, 5)}),
         febkit.Experiment(BAR.model(), (BAR.times, more), BAR.observe, name="stiff", settings={half: 0.5},
                           parameters={"c.elastic.E": (0.2, 1.5, 5)})],
        shared,
    )  # fmt: skip
    wanted = {"c.g1": 0.6, "c.t1": 20.0, "soft: c.elastic.E": 1.0, "stiff: c.elastic.E": 2.0}
    assert f.converged and f.values == pytest.approx(wanted, rel=1e-4)
    assert f.model("stiff")["c.elastic.E"] == pytest.approx(2.0, rel=1e-4) and set(f.R2) == {"soft", "stiff"}


def test_ties_two_observables_and_another_axis() -> None:
    """Stress and force over strain say the modulus of a bar whose g1 is tied to it."""
    m = BAR.at(BAR.truth)
    ds = m.solve(variables=["displacement", "stress", "Lagrange strain", "reaction forces"], threads=1).dataset
    ds = ds.sel(time=slice(0.5, 1.5))  # of the ramp: strain says no more while it is held
    force = ds.febkit.reaction("top").sel(xyz="z").values
    frame = pd.DataFrame({"s": ds.febkit.mean("stress:zz").values, "f": force},
                         index=ds.febkit.mean("Lagrange strain:zz").values)  # fmt: skip
    f = febkit.fit(
        m, {"c.elastic.E": (0.2, 1.5, 5.0), "c.g1": "0.6 * c.elastic.E"}, frame,
        {"s": "stress part bar zz", "f": "reaction top z"}, against="Lagrange strain part bar zz",
    )  # fmt: skip
    assert f.converged and f["c.elastic.E"] == pytest.approx(1.0, rel=1e-3)
    assert f.settings()["c.g1"] == pytest.approx(0.6 * f["c.elastic.E"])
    assert f.axis("experiment 1").startswith("Lagrange")


# ---- data -----------------------------------------------------------------------------------------------
def test_data_of_all_kinds_are_the_same(tmp_path: Path) -> None:
    t, a, b = np.array([1.0, 2.0, 3.0]), np.array([4.0, 5.0, 6.0]), np.array([7.0, np.nan, 9.0])
    path = tmp_path / "d.csv"
    path.write_text("# a comment\ntime, a, b\n1,4,7\n2,5,\n3,6,9\n")
    savetxt = tmp_path / "e.csv"
    np.savetxt(savetxt, np.column_stack([t, a, b]), delimiter=",", header="time,a,b", comments="")
    frame = pd.DataFrame({"time": t, "a": a, "b": b})
    given: list[Any] = [path, str(path), savetxt, np.column_stack([t, a, b]), (t, a, b), frame, frame.set_index("time"),
                        frame[["time", "b", "a"]], xr.Dataset({"a": ("t", a), "b": ("t", b)}, {"t": t})]  # fmt: skip
    for d in given:
        found = data.columns(d, ["a", "b"])
        assert [found["a"][0].tolist(), found["a"][1].tolist()] == [[1, 2, 3], [4, 5, 6]], d
        assert [found["b"][0].tolist(), found["b"][1].tolist()] == [[1, 3], [7, 9]], d
    for single in (frame.set_index("time")["a"], xr.DataArray(a, {"t": t}, ("t",), name="a"), np.column_stack([t, a])):
        assert data.columns(single, ["force"])["force"][1].tolist() == [4, 5, 6]


@pytest.mark.parametrize(
    ("given", "why"),
    [
        ([1.0, 2.0], "data are"), ("none.csv", "none.csv: cannot read"), (np.ones((3, 4)), "3 columns"),
        (np.array([[1.0, np.nan]]), "no finite values"), (np.array([[1.0, np.inf]]), "that is not finite"),
        (pd.Series(["x"], [1.0]), "must be numbers"),
    ],
)  # fmt: skip
def test_data_that_are_none(given: Any, why: str) -> None:
    with pytest.raises(InputError, match=why):
        data.columns(given, ["force"])


def test_infinite_values_of_a_file_have_a_line(tmp_path: Path) -> None:
    (tmp_path / "d.csv").write_text("time,a\n1,4\n2,inf\n")
    with pytest.raises(InputError, match=r"d.csv:3: '2,inf' has a value that is not finite"):
        data.columns(tmp_path / "d.csv", ["a"])


def test_what_cannot_be_fitted_is_said(measured: np.ndarray) -> None:
    m, one = BAR.model(), {"c.elastic.E": (0.2, 1.5, 5.0)}
    for args, why in (
        ((m, {"c.elastic.G": (0, 1, 2)}, measured, BAR.observe), "no parameter 'G'"),
        ((m, {"c.elastic": (0, 1, 2)}, measured, BAR.observe), "what is fitted is a number"),
        ((m, one), "needs data="),
        ((m, one, (BAR.times + 50, measured[:, 1]), BAR.observe), "leave out what it does not come to"),
        ((m, one, measured, "reaction lid z"), "lid"),
        ((m, one, (BAR.times - 50, measured[:, 1]), BAR.observe), "before time 0"),
        ((m, {**one, "c.g1": (0, 0.5, 1)}, measured[:1], BAR.observe), "2 parameters .* from 1 values of data"),
    ):
        with pytest.raises(InputError, match=why):
            febkit.fit(*args)
    with pytest.raises(InputError, match="choose from least_squares"):
        febkit.fit(m, one, measured, BAR.observe, method="newton")


# ---- fit.toml -------------------------------------------------------------------------------------------
TOML = """
method = "least_squares"
tolerance = 1e-7
sigma = 0.01
model = "m.feb"
[parameters]
"c.elastic.E" = [0.2, 1.5, 5]
k = { low = 1e-4, start = 1e-3, high = 0.1, log = true, paths = ["c.t1", "d.t1"] }
"c.g1" = "0.6 * k"
[[experiment]]
name = "fast"
data = "fast.csv"
observe = { f = "reaction top z" }
[[experiment]]
data = "slow.csv"
observe = "reaction top z"
meet = false
settings = { "fem.bc[0].value" = 2 }
parameters = { "c.t2" = [1, 2, 3] }
"""


def test_a_file_says_what_the_call_says(tmp_path: Path) -> None:
    path = tmp_path / "fit.toml"
    path.write_text(TOML)
    asked = toml.read(path)
    fast, slow = asked.experiments
    assert fast.name == "fast" and fast.model == tmp_path / "m.feb" and fast.sigma == slow.sigma == 0.01
    assert slow.meet is False and slow.settings == {"fem.bc[0].value": 2}
    assert dict(slow.parameters)["c.t2"] == febkit.Parameter(1, 2, 3)
    assert asked.parameters["k"] == febkit.Parameter(1e-4, 1e-3, 0.1, True, ("c.t1", "d.t1"))
    assert asked.parameters["c.g1"] == "0.6 * k" and asked.options["tolerance"] == 1e-7


@pytest.mark.parametrize(
    ("old", "new", "why"),
    [
        ('method = "least_squares"', 'method = "guess"', "least_squares or differential_evolution"),
        ('data = "fast.csv"', "", "data is missing"), ("[0.2, 1.5, 5]", "[0.2, 1.5]", "a formula"),
        ("tolerance", "tolerence", "unknown entry 'tolerence' in a fit"),
        ("log = true", 'log = "yes"', "true or false"),
        ("meet = false", "meet = 3", "true or false"), ("[parameters]", "[parameters", "not well-formed"),
    ],
)  # fmt: skip
def test_a_file_that_says_nothing_is_refused(tmp_path: Path, old: str, new: str, why: str) -> None:
    path = tmp_path / "fit.toml"
    path.write_text(TOML.replace(old, new, 1))
    with pytest.raises(InputError, match=why) as e:
        toml.read(path)
    assert "fit.toml" in str(e.value)


@pytest.mark.parametrize(
    ("old", "new", "where"),
    [
        ("elastic.E", "elastic.G", ":5: c.elastic.G: a .* has no parameter 'G'"),
        ("[0.2, 1.5, 5]", "[5, 1.5, 0.2]", ":5: c.elastic.E: low <= start <= high is wanted"),
        ("[0.2, 1.5, 5]", '["a", 1.5, 5]', ":5: low of .* must be a number"),
        ("model", "modle", ":1: unknown entry 'modle'"),
        ("[parameters]", "settings = { \"c.Q\" = 1 }\n[parameters]", ": c.Q: .* no parameter 'Q'"),
        ("top z", "lid z", ":3: experiment 1: observe 'reaction lid z': .*'lid'"),
        ("reaction top", "reacton top", ":3: experiment 1: observe: observable 'reacton top z'"),
        ("1,-0.1\n", "1,-0.1\n900,-0.1\n", ": experiment 1: data lie at 1 to 900, the run's end at"),
        ("elastic.E\" = [0.2, 1.5, 5]", "elastic.E\" = [0.2, 1.5, 5]\n\"c.g1\" = [0, 0.5, 1]", ":5: 2 parameters"),
    ],
)  # fmt: skip
def test_errors_name_the_file_and_the_line_of_what_they_tell_of(tmp_path: Path, old: str, new: str, where: str) -> None:
    text = 'model = "m.feb"\ndata = "d.csv"\nobserve = "reaction top z"\n[parameters]\n"c.elastic.E" = [0.2, 1.5, 5]\n'
    BAR.model().write(tmp_path / "m.feb")
    (tmp_path / "d.csv").write_text("1,-0.1\n".replace(old, new))
    (tmp_path / "fit.toml").write_text(text.replace(old, new, 1))
    done = command("fit", "fit.toml", folder=tmp_path)
    assert done.returncode == 2 and re.match(f"febkit: fit.toml{where}", done.stderr), done.stderr


def test_models_of_full_newton_are_fitted_by_updates_and_by_full_newton_where_these_fail(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    s = SPECIMENS["unconfined"]
    e, real = Measured(Experiment(s.model(), s.measured(), s.observe), "e", {"threads": 1}), febkit.Model.solve
    solved: list[Any] = []

    def solve(self: febkit.Model, *given: Any, **options: Any) -> Any:
        solved.append(real(self, *given, **options))
        if options.get("quasi") and fails:
            return SimpleNamespace(converged=False, interrupted=False, reason="no balance is found")
        return solved[-1]

    monkeypatch.setattr(febkit.Model, "solve", solve)
    fails = False
    free = e.predict(s.truth)
    assert len(solved) == 1 and solved[0].totals.reforms == solved[0].totals.iterations
    quick = e.predict(s.truth, free.ends)
    assert len(solved) == 2 and 2 * solved[1].totals.reforms < solved[1].totals.iterations
    fails = True
    own = e.predict(s.truth, free.ends)
    assert len(solved) == 4 and solved[3].totals.reforms == solved[3].totals.iterations
    e.predict(s.truth, free.ends)
    assert len(solved) == 5, "updates were tried again"
    assert own.ends == quick.ends and own.found == pytest.approx(quick.found, rel=1e-4)
    assert quick.found == pytest.approx(e.y, rel=1e-4)
