"""The midpoint rule (rhoi = 1) keeps energy; three-field shells have it, three-field solids are refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from febkit.lower import lower
from febkit.model import UnsupportedError
from febkit.solver.kernels.solid import kinematics
from febkit.solver.run import Listener, Run
from helpers import cube

MATERIAL = '<material id="1" name="m" type="Mooney-Rivlin"><density>1</density><k>50</k><c1>1</c1><c2>0</c2></material>'
CONTROL = """<time_steps>8</time_steps><step_size>0.05</step_size><solver type="solid"><rhoi>1</rhoi>
<max_refs>80</max_refs><dtol>1e-7</dtol>
<etol>1e-14</etol><qn_method type="BFGS"><max_ups>0</max_ups></qn_method></solver>"""
HELD = """<bc node_set="base" type="zero shell displacement"><sx_dof>1</sx_dof><sy_dof>1</sy_dof><sz_dof>1</sz_dof></bc>
<bc node_set="top" type="zero shell displacement"><sy_dof>1</sy_dof></bc>
<bc node_set="top" type="zero displacement"><y_dof>1</y_dof></bc></Boundary>"""  # flat: it stretches alone
PULL = '<Loads><body_load type="const"><x>0</x><y>0</y><z>-0.4</z></body_load></Loads>'


def dynamic(content: str) -> str:
    return content.replace("<analysis>STATIC</analysis>", "<analysis>DYNAMIC</analysis>")


def shell(folder: Path) -> str:
    content = dynamic(cube.text(MATERIAL, control=CONTROL, more=PULL))
    content = content.replace('<Elements type="hex8" name="cube"><elem id="1">1,2,3,4,5,6,7,8</elem>',
                              '<Elements type="quad4" name="cube"><elem id="1">1,2,6,5</elem>')
    content = content.replace("1,2,3,4</NodeSet>", "1,2</NodeSet>").replace("5,6,7,8</NodeSet>", "5,6</NodeSet>")
    return content.replace('<SolidDomain name="cube" mat="m"/></MeshDomains>',
                           '<ShellDomain name="cube" mat="m"><shell_thickness>0.2</shell_thickness></ShellDomain>'
                           "</MeshDomains>").replace("</Boundary>", HELD)  # fmt: skip


class Energy(Listener):
    """Kinetic and strain energy less the work of the load, after each step."""

    def __init__(self) -> None:
        self.total: list[float] = []
        self.strain: list[float] = []

    def converged(self, run: Run, counts: object) -> None:
        s, g, system = run.state, run.groups[0], run.system
        assert system is not None
        F, J, f = np.empty_like(g.F), np.empty_like(g.J), np.zeros_like(s.d)
        kinematics(0, g.m, s.u, g.conn, g.dN, g.iJ0, F, J)
        pts = g.points()
        pts.F, pts.J = F.reshape(-1, 3, 3), J.reshape(-1).copy()
        W = float((g.block.solid.energy(pts) * g.wJ0.reshape(-1)).sum())
        for load in system.body_loads:
            load.residual(s, run.groups, f)
        kinetic = 0.5 * float((s.velocity * (system.mass @ s.velocity)).sum())
        self.strain.append(W)
        self.total.append(kinetic + W - float((f * s.d).sum()))


def test_a_three_field_shell_keeps_its_energy(tmp_path: Path) -> None:
    problem, energy = lower(cube.read(tmp_path, shell(tmp_path))), Energy()
    assert problem.blocks[0].physics.name == "three-field"
    result = Run(problem, [energy]).solve()
    assert result.converged, result.reason
    assert max(energy.strain) > 5e-4
    np.testing.assert_allclose(energy.total, energy.total[0], atol=1e-6 * max(energy.strain))


def test_a_three_field_solid_is_refused(tmp_path: Path) -> None:
    model = cube.read(tmp_path, dynamic(cube.text(MATERIAL, control=CONTROL, more=PULL)))
    with pytest.raises(UnsupportedError, match="three-field"):
        lower(model)


def test_materials_without_an_energy_are_refused(tmp_path: Path) -> None:
    """The rule divides by the energy's change; it ended in a traceback."""
    donnan = """<material id="1" name="m" type="Donnan equilibrium"><density>1</density><phiw0>0.8</phiw0><cF0>0.2</cF0>
<bosm>0.3</bosm></material>"""
    constants = "<R>8.3</R><T>0.3</T>"
    content = cube.text(donnan, constants=constants, control=CONTROL)
    cube.problem(tmp_path, content)
    with pytest.raises(UnsupportedError, match="gives no strain energy"):
        cube.problem(tmp_path, dynamic(content))
