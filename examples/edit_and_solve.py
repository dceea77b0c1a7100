"""Read a model, stiffen its solid, solve both, compare: what a study does many times.

``python examples/edit_and_solve.py`` prints the ratio of the equilibrium forces; :func:`main` returns it.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np

import febkit


def force(path: Path) -> float:
    """Force of the upper platen at the end (N; a quarter of the plug)."""
    result = febkit.solve(febkit.read(path))
    assert result.converged, result.reason
    s = result.state
    return float(s.reaction[s.X[:, 2] > 0.999, 2].sum())


def main(text: str, folder: Path, factor: float = 2.0) -> float:
    """Ratio of the forces of a model and of one whose Young's modulus is ``factor`` times larger."""
    soft, stiff = folder / "soft.feb", folder / "stiff.feb"
    soft.write_text(text)
    stiff.write_text(text.replace("<E>0.6</E>", f"<E>{0.6 * factor}</E>"))
    return float(np.divide(force(stiff), force(soft)))


if __name__ == "__main__":
    model = Path(__file__).with_name("unconfined_compression.feb")
    with tempfile.TemporaryDirectory() as there:
        print("ratio of forces:", main(model.read_text(), Path(there)))
