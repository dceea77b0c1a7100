"""Every solid of the table against the laws of mechanics."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import numpy as np
import pytest

from febkit.solver.points import Points
from febkit.solver.solids import history
from febkit.solver.solids.registry import tables
from helpers import examples, laws

SOLIDS = sorted({**tables()["solid"], "generation": ""})
Q = laws.rotation(5)[None]


def at(F, old=None, t=0.6, dt=0.3, new=None):
    return Points.at(F, Q=Q, t=t, dt=dt, old=old, new=new)


def prepare(name):
    """A solid, deformations, and a function that makes points of them after one converged step."""
    solid = examples.example(name)
    F = laws.deformations(6, 0.18)
    first = at(np.eye(3) + 0.5 * (F - np.eye(3)), t=0.3)
    first.old = history.begin(solid, first)
    first.new = np.zeros_like(first.old)
    laws.stress_of(solid, first)
    ready = at(F)
    ready.old = first.new
    old = history.begin(solid, ready)
    return solid, F, lambda F: at(F, old=old[: len(F)], new=np.zeros_like(old[: len(F)]))


@pytest.mark.parametrize("name", SOLIDS)
def test_stress_is_derivative_of_energy(name):
    if name in examples.NO_ENERGY_LAW:
        pytest.skip(examples.NO_ENERGY_LAW[name])
    solid, F, make = prepare(name)
    laws.check_stress_is_derivative_of_energy(solid, make, F)


@pytest.mark.parametrize("name", SOLIDS)
def test_tangent_is_derivative_of_stress(name):
    solid, F, make = prepare(name)
    if name in examples.NO_TANGENT_LAW:
        pytest.skip(examples.NO_TANGENT_LAW[name])
    laws.check_tangent_is_derivative_of_stress(solid, make, F, rtol=3e-6)


@pytest.mark.parametrize("name", examples.NO_TANGENT_LAW)
def test_a_tangent_that_is_not_the_derivative_of_the_stress_is_said(name):
    """Derivatives by parameters are had of states' tangents where all of a solid's are consistent."""
    assert not all(m.consistent for m in examples.example(name).walk())


@pytest.mark.parametrize("name", [n for n in SOLIDS if any(m.history for m in examples.example(n).walk())])
def test_energy_leaves_the_state_alone(name):
    solid, F, make = prepare(name)
    pts = make(F)
    laws.stress_of(solid, pts)
    before = pts.new.copy()
    pts.F = 1.05 * F
    pts.J = np.linalg.det(pts.F)
    try:
        solid.energy(pts)
    except NotImplementedError:
        pytest.skip("it has no energy")
    np.testing.assert_array_equal(pts.new, before)


@pytest.mark.parametrize("name", SOLIDS)
def test_frame_indifference(name):
    if name in examples.NOT_OBJECTIVE:
        pytest.skip(examples.NOT_OBJECTIVE[name])
    solid, F, make = prepare(name)
    laws.check_frame_indifference(solid, make, F)


@pytest.mark.parametrize("name", SOLIDS)
def test_rest_is_free_of_stress(name):
    if name in examples.STRESSED_AT_REST:
        pytest.skip("stressed in the reference configuration")
    solid = examples.example(name)
    pts = at(np.eye(3)[None].copy())
    pts.old = history.begin(solid, pts)
    pts.new = np.zeros_like(pts.old)
    np.testing.assert_allclose(laws.stress_of(solid, pts), 0.0, atol=1e-10)


@pytest.mark.parametrize("name", SOLIDS)
def test_stress_and_tangent_are_added(name):
    solid, F, make = prepare(name)
    laws.check_tangent_adds(solid, make, F)


@pytest.mark.parametrize("name", SOLIDS)
def test_parameters_differ_from_point_to_point(name):
    """One point alone gives what it gives among others."""
    solid, F, make = prepare(name)
    whole = laws.stress_of(solid, make(F))
    one = laws.stress_of(examples.example(name), at(F[:1])) if not solid.history else None
    if one is None or any(m.history for m in solid.walk()):
        pytest.skip("depends on history")
    np.testing.assert_allclose(whole[:1], one, rtol=1e-12, atol=1e-13)


def test_every_solid_has_an_example():
    missing = set(SOLIDS) - set(examples.SIMPLE) - set(examples.COMPOSITE)
    assert not missing


def test_each_file_registers_what_the_table_says():
    folder = Path(sys.modules[Points.__module__].__file__).parent / "solids"
    text = "".join(p.read_text() for p in folder.glob("*.py"))
    for table, types in tables().items():
        for febio, where in types.items():
            cls = where.split(":")[1]
            assert re.search(rf'register\({cls}, "{re.escape(febio)}"', text), (table, febio)
