"""Two threads give what one gives: forces, tangents whose entries both add to, whole runs."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pytest

from febkit.solver import schedule
from febkit.solver.group import Group
from febkit.solver.kernels import pattern as kernels
from febkit.solver.linear.base import Matrix
from febkit.solver.options import Options
from febkit.solver.permeabilities.const_iso import ConstIso
from febkit.solver.permeabilities.holmes_mow import HolmesMow
from febkit.solver.physics.biphasic import Biphasic
from febkit.solver.problem import TRANSIENT, Fixed, Prescribed, Problem, Step
from febkit.solver.run import Listener, Run, run
from febkit.solver.schedule import LEAST, Schedule
from febkit.solver.solids.neo_hookean import NeoHookean
from febkit.solver.state import State
from febkit.solver.system import System
from febkit.solver.threads import Team
from febkit.solver.ties import LinearConstraint, Ties
from helpers import scenes
from helpers.scenes import UX, UZ, P

SIDE = 9  # elements along each edge: 729, enough for two threads


def problem(permeability: Any = None, solid: bool = False, tied: bool = False) -> Problem:
    """A cube pressed between rough plates; ``tied``: some of its nodes move together."""
    X, conn = scenes.box("hex8", (SIDE, SIDE, SIDE), distort=0.2)
    low, high = np.flatnonzero(X[:, 2] < 1e-9), np.flatnonzero(X[:, 2] > 1 - 1e-9)
    conditions: list[Any] = [Fixed(c, low) for c in range(UX, UZ + 1)] + [Fixed(c, high) for c in (0, 1)]
    conditions.append(Prescribed(UZ, high, scenes.ramp(-0.1, 1.0)))
    mixture = None if solid else Biphasic(permeability or ConstIso(0.1))
    step = Step(dt=0.5, count=2, newton=scenes.tight(dtol=1e-8, ptol=1e-8, min_residual=1e-28), conditions=conditions)
    if not solid:
        step.analysis = TRANSIENT
        conditions.append(Fixed(P, np.flatnonzero(np.abs(X[:, 0] - 0.5) > 0.5 - 1e-9)))
    if tied:
        middle = np.flatnonzero((np.abs(X - 0.5) < 0.2).all(axis=1))
        far = np.array([np.linalg.norm(X - (0.15, 0.5, 0.5), axis=1).argmin()])  # of elements that do not touch these
        step.constraints = [LinearConstraint(int(q), UX, far, np.array([UX]), (1.0,)) for q in middle]
    return Problem(X, [scenes.block("hex8", conn, NeoHookean(1.0, 0.2), mixture)], [step])


def assembled(p: Problem, threads: int, chunk: int = 64) -> tuple[System, np.ndarray, Any, np.ndarray]:
    """A system after a random motion: residual, tangent and the prescribed increments' share."""
    state, step = State.at_rest(p), p.steps[0]
    groups = [Group(b, p.X, chunk, state.layout) for b in p.blocks]
    s = System(p, step, groups, state, Schedule(groups, Team(threads)))
    state.time = state.dt = 0.5
    u = 0.01 * np.random.default_rng(3).normal(size=s.eqs.n)
    zero = np.zeros(s.eqs.n)
    s.set(zero, zero, u, s.targets(state.time))
    R = s.residual()
    A, Fd = s.tangent(u)
    return s, R, A, Fd


def same(two: Any, one: Any) -> None:
    (_, R, A, Fd), (_, R2, A2, Fd2) = one, two
    np.testing.assert_array_equal(A2.indices, A.indices)
    for b, a in ((A2.data, A.data), (R2, R), (Fd2, Fd)):
        np.testing.assert_allclose(b, a, atol=1e-14 * np.abs(a).max(), rtol=0)


CASES: dict[str, dict[str, Any]] = {
    "solid": {"solid": True},
    "mixture": {},
    "mixture, not symmetric": {"permeability": HolmesMow(0.1, 1.0, 2.0)},
    "tied": {"solid": True, "tied": True},
}


@pytest.mark.parametrize("case", CASES)
def test_two_threads_assemble_what_one_does(case: str) -> None:
    """Entries that elements of both threads add to are among them."""
    p = problem(**CASES[case])
    one, two = assembled(p, 1), assembled(p, 2)
    assert one[0].schedule.n == 1 and two[0].schedule.n == 2 and p.blocks[0].conn.shape[0] >= 2 * LEAST
    shared = two[0].schedule.contended(two[0].groups, len(p.X))
    assert 0 < sum(q.sum() for q in shared.values()) < p.blocks[0].conn.shape[0]
    same(two, one)


