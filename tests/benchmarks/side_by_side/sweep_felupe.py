"""Force at rest against Young's modulus of the solid; there is no fluid."""

import felupe as fem
import matplotlib.pyplot as plt
import numpy as np
from plug_felupe import bounds, field

moduli, forces, v = np.linspace(0.3, 0.9, 5), [], 0.1
for E in moduli:
    field[0].values[:] = 0
    umat = fem.NeoHookeCompressible(mu=E / 2 / (1 + v), lmbda=E * v / (1 + v) / (1 - 2 * v))
    body = fem.SolidBody(umat, field)
    step = fem.Step(items=[body], ramp={bounds["move"]: np.linspace(0, -0.05, 6)}, boundaries=bounds)
    curve = fem.CharacteristicCurve(steps=[step], boundary=bounds["move"])
    curve.evaluate(verbose=0)
    forces.append(-np.array(curve.y)[-1, 2])
plt.plot(moduli, forces, "o-")
plt.savefig("sweep.png")
