"""``febkit run --linear iterative``: solves, and says what to install where it cannot."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

import febkit
from febkit.cli.run import command
from febkit.model import InputError

EXAMPLE = Path(__file__).parents[2] / "examples" / "unconfined_compression.feb"


def _run(folder: Path, name: str, linear: str) -> Result:
    files = ["-o", str(folder / f"{name}.log"), "-p", str(folder / f"{name}.xplt")]
    return CliRunner().invoke(command, [str(EXAMPLE), "--linear", linear, *files])


def test_solves_as_the_direct_solver(tmp_path: Path) -> None:
    pytest.importorskip("pyamg")
    for name, linear in (("over", "iterative"), ("direct", "auto")):
        done = _run(tmp_path, name, linear)
        assert done.exit_code == 0, done.output
        assert ("FGMRES over" in done.output) == (name == "over")
    a, b = (febkit.open_results(tmp_path / f"{n}.xplt") for n in ("over", "direct"))
    np.testing.assert_allclose(a.time.values, b.time.values, rtol=1e-6)
    u, v = a.displacement.values, b.displacement.values
    assert np.linalg.norm(u - v) < 1e-3 * np.linalg.norm(v)


def test_missing_pyamg_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from febkit.solver.linear import amg

    monkeypatch.setattr(amg, "find_spec", lambda name: None)
    done = _run(tmp_path, "over", "iterative")
    assert isinstance(done.exception, InputError)  # exit code 2
    assert "pip install 'febkit[amg]'" in str(done.exception)
