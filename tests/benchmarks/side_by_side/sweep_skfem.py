"""Peak force against Young's modulus; plug_skfem.py first."""

import matplotlib.pyplot as plt
import numpy as np
from plug_skfem import relax

moduli = np.linspace(0.3, 0.9, 5)
plt.plot(moduli, [max(relax(E)[1]) for E in moduli], "o-")
plt.savefig("sweep.png")
