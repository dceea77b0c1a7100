"""Conjugate gradients beside FEBio 4.11: iterates, where rounding does not part them, and equilibria."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import febkit
from febkit.lower import lower, unsupported
from febkit.model import InputError
from febkit.solver.run import Listener
from helpers.refined import MOONEY, PRESSURE, PULL, VISCOUS, WEIGHT, deck

SOLVER = re.compile(r"<solver.*?</solver>", re.DOTALL)


def bar(options: str = "<dtol>1e-7</dtol><etol>1e-6</etol>", **case: Any) -> str:
    """The bent bar without an adaptor."""
    text = deck("", **case).replace("<MeshAdaptor>\n</MeshAdaptor>\n", "")
    return SOLVER.sub(f'<solver type="CG-solid">{options}</solver>', text)


class Residuals(Listener):
    """Squared residual and length of the step of each iteration."""

    def __init__(self) -> None:
        self.rows: list[tuple[float, float]] = []

    def iteration(self, run: Any, it: Any) -> None:
        self.rows.append((it.norms["residual"].now, it.line))


STEEPEST = "<dtol>1e-4</dtol><etol>1e-3</etol><cgmethod>1</cgmethod>"
NARROW = "<dtol>1e-6</dtol><lstol>0.1</lstol><lsiter>6</lsiter>"
# case, iterations in all where rounding does not part them, and residuals and steps of the first, in FEBio
ITERATES: dict[str, tuple[dict[str, Any], int | None, list[tuple[float, float]]]] = {
    "Hager and Zhang": ({"loads": PRESSURE + WEIGHT}, None, [
        (0.01025468, 1.220765), (0.0115448, 1.220765), (0.001671292, 0.304192), (0.0007230793, 1.220765),
        (0.0002665913, 0.304192), (0.0003613316, 0.2706956), (0.0002020036, 0.304192), (0.0003750008, 0.2706956),
        (0.0002127075, 0.304192), (8.011174e-05, 0.2706956), (0.0001182622, 0.304192), (5.586354e-05, 0.2706956),
    ]),
    "steepest descent": ({"options": STEEPEST, "loads": PRESSURE}, 86, [
        (0.009443821, 1.234687), (0.002149845, 0.4367969), (0.005563833, 1.234687), (0.001214345, 0.4367969),
        (0.0007680896, 0.5479682), (0.0003889242, 0.4367969), (0.0002872304, 0.5479682), (0.0002168419, 0.4367969),
        (0.0001676054, 0.5479682), (0.000136636, 0.4367969), (0.000107128, 0.5479682), (3.837658e-05, 4.769964),
    ]),
    "a narrow search": ({"options": NARROW, "loads": PULL}, None, [
        (0.009704492, 1.338635), (0.002354654, 0.7095547), (0.001472371, 0.8674723), (0.0005434279, 0.8487959),
        (0.0001804543, 0.8674723), (0.0001671986, 1.061206), (0.0001080413, 0.8674723), (6.720056e-05, 0.9503429),
        (9.658517e-05, 1.569764), (5.496985e-05, 0.9503429), (3.465315e-05, 1.310244), (1.693463e-05, 0.8319338),
    ]),
}  # fmt: skip


@pytest.mark.parametrize("name", ITERATES)
def test_iterates(name: str, tmp_path: Path) -> None:
    case, count, first = ITERATES[name]
    (tmp_path / "m.feb").write_text(bar(**case))
    seen = Residuals()
    result = febkit.solve(tmp_path / "m.feb", listeners=[seen])
    assert result.converged, result.reason
    assert count is None or result.totals.iterations == count
    np.testing.assert_allclose(seen.rows[: len(first)], first, rtol=2e-6)


# case and displacements of node 45 (the last) and 23 at the end, in FEBio
ENDS: dict[str, tuple[dict[str, Any], list[list[float]]]] = {
    "two parts": ({"parts": 2, "loads": PRESSURE + WEIGHT},
                  [[-0.0776462, 0.0034929, 0.25], [0.00292874, -0.000534647, 0.0973208]]),
    "nearly incompressible": ({"material": MOONEY, "loads": PULL},
                              [[-0.0877677, 0.00355035, 0.25], [-0.000165313, 7.56568e-05, 0.0806076]]),
    "with a memory": ({"material": VISCOUS, "loads": PULL},
                      [[-0.0806571, 0.00503182, 0.25], [0.00211745, 0.000274665, 0.0831386]]),
}  # fmt: skip


@pytest.mark.parametrize("name", ENDS)
def test_equilibria(name: str, tmp_path: Path) -> None:
    """FEBio's, and those of Newton's method."""
    case, expected = ENDS[name]
    text = bar(**case)
    (tmp_path / "m.feb").write_text(text)
    result = febkit.solve(tmp_path / "m.feb")
    assert result.converged, result.reason
    np.testing.assert_allclose(result.state.u[[44, 22]], expected, atol=1e-4 * np.abs(expected).max())
    (tmp_path / "n.feb").write_text(SOLVER.sub('<solver type="solid"><dtol>1e-8</dtol></solver>', text))
    newton = febkit.solve(tmp_path / "n.feb")
    np.testing.assert_allclose(result.state.u, newton.state.u, atol=2e-4 * np.abs(newton.state.u).max())


@pytest.mark.parametrize(("options", "says"), [
    ("<preconditioner>1</preconditioner>", "<preconditioner>"), ("<max_refs>3</max_refs>", "<max_refs>"),
    ("<cgmethod>2</cgmethod>", "cgmethod"), ("<lsmin>-1</lsmin>", "<lsmin> must be a finite number of at least 0"),
])  # fmt: skip
def test_what_is_refused(tmp_path: Path, options: str, says: str) -> None:
    (tmp_path / "m.feb").write_text(bar(options))
    with pytest.raises(InputError, match=says):
        lower(febkit.read(tmp_path / "m.feb"))


def test_dynamics_bodies_and_shells_are_refused(tmp_path: Path) -> None:
    (tmp_path / "m.feb").write_text(bar(analysis="DYNAMIC"))
    with pytest.raises(InputError, match="for static analyses"):
        lower(febkit.read(tmp_path / "m.feb"))
    (tmp_path / "m.feb").write_text(bar().replace('type="neo-Hookean"', 'type="rigid body"'))
    found = [str(e) for e in unsupported(febkit.read(tmp_path / "m.feb"))]
    assert any('rigid bodies with <solver type="CG-solid">' in e for e in found), found


def test_a_step_that_no_search_finds_is_cut(tmp_path: Path) -> None:
    """Prescribed nodes that turn elements inside out at once: the step is tried again, smaller."""
    sized = "<time_stepper><max_retries>5</max_retries><dtmin>0.01</dtmin><dtmax>0.25</dtmax></time_stepper>"
    text = bar(steps=1, stepper=sized).replace("<dof>z</dof>", "<dof>x</dof>")
    text = text.replace('<value lc="1">0.5', '<value lc="1">-6.0')
    (tmp_path / "m.feb").write_text(text)
    result = febkit.solve(tmp_path / "m.feb")
    assert result.totals.retries >= 1
    assert result.converged, result.reason


def test_runs_that_go_on_and_derivatives(tmp_path: Path) -> None:
    """A checkpoint goes on to the same bits; derivatives are differences of whole runs."""
    (tmp_path / "m.feb").write_text(bar(steps=4))
    whole = febkit.solve(tmp_path / "m.feb", tmp_path / "m.xplt")

    class Stop(Listener):
        def begin_step(self, run: Any, number: int, time: float) -> None:
            if number == 3:
                raise KeyboardInterrupt

    path = tmp_path / "n.xplt"
    half = febkit.solve(tmp_path / "m.feb", path, checkpoint="1steps", listeners=[Stop()])
    assert half.interrupted
    again = febkit.solve(tmp_path / "m.feb", path, resume=True)
    np.testing.assert_array_equal(again.state.u, whole.state.u)
    s = febkit.read(tmp_path / "m.feb").solve(sensitivity=["m1.E"], variables=["stress"]).sensitivity
    assert s["method"].values.tolist() == ["differences"] and "no tangent" in s.attrs["why"]["m1.E"]
