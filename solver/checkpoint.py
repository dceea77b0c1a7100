"""A run between two time steps as plain data, and a run brought there again.

Plain are dicts, lists, numbers, words and arrays. What a step may change is what a failed try gives back
(:mod:`.step_state`); beside that a run has nodal values that its analysis step began with (conditions and surfaces are
set up at these), step sizes, and factorisations that later steps lean on, of which the matrices are kept.
"""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .problem import Problem
    from .run import Run

COUNTED = ("steps", "iterations", "residuals", "reforms", "retries", "lost", "guarded")  # of a run's totals


class Unfit(RuntimeError):
    """What a checkpoint holds is not of the problem."""


def refusal(p: Problem) -> str:
    """Why no checkpoints are taken; empty where they are."""
    return "checkpoints do not follow meshes that change" if any(s.adaptors for s in [p.common, *p.steps]) else ""


def taken(run: Run) -> dict[str, Any]:
    """The run between two time steps."""
    system, newton, integrator = run.system, run.newton, run.integrator
    assert system is not None and run.stepper is not None
    totals = asdict(run.totals)
    return {
        "blocks": _blocks(run), "index": run.index, "count": run.count, "saved": run.saved_at, "times": list(run.times),
        "totals": {k: totals[k] for k in COUNTED}, "solver": run.totals.linear_solver, "threads": run.team.n,
        "opened": run.opened, "state": run.state.snapshot(), "groups": [g.snapshot() for g in run.groups],
        "acting": [(type(a).__name__, a.snapshot()) for a in system.acting],
        "newton": newton.snapshot(), "inverse": newton.inverse.snapshot(lambda: system.matrix),
        "system": system.snapshot(), "stepper": run.stepper.snapshot(),
        "integrator": None if integrator is None else integrator.snapshot(),
    }  # fmt: skip


def _blocks(run: Run) -> list[list[str]]:
    """What each block is made of, in words."""
    return [
        [b.name, f"{len(b.conn)} {b.element}", b.physics.name, *(type(q).__name__ for q in b.solid.walk())]
        for b in run.problem.blocks
    ]


class Resumed:
    """What a run goes on from. ``exact``: the problem is that of the checkpoint; else loads, contacts and steps may be
    others."""

    def __init__(self, saved: dict[str, Any], exact: bool = True) -> None:
        self.saved, self.exact = saved, exact
        self.index, self.opened, self.time = saved["index"], saved["opened"], saved["state"]["time"]
        self.steps = saved["totals"]["steps"]

    def mismatch(self, run: Run) -> str:
        """Why a run cannot go on from there; empty where it has the blocks, nodes, fields and steps."""
        saved, steps = self.saved, run.problem.steps
        for old, new in zip(saved["blocks"], _blocks(run)):
            if old != new:
                return f"part {new[0]!r} is {', '.join(new[1:])}; in the checkpoint it is {', '.join(old[1:])}"
        if len(saved["blocks"]) != len(run.problem.blocks):
            return f"there are {len(run.problem.blocks)} parts, in the checkpoint {len(saved['blocks'])}"
        was, now = saved["state"]["d"].shape, run.state.d.shape
        if was != now:
            return f"there are {now[0]} nodes of {now[1]} unknowns, in the checkpoint {was[0]} of {was[1]}"
        if self.index >= len(steps):
            return f"the checkpoint is of analysis step {self.index + 1}, which the model does not have"
        if steps[self.index].explicit is not None and not self.exact:
            return "explicit analyses go on with an unchanged model alone"
        return ""

    def take_up(self, run: Run) -> str:
        """Bring a run there, whose analysis step is open; what is to be warned of. Raises Unfit."""
        saved = self.saved
        try:
            run.state.restore(saved["state"])
            for g, q in zip(run.groups, saved["groups"], strict=True):
                g.restore(q)
            _act(run, saved["acting"])
            self._step(run)
        except (ValueError, KeyError, IndexError, TypeError) as e:
            raise Unfit(f"the checkpoint does not fit the model: {e}") from e
        run.count, run.saved_at, run.times[:] = saved["count"], saved["saved"], saved["times"]
        for name, n in saved["totals"].items():
            setattr(run.totals, name, n)
        why = self._unlike(run)
        return f"the run goes on {why}: not bit for bit as it would have" if why else ""

    def _step(self, run: Run) -> None:
        """What solves time steps, and their sizes."""
        system, newton, saved = run.system, run.newton, self.saved
        assert system is not None and run.stepper is not None
        if not self.exact:
            newton.total = system.gather(run.state.d).copy()
            run.stepper.go_on(run.state.time, saved["stepper"])
            return
        newton.restore(saved["newton"])
        system.restore(saved["system"])
        newton.inverse.restore(saved["inverse"], lambda: system.matrix)
        run.stepper.restore(saved["stepper"])
        if run.integrator is not None:
            run.integrator.restore(saved["integrator"])

    def _unlike(self, run: Run) -> str:
        """Why it goes on to the same answer, but not to the same bits; empty where it does."""
        saved = self.saved
        if not self.exact:
            return ""
        if run.team.n != saved["threads"]:
            return f"by {run.team.n} threads instead of {saved['threads']}"
        if run.totals.linear_solver != saved["solver"]:
            return f"by {run.totals.linear_solver} instead of {saved['solver']}"
        return "with a new multigrid hierarchy" if "FGMRES" in saved["solver"] else ""


def _act(run: Run, saved: list[Any]) -> None:
    """Loads, contacts and connectors take up what they were; those that are new begin here."""
    assert run.system is not None
    left = list(saved)
    for a in run.system.acting:
        k = next((k for k, (name, _) in enumerate(left) if name == type(a).__name__), -1)
        if k < 0:
            a.begin(run.state, run.groups)
            continue
        a.restore(left.pop(k)[1])
