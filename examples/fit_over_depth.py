"""A published fit repeated: moduli of cartilage over depth, of strains measured layer by layer in confined compression.

``python examples/fit_over_depth.py`` prints E and beta (Holmes and Mow's solid of a biphasic tissue, at rest under four
stresses) beside the published ones; :func:`fitted` returns those of one layer. Strains, stresses, Poisson's ratios and
the published E and beta are those of S. Sibole's bioMultiScale (github.com/siboles/bioMultiScale: material_test.yaml,
tissue_5percent.yaml), which fits the solid's stress in closed form.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

import febkit
from febkit import materials

STRESS = (-0.024, -0.069, -0.112, -0.168)  # MPa


class Layer(NamedTuple):
    """Height over the bone (1: the surface), strains at rest under STRESS, Poisson's ratio, published E (MPa), beta."""

    height: float
    strain: tuple[float, float, float, float]
    v: float
    E: float
    beta: float


LAYERS = (
    Layer(0.111, (-0.02, -0.03, -0.10, -0.18), 0.35812, 0.5497104956604, 0.0),
    Layer(0.222, (-0.01, -0.03, -0.10, -0.19), 0.31904, 0.610761381693504, 0.0),
    Layer(0.333, (-0.01, -0.06, -0.16, -0.24), 0.27997, 0.495275119531401, 0.0),
    Layer(0.444, (-0.01, -0.07, -0.19, -0.28), 0.24089, 0.444787616070012, 0.0),
    Layer(0.556, (-0.04, -0.18, -0.29, -0.38), 0.20181, 0.300347803459745, 0.003963450585149),
    Layer(0.667, (-0.07, -0.25, -0.38, -0.46), 0.16273, 0.20343805107867, 0.282870103074075),
    Layer(0.778, (-0.18, -0.34, -0.44, -0.52), 0.12366, 0.127907761590749, 0.661029552075411),
    Layer(0.889, (-0.27, -0.42, -0.49, -0.53), 0.08458, 0.053329360502255, 1.78938146714352),
    Layer(1.0, (-0.36, -0.46, -0.52, -0.58), 0.08458, 0.048585094450798, 1.38733831445508),
)


def confined(layer: Layer) -> febkit.Model:
    """A millimetre of the layer between impermeable walls, drained above, at rest at times 1 to 4 under its strains."""
    m = febkit.Model("biphasic", units="mm-N-s")
    m.add_block("layer", (1, 1, 1), (1, 1, 1))
    m.materials["tissue"] = materials.Biphasic(solid=materials.of("Holmes-Mow", E=0.3, v=layer.v, beta=1.0),
                                               permeability=materials.PermConstIso(perm=2e-3), phi0=0.2)  # fmt: skip
    m.node_sets["top"] = m.nodes(z="max")
    m.fix(m.nodes(), "x", "y")
    m.fix(m.nodes(z="min"), "z")
    m.fix("top", "p")
    m.prescribe("top", z=1.0, curve=[(0, 0), *zip((1, 2, 3, 4), layer.strain)])
    m.step(time=4, dt=0.25, analysis="STEADY-STATE")
    return m


def fitted(layer: Layer) -> febkit.fitting.Fit:
    """E and beta of a layer, from the published fit's start and within its bounds."""
    m = confined(layer)
    H = min(s / e for s, e in zip(STRESS, layer.strain))  # the least secant
    E = H * (1 - 2 * layer.v) * (1 + layer.v) / (1 - layer.v)
    bounds = {"tissue.solid.E": (0.5 * E, E, 20 * E), "tissue.solid.beta": (0.0, 1.0, 10.0)}
    return febkit.fit(m, bounds, data=np.column_stack([(1, 2, 3, 4), STRESS]), observe="reaction top z")


if __name__ == "__main__":
    print("height  E, MPa: published, fitted  beta: published, fitted  runs")
    for layer in LAYERS:
        f = fitted(layer)
        E, beta = f["tissue.solid.E"], f["tissue.solid.beta"]
        print(f"{layer.height:6.3f} {layer.E:17.5f} {E:9.5f} {layer.beta:16.5f} {beta:9.5f} {f.runs:5d}")
