"""The same from arrays of numpy: a block of cartilage, drained at one side."""

import numpy as np

import febkit
from febkit import materials as mt

X = np.array([(x, y, z) for z in np.linspace(0, 1, 5) for y in (0, 1) for x in np.linspace(0, 1, 5)])
first = np.array([10 * k + i for k in range(4) for i in range(4)])
hexahedra = first[:, None] + [0, 1, 6, 5, 10, 11, 16, 15]
m = febkit.Model("biphasic", units="mm-N-s")
m.add_part("block", "hex8", X, hexahedra)
m.materials["cartilage"] = mt.Biphasic(
    solid=mt.NeoHookean(E=0.6, v=0.1), permeability=mt.PermConstIso(perm=2e-3), phi0=0.2
)
m.fix(X[:, 0] == 0, "x")
m.fix("all", "y")
m.fix(X[:, 2] == 0, "z")
m.fix(X[:, 0] == 1, "p")
m.prescribe(X[:, 2] == 1, z=-0.05, curve=[(0, 0), (10, 1)])
m.step(time=5000, dt=1, dtmax=200)
result = m.solve()
