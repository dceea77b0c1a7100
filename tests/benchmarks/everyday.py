"""Ten models as people run them every day, of 500 to 10,000 solid elements, built by febkit; both programs read them.

    python tests/benchmarks/everyday.py FOLDER      writes them there; beside.py runs them
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np

import febkit
from febkit import materials as mt

RAMP = [(0, 0), (1, 1)]
MODELS: dict[str, Callable[[], febkit.Model]] = {}


def model(build: Callable[[], febkit.Model]) -> Callable[[], febkit.Model]:
    MODELS[build.__name__] = build
    return build


def block(n: tuple[int, int, int], size: tuple[float, float, float] = (1, 1, 1)) -> febkit.Model:
    """A block of hexahedra on three planes of symmetry, its top a set; no material."""
    m = febkit.Model("solid", units="mm-N-s")
    m.add_block("block", size, n)
    for axis in "xyz":
        m.fix(m.nodes(**{axis: 0}), axis)
    m.node_sets["top"] = m.nodes(z="max")
    return m


def steps(m: febkit.Model, n: int) -> febkit.Model:
    m.step(time=1, dt=1 / n, fixed=True)
    return m


@model
def pressed_block() -> febkit.Model:
    """2,000 hexahedra of neo-Hookean tissue under a pressure that follows them."""
    m = block((10, 10, 20), (1, 1, 2))
    m.materials["tissue"] = mt.NeoHookean(E=1.0, v=0.3)
    m.load(m.faces(z="max"), "pressure", pressure=0.1, curve=RAMP)
    return steps(m, 10)


@model
def biaxial_stretch() -> febkit.Model:
    """2,000 three-field hexahedra of Mooney-Rivlin rubber, stretched both ways."""
    m = block((20, 20, 5), (1, 1, 0.25))
    m.materials["rubber"] = mt.MooneyRivlin(c1=1.0, c2=0.2, k=500)
    m.prescribe(m.nodes(x="max"), x=0.3, curve=RAMP)
    m.prescribe(m.nodes(y="max"), y=0.2, curve=RAMP)
    return steps(m, 10)


@model
def artery_wall() -> febkit.Model:
    """1,728 hexahedra of two families of fibers (Holzapfel-Gasser-Ogden), sheared."""
    m = block((12, 12, 12))
    m.materials["wall"] = mt.HolzapfelGasserOgden(c=0.5, k1=1.0, k2=5.0, kappa=0.1, gamma=40.0, k=100.0)
    m.prescribe("top", x=0.3, z=0.1, curve=RAMP)
    return steps(m, 10)


@model
def fiber_mixture() -> febkit.Model:
    """1,000 hexahedra of a Mooney-Rivlin ground with an ellipsoidal distribution of fibers, stretched."""
    m = block((10, 10, 10))
    m.materials["tendon"] = mt.EFDMooneyRivlin(c1=0.1, c2=0.0, k=50, ksi=(0.5, 0.2, 0.2), beta=(2.5, 2.5, 2.5))
    m.prescribe("top", z=0.2, curve=RAMP)
    return steps(m, 5)


@model
def block_on_block() -> febkit.Model:
    """1,648 hexahedra: a small block slides onto a larger one."""
    m = febkit.Model("solid", units="mm-N-s")
    m.add_block("below", (2, 2, 1), (14, 14, 6))
    m.add_block("above", (0.9, 0.9, 0.5), (11, 11, 4), origin=(0.55, 0.55, 1.0))
    for name, E in (("below", 1.0), ("above", 5.0)):
        m.materials[name] = mt.NeoHookean(E=E, v=0.3)
        m.assign(name, name)
    m.surfaces["upper"], m.surfaces["lower"] = m.faces(part="above", z=1), m.faces(part="below", z=1)
    m.fix(m.nodes(z="min"), "x", "y", "z")
    m.prescribe(m.nodes(z="max"), z=-0.15, x=0.0, y=0.0, curve=RAMP)
    m.touch("upper", "lower", "sliding-elastic", penalty=10, auto_penalty=True)
    return steps(m, 10)


@model
def turned_bar() -> febkit.Model:
    """3,000 hexahedra between rigid grips, pulled and turned."""
    m = febkit.Model("solid", units="mm-N-s")
    m.add_block("bar", (1, 1, 3), (10, 10, 30), origin=(-0.5, -0.5, 0))
    m.materials["soft"] = mt.VerondaWestmann(c1=1.0, c2=0.5, k=200)
    m.materials["grip"] = mt.RigidBody(density=1.0, center_of_mass=(0, 0, 3))
    m.fix(m.nodes(z="min"), "x", "y", "z")
    m.attach(m.nodes(z="max"), "grip")
    m.fix_body("grip", "Rx", "Ry", "Ru", "Rv")
    m.move_body("grip", z=0.2, Rw=0.6, curve=RAMP)
    return steps(m, 10)


@model
def quadratic_tets() -> febkit.Model:
    """3,072 ten-node tetrahedra, bent."""
    m = febkit.Model("solid", units="mm-N-s")
    m.add_part("beam", "tet10", *tet10((1, 1, 4), (4, 4, 32)))
    m.materials["soft"] = mt.NeoHookean(E=1.0, v=0.45)
    m.fix(m.nodes(z=0), "x", "y", "z")
    m.prescribe(m.nodes(z="max"), x=0.5, curve=RAMP)
    return steps(m, 5)


def tet10(size: tuple[float, float, float], n: tuple[int, int, int]) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and ten-node tetrahedra of a box: six for each cube, nodes between corners half way."""
    from febkit.modelling.meshes import block as box

    X, cubes = box(size, n)
    corners = np.array([(0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6)])
    four = cubes[:, corners].reshape(-1, 4)
    ends = np.array([(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)])
    edges, which = np.unique(np.sort(four[:, ends], axis=2).reshape(-1, 2), axis=0, return_inverse=True)
    return np.vstack([X, X[edges].mean(axis=1)]), np.hstack([four, len(X) + which.reshape(-1, 6)])


