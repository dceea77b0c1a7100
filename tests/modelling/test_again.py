"""A second solve of an edited model: bit for bit that of a model solved for the first time, without its first work."""

from __future__ import annotations

import copy
import gc
import pickle
import weakref
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

import febkit
from febkit import materials as mt
from febkit.model import Component
from febkit.modelling.solution import Solution
from febkit.solver.graph import Graph, Graphs
from febkit.solver.linear import pardiso


def plug() -> febkit.Model:
    """Biphasic, with a solid that remembers: more equations than the dense solver takes."""
    m = febkit.Model("biphasic")
    m.add_block("plug", (1, 1, 1), (4, 4, 4))
    m.materials["cartilage"] = mt.Biphasic(
        solid=mt.Viscoelastic(elastic=mt.NeoHookean(E=0.6, v=0.1), g1=0.5, t1=2.0),
        permeability=mt.PermConstIso(perm=2e-3), phi0=0.2)  # fmt: skip
    for axis in "xyz":
        m.fix(m.nodes(**{axis: 0}), axis)
    m.fix(m.nodes(x="max"), "p")
    m.node_sets["top"] = m.nodes(z="max")
    m.prescribe("top", z=-0.1, curve=[(0, 0), (1, 1)])
    m.output.plot = ["displacement", "reaction forces", "effective fluid pressure"]
    m.step(time=2, dt=1)
    return m


def cube(n: int = 4) -> febkit.Model:
    m = febkit.Model("solid")
    m.add_block("b", (1, 1, 1), (n, n, n))
    m.materials["s"] = mt.NeoHookean(E=1.0, v=0.3)
    m.fix(m.nodes(z=0), "x", "y", "z")
    m.prescribe(m.nodes(z="max"), z=-0.1, curve=[(0, 0), (1, 1)])
    m.output.plot = ["displacement"]
    m.step(time=1, dt=1)
    return m


def same(a: Solution, b: Solution) -> None:
    assert a.converged and a.totals.iterations == b.totals.iterations
    assert np.array_equal(a.state.d, b.state.d) and np.array_equal(a.state.reaction, b.state.reaction)
    assert a.dataset.identical(b.dataset)


def moved(m: febkit.Model) -> None:
    X = m.X.copy()
    X[X[:, 2] == 1.0, 2] += 0.05
    m._put(mesh=replace(m.mesh, X=X))


EDITS: dict[str, Callable[[febkit.Model], object]] = {
    "E": lambda m: setattr(m.materials["cartilage"].solid.elastic, "E", 0.9),
    "v": lambda m: setattr(m.materials["cartilage"].solid.elastic, "v", 0.2),
    "k": lambda m: setattr(m.materials["cartilage"].permeability, "perm", 1e-3),
    "curve": lambda m: m.curves.__setitem__(1, [(0, 0), (2, 1)]),
    "nodes": moved,
    "fix": lambda m: m.fix(m.nodes(y="max"), "p"),
    "step": lambda m: m.step(time=1, dt=0.5),
    "part": lambda m: m.add_block("more", (1, 1, 1), (1, 1, 1), (0, 0, 1)),
}
NEW_ROWS = {"fix", "part"}  # edits after which other unknowns are free


def test_every_edit_gives_what_a_first_solve_gives(monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[str] = []
    for kind, name in ((Graph, "__init__"), (pardiso.Analysis, "__init__")):
        own = getattr(kind, name)
        monkeypatch.setattr(kind, name, lambda *a, own=own, k=kind: made.append(k.__name__) or own(*a))
    m = plug()
    m.solve(threads=1)
    for what, edit in EDITS.items():
        edit(m)
        if what == "part":
            m.fix(m.nodes(part="more"), "x", "y", "z", "p")
        made.clear()
        again = m.solve(threads=1)
        if what not in NEW_ROWS:
            assert made == [], what
        same(again, febkit.Model.of(m.record).solve(threads=1))
    made.clear()
    same(m.copy().solve(threads=1), again)  # copies share it
    assert made == []


def test_two_solves_at_once() -> None:
    models = [cube() for _ in range(2)] + [shared := cube(), shared.copy()]
    for m, E in zip(models, (1.0, 2.0, 1.0, 2.0)):
        m.materials["s"].E = E
    alone = [m.solve(threads=1) for m in models[:2]]
    with ThreadPoolExecutor(2) as pool:
        both = list(pool.map(lambda m: m.solve(threads=1), models[2:]))
    for a, b in zip(alone, both):
        same(a, b)


def resident() -> int:
    psutil = pytest.importorskip("psutil")
    return int(psutil.Process().memory_info().rss)


def test_nothing_is_lost_over_many_solves_and_all_is_freed_with_the_model() -> None:
    m = cube(5)
    before = 0
    for k in range(60):
        m.materials["s"].E = 1.0 + 0.01 * k
        m.solve(threads=1)
        if k == 9:
            gc.collect()
            before = resident()
    gc.collect()
    assert resident() - before < 4e6  # a factor and its analysis take 1.6 MB each time
    graphs = m._again.graphs
    held = [weakref.ref(q) for q in (graphs, *graphs._held.values())]
    del m, graphs
    gc.collect()
    assert [h() for h in held] == [None, None]


def test_a_model_travels_without_it() -> None:
    m = cube(1)
    m.solve()
    for there in (pickle.loads(pickle.dumps(m)), copy.deepcopy(m)):
        assert there == m and there._again._graphs is None


def test_graphs_that_are_kept_are_few() -> None:
    def chain(n: int, symmetric: bool = True) -> Graph:
        return graphs([np.arange(n, dtype=np.int32)[None]], np.full(n, 3, np.int32), symmetric)

    graphs = Graphs()
    first = [chain(n) for n in range(2, 25)][-1]
    assert len(graphs._held) == 8
    assert first is chain(24) and first is not chain(24, symmetric=False)


def test_a_tolerance_asks_for_more_than_the_file() -> None:
    m = febkit.Model("solid")
    m.add_block("block", (1, 1, 1), (2, 2, 2))
    m.materials["m"] = febkit.materials.NeoHookean(E=1, v=0.3)
    m.fix(m.nodes(z="min"), "x", "y", "z")
    m.node_sets["top"] = m.nodes(z="max")
    m.prescribe("top", z=0.3, x=0.2)
    m.step(time=1, dt=0.5)
    loose, same, tight, best = (m.solve(tolerance=t) for t in (0.0, 0.05, 1e-5, 1e-10))
    assert np.array_equal(loose.state.u, same.state.u), "the file's own is smaller"
    off = [float(np.abs(r.state.u - best.state.u).max()) for r in (loose, tight)]
    assert off[1] < 1e-13 < 1e-12 < off[0]
    assert loose.totals.iterations < tight.totals.iterations < best.totals.iterations
    m.control.solver.qn_method = Component("qn_method", "full Newton")
    full, quasi = m.solve(tolerance=1e-10), m.solve(tolerance=1e-10, quasi=True)
    assert full.totals.reforms == full.totals.iterations > quasi.totals.reforms
    assert np.abs(full.state.u - quasi.state.u).max() < 1e-13
