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
