"""Peak force against Young's modulus of the solid, nothing written to disk."""

import matplotlib.pyplot as plt
import numpy as np

import febkit

m = febkit.read("plug.feb")
moduli, peaks = np.linspace(0.3, 0.9, 5), []
for E in moduli:
    m.materials["cartilage"].solid.E = E
    force = m.solve(variables=["reaction forces"]).dataset.febkit.reaction("top")
    peaks.append(-force.sel(xyz="z").min())
plt.plot(moduli, peaks, "o-")
plt.savefig("sweep.png")
