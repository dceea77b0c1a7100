"""Central differences: FEBio's answers, momentum, the period of an oscillator, what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import febkit
from febkit.lower import unsupported
from febkit.solver import physics
from febkit.solver.explicit import Central
from febkit.solver.loads.nodal import NodalForce
from febkit.solver.problem import DYNAMIC, Block, Fixed, Problem, Step
from febkit.solver.run import Listener, Run
from febkit.solver.solids.inert import Inert
from febkit.solver.solids.neo_hookean import NeoHookean
from febkit.solver.values import Constant, Expression
from helpers import cube, scenes

POINTS = ("0,0,0", "1,0,0.1", "1,1.1,0", "0,1,0", "0,0,1", "1,0.1,1", "1.1,1,1", "0,1,1.1", "0,0,2", "1,0,2.1", "1,1,2",
          "0.1,1,2")  # fmt: skip
MODEL = """<febio_spec version="4.0"><Module type="solid"/>
<Control><analysis>DYNAMIC</analysis><time_steps>200</time_steps><step_size>0.002</step_size>
<solver type="explicit-solid"><mass_lumping>{lumping}</mass_lumping><dyn_damping>{damping}</dyn_damping></solver>
</Control>
<Material><material id="1" name="m" type="neo-Hookean"><density>2</density><E>100</E><v>0.3</v></material></Material>
<Mesh><Nodes name="all">{nodes}</Nodes>
<Elements type="hex8" name="p"><elem id="1">1,2,3,4,5,6,7,8</elem><elem id="2">5,6,7,8,9,10,11,12</elem></Elements>
<NodeSet name="held">1,2,3,4</NodeSet><NodeSet name="end">11</NodeSet><NodeSet name="top">9,10</NodeSet></Mesh>
<MeshDomains><SolidDomain name="p" mat="m"/></MeshDomains>
<Boundary><bc type="zero displacement" node_set="held"><x_dof>1</x_dof><y_dof>1</y_dof><z_dof>1</z_dof></bc>
<bc type="prescribed displacement" node_set="top"><dof>x</dof><value lc="1">0.1</value></bc></Boundary>
<Loads><nodal_load type="nodal_force" node_set="end"><value>2,-1.5,3</value></nodal_load>
<body_load type="body force"><force lc="1">0,3,1</force></body_load>{loads}</Loads>{more}
<LoadData><load_controller id="1" type="loadcurve"><interpolate>LINEAR</interpolate>
<points><pt>0,0</pt><pt>0.4,1</pt></points></load_controller></LoadData></febio_spec>"""


def text(lumping: int = 2, damping: float = 1.0, loads: str = "", more: str = "") -> str:
    nodes = "".join(f'<node id="{k}">{x}</node>' for k, x in enumerate(POINTS, 1))
    return MODEL.format(lumping=lumping, damping=damping, nodes=nodes, loads=loads, more=more)


@pytest.mark.parametrize(("lumping", "damping", "answer"), [
    (2, 0.999,
     [[0.0348508942121, -0.0524044270886, 0.0435032353885], [0.217412661967, -0.373439990259, 0.285181633971]]),
    (1, 1.0,
     [[0.0369395969233, -0.0549704417982, 0.0470184508027], [0.227081901213, -0.395085310216, 0.299785821431]]),
])  # fmt: skip
def test_febios_answers(tmp_path: Path, lumping: int, damping: float, answer: list[list[float]]) -> None:
    """Displacements of nodes 7 and 11 after 200 steps (FEBio 4.11)."""
    result = febkit.solve(cube.read(tmp_path, text(lumping, damping)))
    assert result.converged, result.reason
    np.testing.assert_allclose(result.state.u[[6, 10]], answer, rtol=1e-9)


IMPACT = """<?xml version="1.0"?>
<febio_spec version="4.0"><Module type="solid"/>
<Control><analysis>DYNAMIC</analysis><time_steps>200</time_steps><step_size>1e-3</step_size>
<solver type="explicit-solid"><mass_lumping>1</mass_lumping><dyn_damping>0.999</dyn_damping></solver></Control>
<Material><material id="1" name="m" type="neo-Hookean"><density>1</density><E>500</E><v>0.3</v></material>
<material id="2" name="b" type="{falling}</material></Material>
<Mesh><Nodes name="all">{nodes}</Nodes>
<Elements type="hex8" name="p"><elem id="1">1,2,3,4,5,6,7,8</elem></Elements>
<Elements type="hex8" name="q"><elem id="2">9,10,11,12,13,14,15,16</elem></Elements>
<NodeSet name="held">1,2,3,4</NodeSet>
<Surface name="under"><quad4 id="1">9,12,11,10</quad4></Surface>
<Surface name="top"><quad4 id="1">5,6,7,8</quad4></Surface>
<SurfacePair name="c"><primary>under</primary><secondary>top</secondary></SurfacePair></Mesh>
<MeshDomains><SolidDomain name="p" mat="m"/><SolidDomain name="q" mat="b"/></MeshDomains>
<Boundary><bc type="zero displacement" node_set="held"><x_dof>1</x_dof><y_dof>1</y_dof><z_dof>1</z_dof></bc></Boundary>
<Loads><body_load type="body force"><force>0,2,30</force></body_load></Loads>{rigid}
<Contact><contact name="c" surface_pair="c" type="{contact}</contact></Contact>
<Output><plotfile type="febio"><var type="displacement"/></plotfile></Output></febio_spec>"""
SOFT = 'neo-Hookean"><density>1</density><E>1000</E><v>0.2</v>'
TUMBLING = """<Rigid><rigid_ic name="v" type="initial_rigid_velocity"><rb>b</rb><value>0,1,-2</value></rigid_ic>
<rigid_ic name="w" type="initial_rigid_angular_velocity"><rb>b</rb><value>3,1,-2</value></rigid_ic>
<rigid_load name="a" type="rigid_force"><rb>b</rb><dof>Rx</dof><value>0.3</value>
<load_type>LOAD</load_type></rigid_load>
<rigid_load name="m" type="rigid_moment"><rb>b</rb><dof>Rw</dof><value>0.01</value></rigid_load></Rigid>"""

# of FEBio 4.11
SLID = [
    0.00412191637, 0.00187639345, -0.0151826357, 0.00110853207, -0.00920681283, -0.100415878, 0.000267555151,
    -0.00116756954, -0.00679726247, -0.00177747291, -0.0373930819, -0.0101482086
]
MET = [
    0.00228097918, -0.000130502551, -0.00679917959, 0.000186650228, -0.00958364457, -0.139643356, 0.00589632289,
    0.00570334028, -0.0161737837, 0.000311517244, -0.0373180434, -0.403761059
]
TUMBLED = [
    0.00448914012, 0.00742386142, -0.0193524286, 0.132946432, -0.0167769156, -0.087618351, 0.00997034553,
    0.00597313186, -0.0113750296, 0.157707766, -0.0163125023, -0.0277850553
]


def impact(folder: Path, contact: str, falling: str = SOFT, rigid: str = "") -> np.ndarray:
    """Displacements of a corner of a block and of one that falls onto it, from 0.02 above, at t = 0.1 and 0.2."""
    cube = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], float)
    points = [*(cube * [1.0, 1.0, 0.5]), *(cube * [0.6, 0.5, 0.4] + [0.15, 0.3, 0.52])]
    nodes = "".join(f'<node id="{k}">{x:.12g},{y:.12g},{z:.12g}</node>' for k, (x, y, z) in enumerate(points, 1))
    (folder / "m.feb").write_text(IMPACT.format(nodes=nodes, contact=contact, falling=falling, rigid=rigid))
    result = febkit.solve(folder / "m.feb", plotfile=folder / "m.xplt")
    assert result.converged, result.reason
    with febkit.open_results(folder / "m.xplt") as ds:
        return ds.displacement.values[[100, 200]][:, [6, 14]].astype(float)


@pytest.mark.parametrize(("contact", "answer"), [
    ('sliding-elastic"><penalty>500</penalty>', SLID),
    ('sliding-node-on-facet"><penalty>50</penalty>', MET),
])  # fmt: skip
def test_contact_gives_febios_answers(tmp_path: Path, contact: str, answer: list[float]) -> None:
    np.testing.assert_allclose(impact(tmp_path, contact).ravel(), answer, rtol=1e-6, atol=1e-9)


def test_a_rigid_body_tumbles_as_febios(tmp_path: Path) -> None:
    """Half of its angular acceleration acts, as in FEBio."""
    found = impact(tmp_path, 'sliding-elastic"><penalty>500</penalty>', 'rigid body"><density>1</density>', TUMBLING)
    np.testing.assert_allclose(found.ravel(), TUMBLED, rtol=1e-6, atol=1e-9)


def test_a_free_body_keeps_its_momentum() -> None:
    """After a push of 0.1 at a corner."""
    X, conn = scenes.box("hex8", (2, 2, 2), 0.2)
    push = Expression(lambda X, Y, Z, t: np.where((t > 0.0005) & (t < 0.0995), 1.0, 0.0) + 0 * X)
    force = NodalForce(np.array([0]), X[:1], value=(push, Constant(0.0), push))
    step = Step(analysis=DYNAMIC, dt=0.001, count=400, loads=[force], explicit=Central(by_rows=True))
    r = Run(Problem(X, [Block("cube", "hex8", conn, np.arange(8), NeoHookean(100.0, 0.3, density_=3.0))], [step]))
    assert r.solve().converged
    from febkit.solver.explicit import lumped

    assert r.system is not None
    m = lumped(r.system, True)
    assert m.sum() == pytest.approx(3.0)
    np.testing.assert_allclose(m @ r.state.velocity, [0.099, 0.0, 0.099], atol=1e-12)
    assert np.ptp(r.state.u, axis=0).max() > 0.01


class Path1(Listener):
    def __init__(self) -> None:
        self.u: list[float] = []

    def converged(self, run: Run, counts: object) -> None:
        self.u.append(run.state.u[1, 0])


def test_the_period_of_a_truss() -> None:
    """A mass at the end of a truss: sin(w dt / 2) = w0 dt / 2, w0^2 = k / m, the period of central differences."""
    X = np.array([[0.0, 0, 0], [2.0, 0, 0]])
    p = physics.load("linear truss")(0.5, 80.0, 0.5)
    held = [Fixed(c, np.array([0])) for c in range(3)] + [Fixed(c, np.array([1])) for c in (1, 2)]
    push = NodalForce(np.array([1]), X[1:], value=(Constant(1e-6), Constant(0.0), Constant(0.0)))
    dt, k, m = 0.05, 80.0 * 0.5 / 2.0, 0.5 * 2.0 * 3.0 / 2.0
    step = Step(analysis=DYNAMIC, dt=dt, count=400, conditions=held, loads=[push], explicit=Central(by_rows=True))
    watch = Path1()
    block = Block("truss", "line2", np.array([[0, 1]]), np.arange(1), Inert(density_=3.0), p, rule="G2")
    assert Run(Problem(X, [block], [step]), [watch]).solve().converged
    w = 2.0 / dt * np.arcsin(0.5 * dt * np.sqrt(k / m))
    t = dt * np.arange(1, 401)
    np.testing.assert_allclose(watch.u, 1e-6 / k * (1.0 - np.cos(w * t)), atol=2e-3 * 1e-6 / k)


@pytest.mark.parametrize(("changes", "says"), [
    ({"lumping": 0}, "<mass_lumping>0"),
    ({"loads": '<body_load type="mass damping"><C>1</C></body_load>'}, "follows the motion"),
    ({"more": '<Initial><ic type="velocity" node_set="end"><value>1,0,0</value></ic></Initial>'}, "initial velocity"),
    ({}, ""),
])  # fmt: skip
def test_what_is_refused(tmp_path: Path, changes: dict[str, str], says: str) -> None:
    found = [str(e) for e in unsupported(cube.read(tmp_path, text(**changes)))]  # type: ignore[arg-type]
    assert len(found) == bool(says) and all(says in f for f in found)
