"""The same from gmsh: plug.msh has the physical groups "plug", "bottom", "top" and "side"."""

import febkit
from febkit import materials as mt

m = febkit.Model.from_meshio("plug.msh", "biphasic", units="mm-N-s")
m.materials["cartilage"] = mt.Biphasic(
    solid=mt.NeoHookean(E=0.6, v=0.1), permeability=mt.PermConstIso(perm=2e-3), phi0=0.2
)
m.fix(m.nodes(x=0), "x")
m.fix(m.nodes(y=0), "y")
m.fix("bottom", "z")
m.fix("side", "p")
m.prescribe("top", z=-0.05, curve=[(0, 0), (10, 1)])
m.step(time=5000, dt=1, dtmax=200, must_points=[10, 5000], plot="PLOT_MAJOR_ITRS")
result = m.solve()
force = result.dataset.febkit.reaction("top").sel(xyz="z")