class Watch:
    """Whose share is at work, whether others are as well, and what entries of matrix and right side each adds to."""

    def __init__(self, backwards: bool = False) -> None:
        self.share, self.alone, self.backwards = 0, True, backwards
        self.adds: list[tuple[int, bool, np.ndarray]] = []

    def map(self, work: Any, k: int) -> None:
        """A team that works off one share after the other, the last one first if ``backwards``."""
        self.alone = False
        for i in reversed(range(k)) if self.backwards else range(k):
            self.share = i
            work(i)
        self.alone = True

    def note(self, *values: np.ndarray) -> None:
        touched = np.concatenate([np.asarray(v).ravel() != 0.0 for v in values])
        self.adds.append((self.share, self.alone, touched))

    def check(self) -> None:
        """What a share adds to while others are at work, none of them adds to then."""
        at_once = [(share, touched) for share, alone, touched in self.adds if not alone]
        for one, mine in at_once:
            for other, theirs in at_once:
                assert one == other or not (mine & theirs).any()


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("layers", [1, 3])
def test_no_two_threads_add_to_an_entry_at_once(case: str, layers: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Threads with a layer of elements each meet at all of them, those with three at some."""
    watch, upper, full, condense = Watch(), kernels.scatter_upper, kernels.scatter, Ties.scatter

    def noted(scatter: Any, *a: Any, data: int, Fd: int, K: tuple[int, ...]) -> None:
        trial = list(a)
        for k in K:
            trial[k] = np.ones_like(a[k])
        trial[data], trial[Fd] = np.zeros_like(a[data]), np.zeros_like(a[Fd])
        scatter(*trial)
        watch.note(trial[data], trial[Fd])
        scatter(*a)

    def condensed(self: Ties, eqs: Any, A: Any, K: Any, nodes: Any, columns: Any, step: Any, Fd: Any) -> None:
        trial, f = Matrix(A.indptr, A.indices, np.zeros_like(A.data), A.symmetric), np.zeros_like(Fd)
        condense(self, eqs, trial, np.ones_like(K), nodes, columns, step, f)
        watch.note(trial.data, np.zeros(eqs.n - len(eqs.given)))  # its right side has rows of its own
        condense(self, eqs, A, K, nodes, columns, step, Fd)

    monkeypatch.setattr(kernels, "scatter_upper", partial(noted, upper, data=12, Fd=14, K=(3, 4)))
    monkeypatch.setattr(kernels, "scatter", partial(noted, full, data=9, Fd=11, K=(2,)))
    monkeypatch.setattr(Ties, "scatter", condensed)
    monkeypatch.setattr(Team, "map", lambda _, work, k: watch.map(work, k))
    monkeypatch.setattr(schedule, "LEAST", 1)
    p = problem(**CASES[case])
    s = assembled(p, SIDE // layers, SIDE**2)[0]
    assert len({share for share, _, _ in watch.adds}) == s.schedule.n == SIDE // layers
    later = [touched for share, alone, touched in watch.adds if share and not alone]
    assert any(touched.any() for touched in later) == (layers == 3)
    watch.check()


@pytest.mark.parametrize("case", CASES)
def test_sums_have_the_same_bits_whichever_thread_is_first(case: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(schedule, "LEAST", 1)
    found = []
    for backwards in (False, True):
        watch = Watch(backwards)
        monkeypatch.setattr(Team, "map", staticmethod(watch.map))
        s, R, A, Fd = assembled(problem(**CASES[case]), 3, SIDE**2)
        assert s.schedule.n == 3
        found.append(R.tobytes() + A.data.tobytes() + Fd.tobytes())
    assert found[0] == found[1]


class Shares(Listener):
    n = 0

    def begin_analysis(self, run: Run) -> None:
        self.n = run.schedule.n


def test_threads_do_not_change_the_answer() -> None:
    states = []
    for threads in (1, 2):
        shares = Shares()
        result = run(problem(), [shares], Options(threads=threads))
        assert result.converged and shares.n == threads, result.reason
        states.append(result.state.d)
    np.testing.assert_allclose(states[0], states[1], atol=1e-10)


@pytest.mark.filterwarnings("error")
def test_all_threads_are_as_quiet_about_what_overflows_as_the_first() -> None:
    team, huge = Team(2), np.array([1e300])
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        assert all(np.isinf(q[0]) for q in team.map(lambda _: huge * huge, 2))
    team.close()
