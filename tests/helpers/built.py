"""Ten models of FEBio's kinds, built by the API alone; each says what of its last state is compared with FEBio."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

import febkit
from febkit import materials as mt

# a run of either program ends within 1e-7 of the solution of its own equations
TIGHT = {"dtol": 1e-8, "etol": 1e-12, "rtol": 1e-10}
RAMP = [(0, 0), (1, 1)]
MODELS: dict[str, Callable[[], febkit.Model]] = {}


def model(build: Callable[[], febkit.Model]) -> Callable[[], febkit.Model]:
    MODELS[build.__name__] = build
    return build


def cube(n: tuple[int, int, int] = (2, 2, 2), module: str = "solid") -> febkit.Model:
    """A unit cube on three planes of symmetry, its top a set; no material."""
    m = febkit.Model(module, units="mm-N-s")
    m.add_block("cube", (1, 1, 1), n)
    for axis in "xyz":
        m.fix(m.nodes(**{axis: 0}), axis)
    m.node_sets["top"] = m.nodes(z="max")
    return m


@model
def stretched_rubber() -> febkit.Model:
    """Uncoupled Mooney-Rivlin, three-field hexahedra, stretched by a half."""
    m = cube()
    m.materials["rubber"] = mt.MooneyRivlin(c1=1.0, c2=0.2, k=500)
    m.prescribe("top", z=0.5, curve=RAMP)
    m.step(time=1, dt=0.1, fixed=True, solver=TIGHT)
    return m


@model
def fibers_under_pressure() -> febkit.Model:
    """A mixture of a ground substance and fibers at 30 degrees, pressed from the side by a follower pressure."""
    m = cube((3, 2, 2))
    fiber = mt.FiberExpPow(ksi=2.0, alpha=1.0, beta=2.5, fiber=febkit.materials.of("angles", theta=30, phi=90))
    m.materials["tissue"] = mt.SolidMixture(solid=[mt.HolmesMow(E=1.0, v=0.2, beta=0.5), fiber])
    m.load(m.faces(x="max"), "pressure", pressure=0.2, curve=RAMP)
    m.step(time=1, dt=0.1, fixed=True, solver=TIGHT)
    return m


@model
def drained_plug() -> febkit.Model:
    """Biphasic unconfined compression with permeability that falls with strain."""
    m = febkit.Model("biphasic", units="mm-N-s")
    m.add_cylinder("plug", radius=1, height=1, n=(4, 3), sector="quarter")
    m.materials["cartilage"] = mt.Biphasic(
        solid=mt.NeoHookean(E=0.6, v=0.1), permeability=mt.PermHolmesMow(perm=2e-3, M=2.0, alpha=2.0), phi0=0.2)
    for axis in "xyz":
        m.fix(m.nodes(**{axis: 0}), axis)
    m.fix(m.nodes(where=lambda X: np.hypot(X[:, 0], X[:, 1]) > 0.999), "p")
    m.node_sets["top"] = m.nodes(z="max")
    m.prescribe("top", z=-0.1, curve=[(0, 0), (10, 1)])
    m.step(time=100, dt=5, fixed=True, solver={**TIGHT, "ptol": 1e-8})
    return m


@model
def squeezed_column() -> febkit.Model:
    """Biphasic creep under a load on a drained top, fluid pressed in from below."""
    m = febkit.Model("biphasic", units="mm-N-s")
    m.add_block("column", (0.2, 0.2, 1), (1, 1, 8), bias=(1, 1, 0.8))
    m.materials["tissue"] = mt.Biphasic(
        solid=mt.HolmesMow(E=0.5, v=0.2, beta=0.3), permeability=mt.PermConstIso(perm=5e-3), phi0=0.25)
    m.fix("all", "x", "y")
    m.fix(m.nodes(z="min"), "z")
    m.node_sets["top"] = m.nodes(z="max")
    m.fix("top", "p")
    m.load(m.faces(z="max"), "traction", traction=(0, 0, -0.1), curve=RAMP)
    m.load(m.faces(z="min"), "fluidflux", flux=-1e-4, curve=RAMP)
    m.step(time=50, dt=2.5, fixed=True, solver={**TIGHT, "ptol": 1e-8})
    return m


@model
def turned_grip() -> febkit.Model:
    """A bar whose end is held by a rigid body, pulled and turned about its axis."""
    m = febkit.Model("solid", units="mm-N-s")
    m.add_block("bar", (1, 1, 3), (2, 2, 5), origin=(-0.5, -0.5, 0))
    m.materials["soft"] = mt.NeoHookean(E=1.0, v=0.3)
    m.materials["grip"] = mt.RigidBody(density=1.0, center_of_mass=(0, 0, 3))
    m.node_sets["top"] = m.nodes(z="max")
    m.fix(m.nodes(z="min"), "x", "y", "z")
    m.attach("top", "grip")
    m.fix_body("grip", "Rx", "Ry", "Ru", "Rv")
    m.move_body("grip", z=0.3, Rw=0.8, curve=RAMP)
    m.step(time=1, dt=0.1, fixed=True, solver=TIGHT)
    return m


@model
def pushed_plate() -> febkit.Model:
    """A rigid plate on a soft block, pushed down and sideways by forces."""
    m = febkit.Model("solid", units="mm-N-s")
    m.add_block("block", (1, 1, 1), (3, 3, 3))
    m.add_block("plate", (1, 1, 0.2), (3, 3, 1), origin=(0, 0, 1))
    m.materials["soft"] = mt.CoupledMooneyRivlin(c1=0.2, c2=0.05, k=2.0)
    m.materials["plate"] = mt.RigidBody(density=1.0)
    m.assign("soft", "block")
    m.assign("plate", "plate")
    m.fix(m.nodes(z="min"), "x", "y", "z")
    m.node_sets["top"] = m.nodes(part="block", z=1)
    m.attach("top", "plate")
    m.push_body("plate", z=-0.1, x=0.03, curve=RAMP)
    m.step(time=1, dt=0.1, fixed=True, solver=TIGHT)
    return m


@model
def block_on_block() -> febkit.Model:
    """Sliding contact without friction by augmented Lagrangian: a small block pressed into a larger one."""
    m = febkit.Model("solid", units="mm-N-s")
    m.add_block("below", (2, 2, 1), (4, 4, 2))
    m.add_block("above", (0.9, 0.9, 0.5), (3, 3, 2), origin=(0.55, 0.55, 1.0))
    m.materials["below"] = mt.NeoHookean(E=1.0, v=0.3)
    m.materials["above"] = mt.NeoHookean(E=5.0, v=0.3)
    m.assign("below", "below")
    m.assign("above", "above")
    m.surfaces["upper"], m.surfaces["lower"] = m.faces(part="above", z=1), m.faces(part="below", z=1)
    m.fix(m.nodes(z="min"), "x", "y", "z")
    m.node_sets["top"] = m.nodes(z="max")
    m.prescribe("top", z=-0.15, x=0.0, y=0.0, curve=RAMP)
    m.touch("upper", "lower", "sliding-facet-on-facet", penalty=50, laugon="AUGLAG", tolerance=0.01)
    m.step(time=1, dt=0.1, fixed=True, solver=TIGHT)
    return m


@model
def glued_blocks() -> febkit.Model:
    """Two meshes that do not match, tied, sheared."""
    m = febkit.Model("solid", units="mm-N-s")
    m.add_block("below", (1, 1, 1), (3, 3, 2))
    m.add_block("above", (1, 1, 0.5), (2, 2, 2), origin=(0, 0, 1))
    m.materials["soft"] = mt.NeoHookean(E=1.0, v=0.3)
    m.assign("soft", "below", "above")
    m.surfaces["upper"], m.surfaces["lower"] = m.faces(part="above", z=1), m.faces(part="below", z=1)
    m.fix(m.nodes(z="min"), "x", "y", "z")
    m.node_sets["top"] = m.nodes(z="max")
    m.prescribe("top", x=0.2, z=-0.1, y=0.0, curve=RAMP)
    m.touch("upper", "lower", "tied-elastic", penalty=100)
    m.step(time=1, dt=0.1, fixed=True, solver={**TIGHT, "symmetric_stiffness": 0})
    return m


@model
def bent_plate() -> febkit.Model:
    """A cantilever of shells under a pressure that follows it."""
    m = febkit.Model("solid", units="mm-N-s")
    y, x = (v.ravel() for v in np.meshgrid(np.linspace(0, 1, 3), np.linspace(0, 4, 9), indexing="ij"))
    first = np.array([9 * j + i for j in range(2) for i in range(8)])
    m.add_part("plate", "quad4", np.column_stack([x, y, 0 * x]), first[:, None] + [0, 1, 10, 9])
    m.materials["steel"] = mt.NeoHookean(E=1000.0, v=0.3)
    m.parts["plate"].thickness = 0.1
    m.fix(m.nodes(x=0), "x", "y", "z", "sx", "sy", "sz")
    m.node_sets["top"] = m.nodes(x="max")
    m.load(m.faces(part="plate"), "pressure", pressure=0.002, curve=RAMP)
    m.step(time=1, dt=0.1, fixed=True, solver=TIGHT)
    return m


@model
def three_steps() -> febkit.Model:
    """A viscoelastic cube: stretched, held while it relaxes, then sheared as well."""
    m = cube()
    m.materials["tissue"] = mt.Viscoelastic(
        elastic=mt.NeoHookean(E=1.0, v=0.2), t1=0.5, t2=5.0, g1=0.6, g2=0.4, g0=1.0)
    m.prescribe("top", z=0.3, curve=RAMP)
    m.step("pull", time=1, dt=0.1, fixed=True, solver=TIGHT)
    m.step("hold", time=4, dt=0.4, fixed=True, solver=TIGHT)
    shear = m.step("shear", time=1, dt=0.1, fixed=True, solver=TIGHT)
    shear.prescribe(m.nodes(z="max"), y=0.2, curve=[(5, 0), (6, 1)])
    return m