@model
def shell_roof() -> febkit.Model:
    """1,600 shells, a flat roof held along two edges, under a pressure that follows it."""
    m = febkit.Model("solid", units="mm-N-s")
    k = np.linspace(0, 1, 41)
    y, x = (v.ravel() for v in np.meshgrid(k, k, indexing="ij"))
    first = np.array([41 * j + i for j in range(40) for i in range(40)])
    m.add_part("roof", "quad4", np.column_stack([x, y, 0 * x]), first[:, None] + [0, 1, 42, 41])
    m.materials["steel"] = mt.NeoHookean(E=1000.0, v=0.3)
    m.parts["roof"].thickness = 0.02
    m.fix(m.nodes(x=0), "x", "y", "z")
    m.fix(m.nodes(x=1), "x", "y", "z")
    m.load(m.faces(part="roof"), "pressure", pressure=0.01, curve=RAMP)
    return steps(m, 10)


@model
def large_block() -> febkit.Model:
    """8,000 hexahedra of Holmes-Mow cartilage, pressed by a fifth."""
    m = block((20, 20, 20))
    m.materials["cartilage"] = mt.HolmesMow(E=0.5, v=0.2, beta=0.5)
    m.fix("top", "x", "y")
    m.prescribe("top", z=-0.2, curve=RAMP)
    return steps(m, 5)


@model
def relaxation() -> febkit.Model:
    """512 hexahedra of a viscoelastic solid: 50 steps of pull and hold."""
    m = block((8, 8, 8))
    m.materials["tissue"] = mt.Viscoelastic(elastic=mt.NeoHookean(E=1.0, v=0.3), t1=0.1, t2=1.0, g1=0.6, g2=0.4)
    m.fix("top", "x", "y")
    m.prescribe("top", z=0.2, curve=[(0, 0), (0.2, 1), (1, 1)])
    return steps(m, 50)


def write(folder: Path) -> list[Path]:
    folder.mkdir(parents=True, exist_ok=True)
    files = []
    for name, build in MODELS.items():
        m = build()
        m.output.plot = ["displacement", "stress"]
        files.append(folder / f"{name}.feb")
        m.write(files[-1])
    return files


if __name__ == "__main__":
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    print(*write(Path(sys.argv[1])), sep="\n")
