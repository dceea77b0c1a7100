"""Writes the plug's .feb with pyfebio; FEBio's program has to solve it."""

import meshio
import numpy as np
from pyfebio import boundary, control, loaddata, material, mesh, meshdomains, model, output

msh = meshio.read("plug.msh")
X, hexes = msh.points, msh.cells_dict["hexahedron"] + 1
sets = {
    "x0": X[:, 0] < 1e-6, "y0": X[:, 1] < 1e-6, "bottom": X[:, 2] < 1e-6, "top": X[:, 2] > 1 - 1e-6,
    "side": np.hypot(X[:, 0], X[:, 1]) > 0.999}  # fmt: skip
m = model.BiphasicModel()
nodes = mesh.Nodes(name="all")
for i, x in enumerate(X, 1):
    nodes.add_node(mesh.Node(id=i, text=",".join(map(str, x))))
m.mesh_.nodes.append(nodes)
elements = mesh.Elements(name="plug", type="hex8")
for i, e in enumerate(hexes, 1):
    elements.add_element(mesh.Hex8Element(id=i, text=",".join(map(str, e))))
m.mesh_.elements.append(elements)
for name, mask in sets.items():
    m.mesh_.node_sets.append(mesh.NodeSet(name=name, text=",".join(map(str, np.flatnonzero(mask) + 1))))
solid = material.NeoHookean(E=material.MaterialParameter(text=0.6), v=material.MaterialParameter(text=0.1))
perm = material.ConstantIsoPerm(perm=material.MaterialParameter(text=2e-3))
cartilage = material.BiphasicMaterial(
    id=1, name="cartilage", solid=solid, permeability=perm,
    phi0=material.MaterialParameter(text=0.2))  # fmt: skip
m.material_.add_material(cartilage)
m.meshdomains_.add_solid_domain(meshdomains.SolidDomain(name="plug", mat="cartilage"))
m.boundary_.add_bc(boundary.BCZeroDisplacement(node_set="x0", x_dof=1))
m.boundary_.add_bc(boundary.BCZeroDisplacement(node_set="y0", y_dof=1))
m.boundary_.add_bc(boundary.BCZeroDisplacement(node_set="bottom", z_dof=1))
m.boundary_.add_bc(boundary.BCZeroFluidPressure(node_set="side"))
value = boundary.Value(lc=1, text=-0.05)
m.boundary_.add_bc(boundary.BCPrescribedDisplacement(node_set="top", dof="z", value=value))
m.loaddata_.add_load_curve(loaddata.LoadCurve(id=1, points=loaddata.CurvePoints(points=["0,0", "10,1"])))
m.control_.time_steps, m.control_.step_size = 5000, 1.0
m.control_.time_stepper = control.TimeStepper(dtmax=control.TimeStepValue(text=200.0))
variables = [output.Var(type="displacement"), output.Var(type="reaction forces")]
m.output_.add_plotfile(output.OutputPlotfile(all_vars=variables))
m.save("pyfebio.feb")
