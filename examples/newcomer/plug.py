"""Unconfined compression of a cartilage plug, built and solved: a quarter of it between smooth platens."""

import febkit
from febkit import materials as mt

m = febkit.Model("biphasic", units="mm-N-s")
m.add_cylinder("plug", radius=1, height=1, n=(6, 6), sector="quarter")
m.materials["cartilage"] = mt.Biphasic(
    solid=mt.NeoHookean(E=0.6, v=0.1), permeability=mt.PermConstIso(perm=2e-3), phi0=0.2
)
m.fix(m.nodes(x=0), "x")
m.fix(m.nodes(y=0), "y")
m.fix(m.nodes(z="min"), "z")
m.fix(m.nodes(where=lambda X: X[:, 0] ** 2 + X[:, 1] ** 2 > 0.998), "p")
m.node_sets["top"] = m.nodes(z="max")
m.prescribe("top", z=-0.05, curve=[(0, 0), (10, 1)])
m.step(time=5000, dt=1, dtmax=200, must_points=[10, 5000], plot="PLOT_MAJOR_ITRS")
result = m.solve()
force = result.dataset.febkit.reaction("top").sel(xyz="z")
