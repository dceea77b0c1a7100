"""The plug's solid in felupe: no fluid, so the state at rest only."""

import felupe as fem
import meshio
import numpy as np

msh = meshio.read("plug.msh")
mesh = fem.Mesh(msh.points, msh.cells_dict["hexahedron"], "hexahedron")
region = fem.RegionHexahedron(mesh)
field = fem.FieldContainer([fem.Field(region, dim=3)])
E, v = 0.6, 0.1
umat = fem.NeoHookeCompressible(mu=E / 2 / (1 + v), lmbda=E * v / (1 + v) / (1 - 2 * v))
solid = fem.SolidBody(umat, field)
bounds = {
    "x": fem.Boundary(field[0], fx=0, skip=(0, 1, 1)),
    "y": fem.Boundary(field[0], fy=0, skip=(1, 0, 1)),
    "bottom": fem.Boundary(field[0], fz=0, skip=(1, 1, 0)),
    "move": fem.Boundary(field[0], fz=1, skip=(1, 1, 0)),
}
step = fem.Step(items=[solid], ramp={bounds["move"]: np.linspace(0, -0.05, 6)}, boundaries=bounds)
curve = fem.CharacteristicCurve(steps=[step], boundary=bounds["move"])
curve.evaluate(verbose=0)
force = np.array(curve.y)[:, 2]
