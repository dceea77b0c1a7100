"""Bonds seen from the states in which they were born."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from febkit.solver.kernels.fibers import squared_stretch
from febkit.solver.kernels.generations import (
    add_bonds,
    add_mooney_rivlin,
    add_neo_hookean,
    ages,
    born_along,
    fractions,
    grow,
    since_birth,
)
from febkit.solver.points import Points
from febkit.solver.solids import reactive_viscoelastic
from febkit.solver.solids.registry import load


def test_deformation_since_birth() -> None:
    """F U^-1 and J / Jb by numpy's inverse; the reference state for the first and for those not yet born."""
    rng = np.random.default_rng(4)
    n, capacity = 3, 5
    F = np.eye(3) + 0.2 * rng.normal(size=(n, 3, 3))
    U = np.eye(3) + 0.1 * rng.normal(size=(n, capacity, 3, 3))
    U = 0.5 * (U + np.swapaxes(U, -1, -2))
    gen = np.zeros((n, capacity, 8))
    gen[:, :, 1] = rng.uniform(0.8, 1.2, (n, capacity))
    gen[:, :, 2:] = U[:, :, [0, 1, 2, 0, 1, 0], [0, 1, 2, 1, 2, 2]]
    count, used = np.array([5.0, 3.0, 0.0]), np.array([0, 2, 3, 4])
    Fg, Jg, Jb = np.empty((n * 4, 3, 3)), np.empty(n * 4), np.empty((n, 4))
    J = np.linalg.det(F)
    since_birth(F, J, gen, count, used, 1, 2, Fg, Jg, Jb)
    for i in range(n):
        for k, g in enumerate(used):
            born = 0 < g < count[i]
            Ui, Ji = (U[i, g - 1], gen[i, g - 1, 1]) if born else (np.eye(3), 1.0)
            np.testing.assert_allclose(Fg[4 * i + k], F[i] @ np.linalg.inv(Ui), rtol=1e-12, atol=1e-14)
            assert np.isclose(Jg[4 * i + k], J[i] / Ji) and Jb[i, k] == Ji


def _measure(F: np.ndarray, trigger: int) -> float:
    if trigger == 0:
        return float(np.linalg.norm(0.5 * (F.T @ F - np.eye(3))))
    l = 0.5 * np.log(np.linalg.eigvalsh(F.T @ F))
    return float(np.linalg.norm(l - l.mean()) if trigger == 1 else abs(l.sum()))


def _stretch(F: np.ndarray) -> np.ndarray:
    w, V = np.linalg.eigh(F.T @ F)
    return (V * np.sqrt(w)) @ V.T


def _row(F: np.ndarray, U: np.ndarray, t: float, fraction: float) -> np.ndarray:
    return np.array([t, np.linalg.det(F), fraction, 1.0, _measure(U, 1), *U[[0, 1, 2, 0, 1, 0], [0, 1, 2, 1, 2, 2]]])


def _tensor(row: np.ndarray) -> np.ndarray:
    return row[5:][[[0, 3, 5], [3, 1, 4], [5, 4, 2]]]


@pytest.mark.parametrize("trigger", [0, 1, 2])
@pytest.mark.parametrize("wmin", [0.0, 0.2])
def test_generations_begin_and_merge_as_written(trigger: int, wmin: float) -> None:
    """A list for each point, beside the kernel: what has begun, its fraction, what the first two become."""
    rng, tau, dt, n, capacity = np.random.default_rng(6), 0.7, 0.25, 4, 12
    d = 0.1 * rng.normal(size=(n, 3, 3))
    still = np.arange(n) == 3  # does not move: nothing begins but the first
    old = np.zeros((n, 10 + 11 * capacity))
    lists: list[list[np.ndarray]] = [[] for _ in range(n)]
    for step in range(1, 10):
        t = step * dt
        F = np.eye(3) + np.where(still, 1.0, step)[:, None, None] * d
        J = np.linalg.det(F)
        gen = old[:, 10:].reshape(n, capacity, 11)[:, : int(old[:, 0].max())]
        w = np.ascontiguousarray(gen[:, :, 2] * np.exp(-(t - gen[:, :, 0]) / tau))
        new = old.copy()
        for again in (False, True):  # as a second iterate finds it
            grow(F, J, t, old, w, np.ones(n), still & False, np.array([[wmin, 1e-3]]), trigger, wmin > 0.0, again, new)
        for i, rows in enumerate(lists):
            weights = [r[2] * np.exp(-(t - r[0]) / tau) for r in rows]
            seen = F[i] @ np.linalg.inv(_tensor(rows[-1])) if rows else F[i]
            if _measure(seen, trigger) > 1e-3 and 1.0 - sum(weights[:-1]) >= wmin:
                rows.append(_row(F[i], _stretch(F[i]), t, 1.0 - sum(weights)))
                if len(rows) >= 3 and weights[0] < wmin:
                    mean = (weights[0] * rows[0] + weights[1] * rows[1]) / (weights[0] + weights[1])
                    U = _tensor(mean)
                    mean[1], mean[4] = np.linalg.det(U), _measure(U, 1)
                    rows[:2] = [mean]
            assert new[i, 0] == len(rows)
            np.testing.assert_allclose(new[i, 10 : 10 + 11 * len(rows)], np.ravel(rows), rtol=1e-9, atol=1e-12)
            np.testing.assert_array_equal(new[i, 1:10], F[i].ravel())
        old = new
    assert [len(rows) for rows in lists][3] == 1
    assert len(lists[0]) == 9 if wmin == 0.0 else 2 < len(lists[0]) < 9  # some merged


