"""The mean third principal strain of a part, if the plotfile holds the strain; elements count alike."""

import h5py
import numpy as np
from pyfebio.xplt import to_hdf5

to_hdf5("febio.xplt", "febio.h5")
with h5py.File("febio.h5") as h:
    strain = []
    for k in sorted(h["states"], key=int):
        xx, yy, zz, xy, yz, xz = h[f"states/{k}/element_data/Lagrange strain/plug"][:].T
        full = np.moveaxis(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]), 2, 0)
        strain.append(np.linalg.eigvalsh(full)[:, 0].mean())
