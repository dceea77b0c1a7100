"""Linear systems solved over multigrid without a factorisation: the direct solver's answer, in bounded iterations."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from febkit.solver.linear import amg, pardiso
from febkit.solver.linear.base import LinearError, Matrix, Stalled
from febkit.solver.linear.choose import choose
from febkit.solver.linear.iterative import Iterative
from febkit.solver.linear.krylov import fgmres, matvec
from febkit.solver.linear.superlu import SuperLU
from febkit.solver.options import Options
from febkit.solver.permeabilities.const_iso import ConstIso
from febkit.solver.permeabilities.holmes_mow import HolmesMow
from febkit.solver.physics import default
from febkit.solver.physics.biphasic import Biphasic
from febkit.solver.problem import STATIC, TRANSIENT, Block, Fixed, NewtonOptions, Prescribed, Problem, Step
from febkit.solver.run import Run, run
from febkit.solver.solids.neo_hookean import NeoHookean
from febkit.solver.storage import storage, unknowns
from febkit.solver.system import System
from febkit.solver.values import Constant
from helpers import scenes
from helpers.scenes import UX, UY, UZ, P

EXACT = 1e-6  # of single solves; runs are solved to less

pytest.importorskip("pyamg", reason="pip install 'febkit[amg]'")


def cube(n: int, contrast: float = 1.0, fluid: bool = True, permeability: Any = None, E: float = 1.0) -> Problem:
    """A unit cube held at the bottom, pressed and drained on top; its core ``contrast`` times as stiff.

    Aggregate modulus 1.1 E, permeability 1 / E: the diffusion time is about one.
    """
    X, conn = scenes.grid((n, n, n))
    inner = (np.abs(X[conn].mean(axis=1) - 0.5) < 0.25).all(axis=1)
    ids = np.arange(1, len(conn) + 1)

    def part(name: str, of: Any, stiffness: float) -> Block:
        mixture = Biphasic(permeability or ConstIso(1.0 / E)) if fluid else default()
        return Block(name, "hex8", conn[of], ids[of], NeoHookean(E=stiffness, v=0.2), mixture)

    top, bottom = np.flatnonzero(X[:, 2] > 1 - 1e-9), np.flatnonzero(X[:, 2] < 1e-9)
    conditions: list[Any] = [Fixed(k, bottom) for k in (UX, UY, UZ)]
    conditions += [Prescribed(UZ, top, Constant(-0.02))] + ([Fixed(P, top)] if fluid else [])
    newton = NewtonOptions(dtol=1e-5, etol=1e-10, ptol=1e-5)
    step = Step(analysis=TRANSIENT if fluid else STATIC, dt=0.05, count=2, newton=newton, conditions=conditions)
    return Problem(X, [part("rest", ~inner, E), part("core", inner, E * contrast)], [step])


def system(problem: Problem, dt: float) -> tuple[System, Matrix, Any]:
    """The equations at the first iteration of a step: their tangent and right side."""
    r = Run(problem, (), Options(threads=1))
    r._set_up()
    s = System(problem, problem.steps[0], r.groups, r.state, r.schedule)
    s.state.dt = dt
    s.update()
    step = np.zeros(s.eqs.n)
    step[s.eqs.given] = s.gather(np.nan_to_num(s.targets(dt)))[s.eqs.given]
    A, Fd = s.tangent(step)
    return s, A, (s.residual() + Fd)[s.eqs.rows]


def _compare(problem: Problem, dt: float, most: int) -> int:
    """Solve both ways; the iterations taken."""
    s, A, b = system(problem, dt)
    solver, direct = Iterative(unknowns(s), EXACT), SuperLU()
    solver.factor(A)
    direct.factor(A)
    x, y = solver.solve(b), direct.solve(b)
    d = solver._scale
    assert np.linalg.norm(d * (b - matvec(A, x))) < 1e-6 * np.linalg.norm(d * b)
    for some in (solver._u, solver._p):
        assert np.linalg.norm((x - y)[some]) <= 1e-4 * np.linalg.norm(y[some])
    used = int(solver.stats["iterations"])
    assert 0 < used <= most
    return used


@pytest.mark.parametrize("contrast", [1.0, 1e3])
@pytest.mark.parametrize("dt", [1e-4, 1e-2, 1.0, 10.0])
def test_as_the_direct_solver(dt: float, contrast: float) -> None:
    _compare(cube(8, contrast), dt, 40 if dt < 1e-3 else 20)


def test_units_do_not_matter() -> None:
    """Pascals and metre^4 per newton second beside units of one: the same iterations, within rounding."""
    plain, scaled = _compare(cube(6), 1e-2, 20), _compare(cube(6, E=1e6), 1e-2, 20)
    assert abs(plain - scaled) <= 1


@pytest.mark.parametrize("contrast", [1.0, 1e3])
def test_solids_alone(contrast: float) -> None:
    _compare(cube(8, contrast, fluid=False), 1.0, 20)


def test_an_unsymmetric_tangent() -> None:
    law = HolmesMow(perm=1.0, M=2.0, alpha=2.0)
    problem = cube(6, permeability=law)
    _, A, _ = system(problem, 1e-2)
    assert not A.symmetric
    _compare(problem, 1e-2, 20)


@pytest.mark.parametrize("dt", [1e-4, 1e-2, 1.0])
def test_iterations_stay_as_the_mesh_is_refined(dt: float) -> None:
    taken = []
    for n in (4, 8, 12):
        s, A, b = system(cube(n), dt)
        solver = Iterative(unknowns(s), EXACT)
        solver.factor(A)
        solver.solve(b)
        taken.append(solver.stats["iterations"])
    assert max(taken) <= max(1.5 * taken[0], taken[0] + 6)


def test_storage_of_the_pores() -> None:
    """Over all pressures the storage is the volume over the aggregate modulus."""
    s, _, _ = system(cube(4), 1.0)
    nodes = np.arange(len(s.state.X))
    H = (1 - 0.2) / ((1 + 0.2) * (1 - 2 * 0.2))
    np.testing.assert_allclose(storage(s, nodes).sum(), 1.0 / H, rtol=1e-12)


def test_points_without_stiffness_store_no_more() -> None:
    """A neo-Hookean element at 2.4 times its volume has no uniaxial modulus left: iterations stay as they were."""
    taken = []
    for growth in (0.0, 0.34):
        problem = cube(9, 1e-3)
        problem.blocks[1].solid = NeoHookean(E=1e-3, v=0.4)
        r = Run(problem, (), Options(threads=1))
        r._set_up()
        s = System(problem, problem.steps[0], r.groups, r.state, r.schedule)
        s.state.dt = 1e-2
        middle = (np.abs(problem.X - 0.5) < 0.06).all(axis=1)
        assert middle.sum() == 8
        s.state.d[middle, :3] = growth * (problem.X[middle] - 0.5)
        s.update()
        core = next(g for g in s.groups if g.block.name == "core")
        assert (core.J.max() > 2.2) == (growth > 0)
        A, _ = s.tangent(np.zeros(s.eqs.n))
        solver = Iterative(unknowns(s), EXACT)
        solver.factor(A)
        solver.solve(np.random.default_rng(3).standard_normal(A.n))
        taken.append(solver.stats["iterations"])
    assert taken[1] <= 1.25 * taken[0], taken


@pytest.mark.parametrize("fluid", [True, False])
def test_a_run_gives_the_same_answer(fluid: bool) -> None:
    direct = run(cube(6, 10.0, fluid), options=Options(threads=1, factor="fresh"))
    over = run(cube(6, 10.0, fluid), options=Options(threads=1, linear="iterative", factor="reuse"))
    assert direct.converged and over.converged and over.totals.linear_solver.startswith("FGMRES")
    assert over.totals.iterations <= direct.totals.iterations + 2
    d, e = direct.state.d, over.state.d
    for k in (slice(0, 3), slice(3, None)):
        assert np.linalg.norm((e - d)[:, k]) <= 1e-4 * np.linalg.norm(d[:, k])


def test_rigid_modes_carry_no_energy() -> None:
    problem = cube(3, fluid=False)
    problem.steps[0].conditions = []
    _, A, _ = system(problem, 1.0)
    B = amg.rigid_modes(problem.X, np.ones(problem.X.shape, bool))
    assert np.linalg.matrix_rank(B) == 6
    for mode in B.T:
        assert np.abs(matvec(A, mode)).max() < 1e-12 * np.abs(A.data).max()


def test_flexible_gmres_restarts() -> None:
    rng = np.random.default_rng(5)
    M = np.eye(50) * 4 + rng.normal(size=(50, 50)) * 0.3
    b, calls = rng.normal(size=50), []

    def precondition(r: Any) -> Any:  # another one at each call
        calls.append(1)
        return r / (3.0 + len(calls) % 3)

    x, error, used = fgmres(lambda v: M @ v, b, precondition, 1e-8, 8, 300)
    assert error <= 1e-8 and 8 < used == len(calls) < 300
    np.testing.assert_allclose(M @ x, b, atol=1e-7 * np.linalg.norm(b))


def test_nothing_to_solve() -> None:
    x, error, used = fgmres(lambda v: v, np.zeros(3), lambda r: r, 1e-6, 5, 10)
    assert not x.any() and error == 0.0 and used == 0


def test_a_stall_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    from febkit.solver.linear import iterative

    s, A, b = system(cube(6), 1e-4)
    monkeypatch.setattr(iterative, "MOST", 2)
    solver = Iterative(unknowns(s), EXACT)
    solver.factor(A)
    with pytest.raises(Stalled, match=r"stalled: relative residual .* after 2 iterations"):
        solver.solve(b)


def test_without_pyamg(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(amg, "find_spec", lambda name: None)
    s, _, _ = system(cube(2), 1.0)
    with pytest.raises(LinearError, match=r"pip install 'febkit\[amg\]'"):
        choose("iterative", 10, 1, unknowns=unknowns(s))


def test_out_of_memory_says_what_to_try() -> None:
    assert "--linear iterative" in pardiso._ERRORS[-2]


def test_auto_does_without_a_factorisation_that_does_not_fit() -> None:
    """PARDISO's analysis says what a factor takes; with less at hand the answer is the same, found without one."""
    if pardiso.library() is None:
        pytest.skip("MKL is not installed")
    whole = run(cube(6), (), Options(threads=1))
    need = pardiso.Pardiso(1).memory(system(cube(6), 0.05)[1])
    assert 1e5 < need < 1e8
    roomy = run(cube(6), (), Options(threads=1, memory=1.2 * need / 1e9))
    tight = run(cube(6), (), Options(threads=1, memory=0.8 * need / 1e9))
    assert (roomy.totals.linear_solver, tight.totals.linear_solver) == ("MKL PARDISO", "FGMRES over multigrid (pyamg)")
    np.testing.assert_allclose(tight.state.d, whole.state.d, atol=1e-6)


def test_what_does_not_fit_and_cannot_be_done_without_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    if pardiso.library() is None:
        pytest.skip("MKL is not installed")
    monkeypatch.setattr(amg, "available", lambda: False)
    r = run(cube(4), (), Options(threads=1, memory=1e-6))
    assert not r.converged and "GB of memory" in r.reason and "pip install 'febkit[amg]'" in r.reason


def test_the_elastic_hierarchy_is_kept() -> None:
    """Two tangents of neighbouring states need one set-up, and as many iterations."""
    problem = cube(6)
    s, A, b = system(problem, 0.05)
    solver = Iterative(unknowns(s), EXACT)
    solver.factor(A)
    x = solver.solve(b)
    first = solver.stats["iterations"]
    later = Matrix(A.indptr, A.indices, A.data * 1.05, A.symmetric)
    solver.factor(later)
    assert np.linalg.norm(solver.solve(1.05 * b) - x) < 1e-5 * np.linalg.norm(x)
    assert solver.stats["set_ups"] == 1
    assert solver.stats["iterations"] - first <= first + 3
