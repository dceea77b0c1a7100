"""Ways to the best parameters and what is said of them, on curves that cost nothing."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from febkit.fitting import methods
from febkit.fitting.methods import Tolerance
from febkit.fitting.parameters import Parameter, read
from febkit.fitting.problem import Failed, Made, Problem, Stopped
from febkit.fitting.result import Fit, finished
from febkit.fitting.statistics import statistics, words
from febkit.model import InputError

X = np.linspace(0.0, 2.0, 30)
NEAR = Tolerance(1e-10, 1e-8)


def experiment(f: Callable[..., Any], y: Any, by: Callable[[Any], Any] = lambda s: {}) -> Any:
    """What a model shows as a function of its settings, in order."""
    return SimpleNamespace(
        name="e", model=None, x=X, y=np.asarray(y), weight=np.ones(len(X)), observed=[("y", len(X))], axis="x",
        predict=lambda s, ends=None, beside=False: Made(np.asarray(f(*s.values())), [], by(s)),
        tighten=lambda much=True: False,
    )  # fmt: skip


def decay(a: float, k: float) -> Any:
    return a * np.exp(-k * X)


def posed(f: Any = decay, truth: Any = (2.0, 1.5), noise: float = 0.0, seed: int = 0, **spec: Any) -> Problem:
    y = f(*truth) + noise * np.random.default_rng(seed).normal(size=len(X))
    return Problem(read(spec or {"a": (0.1, 0.5, 10.0), "k": Parameter(0.01, 0.3, 20.0, log=True)}), [experiment(f, y)])


def fitted(p: Problem, tolerance: Tolerance = NEAR) -> Fit:
    return finished(p, lambda: methods.least_squares(p, tolerance))


def test_least_squares_finds_the_truth_with_fewer_runs_than_differences_at_each_step() -> None:
    p = posed()
    f = fitted(p)
    assert f.converged and f.values == pytest.approx({"a": 2.0, "k": 1.5}, rel=1e-6)
    assert f.runs < 3 * (p.trials - 1)  # two differences a trial


def test_a_bound_that_holds_the_best_back() -> None:
    f = fitted(posed(noise=0.01, a=(0.1, 0.5, 1.5), k=(0.1, 0.3, 5.0)))
    assert f.converged and f["a"] == 1.5
    assert np.isnan(f.intervals["a"]).all() and "a is at its bound" in f.identifiability[0]
    assert not np.isnan(f.intervals["k"]).any()


def test_of_what_is_at_its_bound_no_differences_are_made() -> None:
    from scipy.optimize import least_squares

    seen: list[tuple[float, float]] = []

    def curve(a: float, k: float) -> Any:
        seen.append((a, k))
        return decay(a, k)

    p = posed(noise=0.01, a=(0.1, 0.5, 1.5), k=(0.1, 0.3, 5.0))
    y = p.experiments[0].y
    p.experiments = [experiment(curve, y)]
    f = fitted(p)
    there = [a for a, _ in seen].index(1.5)
    assert all(a == 1.5 for a, _ in seen[there:])
    best = least_squares(lambda q: decay(*q) - y, (0.5, 0.3), bounds=((0.1, 0.1), (1.5, 5.0)), xtol=1e-12)
    assert f.values == pytest.approx(dict(zip("ak", best.x)), rel=1e-5)


def test_runs_that_fail_are_steps_too_long() -> None:
    def fragile(a: float, k: float) -> Any:
        if a > 2.2 or k > 1.9:
            raise Failed("the element turned inside out")
        return decay(a, k)

    f = fitted(posed(fragile, a=(0.1, 0.5, 10.0), k=(0.01, 1.85, 20.0)))
    assert f.converged and f.failures and f.values == pytest.approx({"a": 2.0, "k": 1.5}, rel=1e-6)


def test_what_never_solves_is_said() -> None:
    def never(a: float) -> Any:
        raise Failed("no step converges")

    p = Problem(read({"a": (0.0, 1.0, 2.0)}), [experiment(never, X)])
    with pytest.raises(InputError, match="starting values: no step converges"):
        fitted(p)


def test_a_limit_of_runs_gives_the_best_so_far() -> None:
    p = posed()
    p.most = 6
    f = fitted(p)
    assert not f.converged and "6 runs" in f.reason and f.runs == 6 and f.objective == p.best.objective  # type: ignore[union-attr]


def test_ctrl_c_gives_the_best_so_far() -> None:
    calls: list[float] = []

    def stopped(a: float, k: float) -> Any:
        calls.append(a)
        if len(calls) == 8:
            raise KeyboardInterrupt
        return decay(a, k)

    p = Problem(read({"a": (0.1, 0.5, 10.0), "k": (0.01, 0.3, 20.0)}), [experiment(stopped, decay(2.0, 1.5))])
    f = fitted(p)
    assert f.interrupted and not f.converged and f.objective == p.best.objective  # type: ignore[union-attr]


def test_linear_constraints_hold() -> None:
    p = posed(noise=0.01, a=(0.1, 0.5, 10.0), k=(0.1, 0.3, 5.0))
    A, b = np.array([[1.0, 1.0]]), np.array([3.0])
    e = methods.least_squares(p, NEAR, A=A, b=b)
    a, k = p.parameters.values(e.z)
    around = [p.objective(np.array([v / 0.5, (3.0 - v) / 0.3])) for v in (a - 1e-3, a, a + 1e-3)]
    assert e.converged and a + k == pytest.approx(3.0, abs=1e-8) and around[1] == min(around)
    with pytest.raises(Stopped, match="cannot be met"):
        methods.least_squares(p, NEAR, A=A, b=np.array([99.0]))


def test_the_other_methods() -> None:
    p = posed(a=(0.0, 0.5, 4.0), k=(0.0, 0.5, 4.0))
    assert p.parameters.values(methods.powell(p, Tolerance(1e-6, 1e-4)).z) == pytest.approx([2.0, 1.5], rel=1e-3)
    p = posed(a=(0.0, 0.5, 4.0), k=(0.0, 0.5, 4.0))
    assert p.parameters.values(methods.scan(p, [0.5, 0.5]).z) == pytest.approx([2.0, 1.5]) and p.runs == 81

    def waves(a: float, k: float) -> Any:  # many valleys
        return np.sin(3 * a * X) + 0.1 * k * X

    p = posed(waves, (2.3, 1.0), a=(0.1, 0.2, 5.0), k=(0.0, 0.5, 2.0))
    assert not fitted(p).objective < 1.0
    z = methods.everywhere(p)
    assert methods.least_squares(p, NEAR, start=z).converged and p.best.objective < 1e-12  # type: ignore[union-attr]


def test_exact_derivatives_take_the_place_of_differences() -> None:
    """Through logarithms and ties, and a run a trial is all that is made."""
    def by(s: Any) -> Any:
        return {"a": decay(1.0, s["k"]), "k": -X * decay(s["a"], s["k"])}

    p = posed()
    exact = Problem(p.parameters, [experiment(decay, p.data, by)])
    z = p.parameters.start
    np.testing.assert_allclose(exact.jacobian(z), p.jacobian(z), rtol=1e-2, atol=1e-6)
    assert (exact.runs, p.runs) == (1, 3)
    f = fitted(exact)
    assert f.converged and f.values == pytest.approx({"a": 2.0, "k": 1.5}, rel=1e-6) and f.runs == exact.trials
    half = read({"a": (0.1, 0.5, 10.0), "k": "0.75 * a"})
    one, two = (Problem(half, [experiment(decay, p.data, g)]) for g in (by, lambda s: {}))
    np.testing.assert_allclose(one.jacobian(half.start), two.jacobian(half.start), rtol=1e-2)


# ---- statistics -----------------------------------------------------------------------------------------
@pytest.mark.parametrize("known", [False, True])
def test_intervals_hold_the_truth_as_often_as_they_say(known: bool) -> None:
    """Of 200 noisy fits, 95 % within three standard deviations of that count."""
    held = np.zeros(2)
    for seed in range(200):
        p = posed(noise=0.02, seed=seed)
        e = methods.least_squares(p, Tolerance(1e-4, 1e-4))
        assert e.J is not None
        s = 50.0 if known else 1.0
        found = statistics(p.parameters, e.z, s * p.residuals(e.z), s * e.J, known)
        held += (found.low <= [2.0, 1.5]) & (found.high >= [2.0, 1.5])
    assert (np.abs(held - 190) < 3 * np.sqrt(200 * 0.95 * 0.05)).all(), held


def test_covariance_is_that_of_linear_regression() -> None:
    p = posed(lambda a, b: a + b * X, (1.0, 2.0), noise=0.1, a=(-9.0, 0.5, 9.0), b=(-9.0, 0.5, 9.0))
    f = fitted(p)
    wanted, cov = np.polyfit(X, p.data, 1, cov="unscaled")
    s2 = f.objective / (len(X) - 2)
    assert [f["b"], f["a"]] == pytest.approx(wanted, rel=1e-6)
    np.testing.assert_allclose(f.covariance.loc[["b", "a"], ["b", "a"]], s2 * cov, rtol=1e-5)
    assert f.correlation.loc["a", "b"] == pytest.approx(cov[0, 1] / np.sqrt(cov[0, 0] * cov[1, 1]), rel=1e-5)


def test_what_the_data_cannot_tell_is_said() -> None:
    f = fitted(posed(lambda a, b, c: a * b * X + 0 * c, (1.0, 2.0, 1.0), noise=0.01,
                     a=(0.1, 1.0, 9.0), b=(0.1, 2.5, 9.0), c=(0.0, 1.0, 3.0)))  # fmt: skip
    said = " | ".join(f.identifiability)
    assert "do not tell a and b apart" in said or "do not tell b and a apart" in said
    assert "down 1 %" in said and "say nothing of c" in said
    f = fitted(posed(noise=1.0, a=(0.01, 0.5, 50.0), k=(0.01, 0.3, 20.0)))
    assert any("% only" in line for line in f.identifiability)


def test_words_of_a_fit_that_tells_all() -> None:
    f = fitted(posed(noise=0.01))
    assert f.statistics is not None and words(f.statistics, f.names) == []
    assert "the data tell all parameters apart" in repr(f) and "<table" in f._repr_html_()
    assert f.R2["e"] > 0.99 and list(f.data().columns)[-1] == "residual" and f


# ---- parameters -----------------------------------------------------------------------------------------
def test_ties_and_own_parameters() -> None:
    p = read(
        {("m.E", "n.E"): (1.0, 2.0, 3.0), "m.k": "2 * m.E + own"} | {"own": Parameter(0.0, 1.0, 2.0, paths=("m.v",))},
        {"first": {"m.c": (0.0, 0.5, 1.0)}},
    )
    assert p.names == ["m.E", "own", "first: m.c"]
    values = np.array([1.5, 0.5, 0.7])
    assert p.settings(values, "second") == {"m.E": 1.5, "n.E": 1.5, "m.v": 0.5, "m.k": 3.5}
    assert p.settings(values, "first") == p.settings(values, "second") | {"m.c": 0.7}
    assert p.concern("second") == [True, True, False]


@pytest.mark.parametrize(
    ("spec", "why"),
    [
        ({}, "needs parameters"),
        ({"a": (0.0, 5.0, 1.0)}, "low <= start <= high"),
        ({"a": (0.0, 1.0)}, r"\(low, start, high\) is wanted"),
        ({"a": Parameter(0.0, 1.0, 2.0, log=True)}, "bounds above 0"),
        ({"a": (0.0, 1.0, 2.0), "b": "2 * c"}, "c is no parameter; there are a"),
    ],
)
def test_parameters_that_mean_nothing(spec: dict[Any, Any], why: str) -> None:
    with pytest.raises(InputError, match=why):
        read(spec)



class Rough:
    """A decay whose curve jumps with its parameters, as that of a model does whose iterations end early."""

    def __init__(self, fails: bool = False) -> None:
        self.fails, self.tight, self.rough_runs = fails, False, 0

    def __call__(self, a: float, k: float) -> Any:
        if self.tight and self.fails:
            raise Failed("no balance is found")
        self.rough_runs += not self.tight
        return decay(a, k) + (0.0 if self.tight else 2e-3 * np.sin(1e7 * a * k + X))

    def tighten(self, much: bool = True) -> bool:
        changed, self.tight = self.tight != much, much
        return changed

    def slopes(self, s: Any) -> Any:
        a, k = s.values()
        return {"a": np.exp(-k * X), "k": -a * X * np.exp(-k * X)}

    def problem(self) -> Problem:
        y = decay(2.0, 1.5) + 0.01 * np.random.default_rng(3).normal(size=len(X))
        e = experiment(self, y, self.slopes)
        e.tighten = self.tighten
        return Problem(read({"a": (0.1, 0.5, 10.0), "k": (0.01, 0.3, 20.0)}), [e])


def test_models_whose_curves_do_not_keep_what_derivatives_promise_are_solved_to_more_digits() -> None:
    rough, smooth = Rough(), Rough()
    smooth.tight = True
    best = fitted(smooth.problem())
    f = fitted(rough.problem())
    assert f.converged and f.values == pytest.approx(best.values, rel=1e-6)
    assert rough.tight and rough.rough_runs < 15
    assert f.intervals["k"] == pytest.approx(best.intervals["k"], rel=1e-4)


def test_where_more_digits_cannot_be_had_the_fit_ends_as_before() -> None:
    rough = Rough(fails=True)
    f = fitted(rough.problem())
    assert not rough.tight and f.values == pytest.approx({"a": 2.0, "k": 1.5}, rel=0.02)


def test_time_steps_that_alternate_do_not_keep_a_noisy_fit_going() -> None:
    """Free steps are of one kind on one side of the best, of another on the other, and pull it across each time."""
    turn, calls = 1.5, []

    def predict(s: Any, ends: Any = None, beside: bool = False) -> Made:
        a, k = s.values()
        calls.append(ends)
        own = [1.0] if k < turn else [2.0]
        pull = 5e-4 if (ends or own) == [1.0] else -5e-4
        return Made(decay(a, k - pull), list(ends or own), {"a": np.exp(-k * X), "k": -a * X * np.exp(-k * X)})

    y = decay(2.0, turn) + 0.05 * np.random.default_rng(1).normal(size=len(X))
    turn = fitted(Problem(read({"a": (0.1, 2, 10.0), "k": (0.01, 1, 20.0)}), [experiment(decay, y)])).values["k"]
    e = experiment(decay, y)
    e.predict = predict
    p = Problem(read({"a": (0.1, 0.5, 10.0), "k": (0.01, 0.3, 20.0)}), [e])
    f = finished(p, lambda: methods.steadied(p, lambda z: methods.least_squares(p, NEAR, start=z)))
    assert f.converged and calls.count(None) == 3 and abs(f["k"] - turn) < 1e-3
    assert not np.isnan(f.intervals["k"]).any()
