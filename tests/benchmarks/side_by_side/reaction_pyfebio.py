"""The force on a node set against time, by way of HDF5."""

import h5py
import matplotlib.pyplot as plt
from pyfebio.xplt import to_hdf5

to_hdf5("febio.xplt", "febio.h5")
with h5py.File("febio.h5") as h:
    top = h["meshes/0/nodesets/top"][:]
    states = [h[f"states/{k}"] for k in sorted(h["states"], key=int)]
    times = [float(s.attrs["time"][0]) for s in states]
    force = [s["node_data/reaction forces/nodes_1"][:][top, 2].sum() for s in states]
plt.plot(times, force)
