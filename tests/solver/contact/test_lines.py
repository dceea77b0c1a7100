"""Lines tied to lines and sliding along them: forces, tangents, what is left alone, augmentation."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from febkit.solver.contact.lines import SlideLine, TiedLine
from febkit.solver.problem import Fixed, Progress
from helpers import pair as scene


def edges(p: scene.Pair) -> tuple[Any, Any]:
    """Lines along x at y = min of the upper block's lower face, and of the lower block's upper face."""
    out = []
    for faces in (p.upper, p.lower):
        nodes = np.unique(faces)
        nodes = nodes[np.abs(p.X[nodes, 1] - p.X[nodes, 1].min()) < 1e-9]
        nodes = nodes[np.argsort(p.X[nodes, 0])]
        out.append(np.column_stack([nodes[:-1], nodes[1:]]))
    return out[0], out[1]


def shifted(p: scene.Pair, by: Any) -> Any:
    d = np.zeros_like(p.X)
    d[np.unique(p.top)] = by
    return d


def test_a_tied_line_holds_what_it_started_with() -> None:
    p = scene.Pair(gap=0.1, inset=0.05)
    tie = TiedLine(*edges(p), penalty=3.0)
    state = scene.started(p, tie)
    R = scene.forces(tie, state, shifted(p, [0.02, 0.03, -0.04]))
    length = np.array([0.15, 0.3, 0.3, 0.15])
    gap = np.array([0.02, 0.05 + 0.03, 0.1 - 0.04])  # the distance at the start counts
    assert R[tie.nodes] == pytest.approx(-3.0 * length[:, None] * gap)
    assert np.abs(R.sum(axis=0)).max() < 1e-12
    moment = np.cross(p.X[tie.nodes], R[tie.nodes]).sum(axis=0)
    below = np.unique(edges(p)[1])
    assert R[below][:, 0].sum() == pytest.approx(3.0 * 0.9 * 0.02)
    turn = np.cross(p.X[below], R[below]).sum(axis=0)[2]
    assert turn == pytest.approx(-moment[2] + 3.0 * 0.9 * 0.05 * 0.02)  # partners lie 0.05 beside the nodes


@pytest.mark.parametrize("kind", [TiedLine, SlideLine])
def test_tangent_is_the_derivative(kind: Any) -> None:
    """FEBio's tangent of a slide line takes the other line and the places on it as fixed."""
    p = scene.Pair(gap=0.1, inset=0.05)
    line = kind(*edges(p), penalty=3.0)
    state = scene.started(p, line)
    d = np.random.default_rng(3).uniform(-0.03, 0.03, p.X.shape)
    d[np.unique(p.lower)] = 0.0
    R = scene.forces(line, state, d)
    assert np.abs(R).max() > 1e-3
    K, D = scene.stiffness(line, state), scene.difference(line, state, d)
    free = np.ones_like(p.X, bool)
    if kind is SlideLine:
        free[np.unique(p.lower)] = False
    free = free.ravel()
    assert np.abs((K - D)[np.ix_(free, free)]).max() < 1e-7 * np.abs(K[np.ix_(free, free)]).max()
    assert np.allclose(K, K.T, atol=1e-12)


def test_nodes_slide_along_a_line_and_not_off_it() -> None:
    p = scene.Pair(gap=0.1, inset=0.05)
    line = SlideLine(*edges(p), penalty=3.0)
    state = scene.started(p, line)
    R = scene.forces(line, state, shifted(p, [0.3, 0.0, 0.0]))
    inside = line.nodes[:3]  # the last one has passed the line's end
    assert np.abs(R[inside, 0]).max() < 1e-12
    assert R[line.nodes[3], 0] == pytest.approx(-3.0 * 0.15 * (0.95 + 0.3 - 1.0))
    assert R[inside, 2] == pytest.approx(-3.0 * 0.1 * np.array([0.15, 0.3, 0.3]))
    assert R[inside, 1] == pytest.approx(-3.0 * 0.05 * np.array([0.15, 0.3, 0.3]))


def test_after_the_updates_allowed_nodes_keep_their_lines() -> None:
    p = scene.Pair(gap=0.1, inset=0.05)
    line = SlideLine(*edges(p), seg_up=2)
    state = scene.started(p, line)
    before = line.partner.copy()
    assert before.tolist() == [0, 0, 1, 1]
    d = shifted(p, [0.3, 0.0, 0.0])
    state.d[:] = d
    line.update(state, Progress(3))
    assert line.partner.tolist() == before.tolist()
    line.update(state, Progress(2))
    assert line.partner.tolist() == [0, 1, 1, 1]


def test_what_is_far_or_beside_is_not_tied() -> None:
    p = scene.Pair(gap=0.1, inset=0.05)
    first, second = edges(p)
    for most, count in ((0.0, 4), (0.1, 0), (0.12, 4)):
        tie = TiedLine(first, second, max_distance=most)
        scene.started(p, tie)
        assert (tie.partner >= 0).sum() == count
    tie = TiedLine(first, second[1:])  # from x = 0.5 on
    scene.started(p, tie)
    assert tie.partner.tolist() == [-1, -1, 0, 0]


def test_augmentation_closes_the_gap() -> None:
    p = scene.Pair()
    gaps = []
    for laugon in (False, True):
        line = TiedLine(*edges(p), penalty=20.0, laugon=laugon, tolerance=1e-6, maxaug=60)
        problem = p.problem(line, 1e-2)
        problem.steps[0].conditions += [Fixed(k, np.unique(p.top)) for k in (0, 1)]
        scene.solve(problem)
        gaps.append(np.abs(line.gap).max())
    assert gaps[0] > 1e-4
    assert gaps[1] < 1e-2 * gaps[0]


def test_multipliers_of_a_slide_line() -> None:
    """L += eps g while |L| changes by more than the tolerance."""
    p = scene.Pair(gap=0.1, inset=0.05)
    line = SlideLine(*edges(p), penalty=3.0, laugon=True, tolerance=0.4, minaug=1, maxaug=5)
    state = scene.started(p, line)
    R = scene.forces(line, state, np.zeros_like(p.X))
    for done, (ended, times) in enumerate([(False, 2), (False, 3), (True, 3)]):
        assert line.augment(done, state) == ended
        assert scene.forces(line, state, np.zeros_like(p.X)) == pytest.approx(times * R)
    saved = line.snapshot()
    line.augment(0, state)
    line.restore(saved)
    assert scene.forces(line, state, np.zeros_like(p.X)) == pytest.approx(3 * R)
