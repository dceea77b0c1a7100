"""Peak force against Young's modulus: a file, a run of FEBio, a conversion for each."""

import h5py
import matplotlib.pyplot as plt
import numpy as np
from plug_pyfebio import m, solid
from pyfebio.model import run_model
from pyfebio.xplt import to_hdf5

moduli, peaks = np.linspace(0.3, 0.9, 5), []
for E in moduli:
    solid.E.text = E
    m.save("sweep.feb")
    run_model("sweep.feb", silent=True)
    to_hdf5("sweep.xplt", "sweep.h5")
    with h5py.File("sweep.h5") as h:
        top = h["meshes/0/nodesets/top"][:]
        forces = [s["node_data/reaction forces/all"][:][top, 2].sum() for s in h["states"].values()]
    peaks.append(max(forces))
plt.plot(moduli, peaks, "o-")
plt.savefig("sweep.png")
