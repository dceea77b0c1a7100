"""The matrix of hard scenes (tests/benchmarks/stability.py): each is solved and keeps its bound."""

from __future__ import annotations

import pytest

from benchmarks import stability


@pytest.mark.parametrize("name", stability.SCENES)
def test_scene(name: str) -> None:
    outcome = stability.SCENES[name]()
    assert outcome.result.converged, outcome.result.reason
    assert outcome.value <= outcome.bound


def test_guarded_steps_go_on_where_elements_turn_inside_out() -> None:
    """FEBio's loop would end in the first steps; guarded Newton steps solve them at their size."""
    outcome = stability.pushed(0.02)
    totals = outcome.result.totals
    assert totals.guarded > 0 and totals.steps == 10
    assert abs(outcome.result.state.u[:, :2]).max() < 1e-12  # confined: nothing moves sideways