def test_sums_over_bonds() -> None:
    rng = np.random.default_rng(2)
    w, s, c = rng.normal(size=(3, 4)), rng.normal(size=(12, 6)), rng.normal(size=(12, 6, 6))
    S, C, none, no = np.ones((3, 6)), np.ones((3, 6, 6)), np.empty((0, 6)), np.empty((0, 6, 6))
    add_bonds(w, s, c, S, C)
    np.testing.assert_allclose(S, 1.0 + np.einsum("ng,ngi->ni", w, s.reshape(3, 4, 6)))
    np.testing.assert_allclose(C, 1.0 + np.einsum("ng,ngij->nij", w, c.reshape(3, 4, 6, 6)))
    before = S.copy()
    add_bonds(w, s, no, none, no)
    add_bonds(w, s, no, S, no)
    np.testing.assert_allclose(S - before, np.einsum("ng,ngi->ni", w, s.reshape(3, 4, 6)))


def _born(n: int, m: int) -> tuple[np.ndarray, ...]:
    """F and J of n points, m generations (n, m, 11), how many there are, what they weigh."""
    rng = np.random.default_rng(7)
    F, U = np.eye(3) + 0.2 * rng.normal(size=(n, 3, 3)), np.eye(3) + 0.1 * rng.normal(size=(n, m, 3, 3))
    J, U = np.linalg.det(F), 0.5 * (U + np.swapaxes(U, -1, -2))
    gen, count, w = np.zeros((n, m, 11)), np.array([4.0, 2.0, 0.0]), rng.uniform(0.1, 1.0, (n, m))
    gen[:, :, 1] = np.linalg.det(U)
    gen[:, :, 5:] = U[:, :, [0, 1, 2, 0, 1, 0], [0, 1, 2, 1, 2, 2]]
    return F, J, gen, count, w


@pytest.mark.parametrize(("add", "name", "given"), [
    (add_neo_hookean, "neo-Hookean", {"E": 2.0, "v": 0.3}),
    (add_mooney_rivlin, "Mooney-Rivlin", {"c1": 2.0, "c2": 0.3}),
    (add_mooney_rivlin, "Mooney-Rivlin", {"c1": 2.0, "c2": 0.0}),
])  # fmt: skip
def test_bonds_of_all_generations_are_those_of_the_law(add: Any, name: str, given: dict[str, float]) -> None:
    n, m = 3, 4
    F, J, gen, count, w = _born(n, m)
    law, intact = load("solid", name)(**given), np.array([1.0, 0.5, 0.2])
    Fg, Jg, Jb = np.empty((n * m, 3, 3)), np.empty(n * m), np.empty((n, m))
    since_birth(F, J, gen, count, np.arange(m), 1, 5, Fg, Jg, Jb)
    s, c = np.zeros((n * m, 6)), np.zeros((n * m, 6, 6))
    (law.dev if hasattr(law, "dev") else law.stress)(Points.at(Fg), s, c)
    want, got = ((np.zeros((n, 6)), np.zeros((n, 6, 6))) for _ in range(2))
    add_bonds(intact[:, None] * w / Jb, s, c, *want)
    par = np.array([list(given.values())])
    add(F, J, gen, count, w, par, intact, False, *got)
    for a, b in zip(got, want, strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-10, atol=1e-12)
    s, c = np.zeros((n, 6)), np.zeros((0, 6, 6))
    add(F, J, gen, count, w, par, intact, True, s, c)
    assert not s.any()


