"""FEBio's own answers, where they are at hand: small models solved to their recorded final states."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import febkit

ORACLE = Path(__file__).parents[2].parent / "shared" / "oracle"
MODELS = ["study/tissue11_A", "study/tissue11_C"]


@pytest.mark.filterwarnings("ignore:.*belongs to no domain")  # the study's files name the cell's materials throughout
@pytest.mark.parametrize("name", MODELS)
def test_final_state_is_febios(name: str) -> None:
    """u and p at the end within 1e-5 of their largest values (float32 references, tight tolerances)."""
    folder, _, model = name.partition("/")
    source = ORACLE / folder / "models" / f"{model}.feb"
    if not source.is_file():
        pytest.skip("FEBio's recorded answers are not beside this checkout")
    reference = np.load(ORACLE / folder / "reference" / f"{model}.npz")
    result = febkit.solve(febkit.read(source))
    assert result.converged, result.reason
    assert result.state.time == pytest.approx(float(reference["times"][-1]))
    u, p = reference["u"][-1], reference["p"][-1]
    np.testing.assert_allclose(result.state.u, u, atol=1e-5 * np.abs(u).max())
    has = np.isfinite(p)
    assert result.state.p is not None
    np.testing.assert_allclose(result.state.p[has], p[has], atol=1e-5 * np.nanmax(np.abs(p)))
