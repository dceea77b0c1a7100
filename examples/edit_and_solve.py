"""Read a model, stiffen its solid, solve both, compare: what a study does many times.

``python examples/edit_and_solve.py`` prints the ratio of the equilibrium forces; :func:`main` returns it.
"""

from __future__ import annotations

from pathlib import Path

import febkit


def force(model: febkit.Model) -> float:
    """Force of the upper platen at the end (N; a quarter of the plug)."""
    result = model.solve()
    assert result.converged, result.reason
    top = model.nodes(z="max").index
    return float(result.state.reaction[top, 2].sum())


def main(model: febkit.Model, factor: float = 2.0) -> float:
    """Ratio of the forces of a model and of one whose Young's modulus is ``factor`` times larger."""
    stiff = model.copy()
    for material in stiff.materials.values():
        material.solid.E *= factor
    return force(stiff) / force(model)


if __name__ == "__main__":
    print("ratio of forces:", main(febkit.read(Path(__file__).with_name("unconfined_compression.feb"))))