@pytest.mark.parametrize("iso", [False, True])
def test_fibers_of_bonds_pull_along_what_they_were_born_as(iso: bool) -> None:
    """In of F U^-1 along a, and the spatial direction, for all generations and those that there are not."""
    n, m = 3, 4
    F, J, gen, count, _ = _born(n, m)
    a, used = np.array([[0.6, 0.0, 0.8]]), np.arange(m)
    Fg, Jg, Jb = np.empty((n * m, 3, 3)), np.empty(n * m), np.empty((n, m))
    A, In = np.empty((n, m, 3)), np.empty((n, m))
    since_birth(F, J, gen, count, used, 1, 5, Fg, Jg, Jb)
    born_along(a, gen, count, used, iso, A)
    squared_stretch(F, J, A, iso, In)
    v = Fg @ a[0] * (Jg[:, None] ** (-1.0 / 3.0) if iso else 1.0)
    np.testing.assert_allclose(In.ravel(), (v**2).sum(1), rtol=1e-12)
    seen = np.einsum("nij,ngj->ngi", F, A) * (J[:, None, None] ** (-1.0 / 3.0) if iso else 1.0)
    np.testing.assert_allclose(seen.reshape(-1, 3), v, rtol=1e-10, atol=1e-12)


@pytest.mark.parametrize("bond", ["fiber-exp-pow", "Mooney-Rivlin"])
def test_sums_over_generations_are_those_of_bonds_one_by_one(bond: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """A solid whose strain changes at each of ten times, with and without what sums over its bonds."""
    own = {"fiber-exp-pow": {"ksi": 2.0, "beta": 2.5}, "Mooney-Rivlin": {"c1": 1.0, "c2": 0.5}}[bond]
    kind = "uncoupled reactive viscoelastic" if bond == "Mooney-Rivlin" else "reactive viscoelastic"
    relaxation = load("relaxation", "relaxation-exponential")(tau=0.4)

    def stresses() -> list[np.ndarray]:
        make = load("solid", bond)
        solid = load("solid", kind)(elastic=make(**own), bond=make(**own), relaxation=relaxation)
        solid.offset, old, out = 0, solid.initial(2), []
        for k in range(10):
            F = np.eye(3) + 0.03 * (k + 1) * np.array([[[1.0, 0.4, 0.0], [0.0, -0.5, 0.1], [0.2, 0.0, 0.7]]] * 2)
            F[1] = F[1].T
            new = old.copy()
            pts = Points.at(F, t=0.1 * (k + 1), dt=0.1, old=old, new=new)
            solid.room(pts)
            if solid.history > old.shape[1]:
                old = np.pad(old, ((0, 0), (0, solid.history - old.shape[1])))
                pts = Points.at(F, t=0.1 * (k + 1), dt=0.1, old=old, new=old.copy())
            s, c = np.zeros((2, 6)), np.zeros((2, 6, 6))
            (solid.dev if hasattr(solid, "dev") else solid.stress)(pts, s, c)
            out += [s, c]
            old = pts.new
        return out

    together = stresses()
    monkeypatch.setattr(reactive_viscoelastic, "_TOGETHER", {})
    monkeypatch.setattr(reactive_viscoelastic._Bonds, "_sum_fibers", lambda *a: False)
    for a, b in zip(together, stresses(), strict=True):
        assert b.any()
        np.testing.assert_allclose(a, b, rtol=1e-9, atol=1e-12)


def test_fractions_of_both_types() -> None:
    """f_g g(t - v_g), and g(t - v_g; K_g) - g(t - v_(g-1); K_g)."""
    rng = np.random.default_rng(8)
    gen, age = rng.uniform(0.5, 1.0, (2, 3, 11)), np.empty((2, 3))
    gen[:, :, 0] = [0.1, 0.4, 0.9]
    assert ages(gen, 0.5, age)
    np.testing.assert_allclose(age, [[0.4, 0.1, 0.0]] * 2)
    gen[1, 2, 0] = 0.3
    assert not ages(gen, 0.5, age)
    g, before, out = np.exp(-age), np.exp(-2.0 * age[:, :2]), np.empty((2, 3))
    all_, none = np.empty(0), np.empty((0, 0))
    fractions(gen, 0.5, g, none, all_, out)
    np.testing.assert_allclose(out, np.where(gen[:, :, 0] <= 0.5, gen[:, :, 2] * g, 0.0))
    fractions(gen, 0.5, g[:1].copy(), before, all_, out)
    np.testing.assert_allclose(out, g[0] - np.hstack([np.zeros((2, 1)), before]))
    fractions(gen, 0.5, g, none, np.array([2.0, 0.0]), out)
    np.testing.assert_allclose(out, [[*(gen[0, :2, 2] * g[0, :2] * gen[0, :2, 3]), 0.0], [1.0, 0.0, 0.0]])
