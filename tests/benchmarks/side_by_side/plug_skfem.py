"""The plug in scikit-fem: small strains, Biot's equations as weak forms, backward Euler by hand."""

import meshio
import numpy as np
from scipy.sparse import bmat
from skfem import Basis, BilinearForm, ElementHex1, ElementVector, MeshHex, condense, solve
from skfem.helpers import ddot, div, dot, eye, grad, sym_grad, trace

msh = meshio.read("plug.msh")
order = [0, 1, 3, 4, 2, 5, 7, 6]  # scikit-fem's of a hexahedron
mesh = MeshHex(msh.points.T, msh.cells_dict["hexahedron"][:, order].T)
u, p = Basis(mesh, ElementVector(ElementHex1())), Basis(mesh, ElementHex1())
v, k = 0.1, 2e-3


@BilinearForm
def stiffness(a, b, w):
    e = sym_grad(a)
    return ddot(e + v / (1 - 2 * v) * eye(trace(e), 3), sym_grad(b)) / (1 + v)


@BilinearForm
def coupling(a, q, w):
    return q * div(a)


@BilinearForm
def seepage(a, b, w):
    return k * dot(grad(a), grad(b))


K1, H = stiffness.assemble(u), seepage.assemble(p)
B = coupling.assemble(u, p)
x, y, z = mesh.p
side, top = np.flatnonzero(np.hypot(x, y) > 0.999), np.flatnonzero(z > 1 - 1e-6)
pz, N = u.nodal_dofs[2, top], u.N
fixed = np.concatenate([
    u.nodal_dofs[0, x < 1e-6], u.nodal_dofs[1, y < 1e-6], u.nodal_dofs[2, z < 1e-6],
    pz, N + p.nodal_dofs[0, side]])  # fmt: skip


def relax(E):
    """Times and forces on the top; equations by backward Euler, steps that grow."""
    K, t, dt, s = E * K1, 0.0, 1.0, np.zeros(N + p.N)
    times, force = [], []
    while t < 5000 - 1e-9:
        dt = min(dt, 10 - t if t < 10 else 5000 - t)
        t += dt
        A = bmat([[K, -B.T], [-B, -dt * H]], "csr")
        rhs = np.concatenate([np.zeros(N), -B @ s[:N]])
        new = np.zeros_like(s)
        new[pz] = -0.05 * min(t / 10, 1)
        s = solve(*condense(A, rhs, x=new, D=fixed))
        times.append(t)
        force.append(-(K @ s[:N] - B.T @ s[N:])[pz].sum())
        dt = min(1.5 * dt, 200.0)
    return times, force


times, force = relax(0.6)
