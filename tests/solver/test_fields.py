"""Named fields: a layout's columns, and answers that do not depend on them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import febkit
from febkit import lower
from febkit.solver.fields import DISPLACEMENT, PRESSURE, Field, Layout, concentration
from febkit.solver.group import Group
from febkit.solver.options import Options
from febkit.solver.permeabilities.const_iso import ConstIso
from febkit.solver.physics.biphasic import Biphasic
from febkit.solver.problem import TRANSIENT, Block, Fixed, NewtonOptions, Problem, Step
from febkit.solver.run import run
from febkit.solver.schedule import Schedule
from febkit.solver.solids.neo_hookean import NeoHookean
from febkit.solver.state import State
from febkit.solver.system import System
from febkit.solver.threads import Team
from helpers import scenes

SALT = [concentration(1), concentration(2)]


def test_columns_by_name() -> None:
    layout = Layout([PRESSURE, DISPLACEMENT, *SALT])
    assert layout.width == 6 and "fluid pressure" in layout and "temperature" not in layout
    assert [layout.column(c) for c in ("p", "x", "z", "c2")] == [0, 1, 3, 5]
    assert layout.columns("displacement", "concentration 2").tolist() == [1, 2, 3, 5]
    assert [layout.label(k) for k in (0, 2, 4)] == ["fluid pressure", "y displacement", "concentration 1"]
    d = np.arange(12.0).reshape(2, 6)
    layout.u(d)[:] = 0.0  # views
    layout.scalar(d, "concentration 1")[:] = -1.0
    assert d.tolist() == [[0, 0, 0, 0, -1, 5], [6, 0, 0, 0, -1, 11]]
    assert layout.equations(DISPLACEMENT, np.array([0, 1, 3, 4, 2])).tolist() == [1, 2, 4]
    with pytest.raises(KeyError, match="no field 'temperature'; there are: fluid pressure, displacement"):
        layout["temperature"]
    with pytest.raises(KeyError, match="'q'; there are: p, x, y, z"):
        layout.column("q")
    with pytest.raises(ValueError, match="twice"):
        Layout([PRESSURE, PRESSURE])
    assert Layout.of([DISPLACEMENT], [DISPLACEMENT, PRESSURE]) == Layout([DISPLACEMENT, PRESSURE])


def test_each_field_has_its_tolerance() -> None:
    o = NewtonOptions(dtol=0.1, ctol=0.3, tolerances={"ttol": 0.4})
    heat, other = Field("temperature", ("T",), "ttol", 1.0), Field("other", ("o",), "otol", 0.5)
    assert [o.tolerance(f) for f in (DISPLACEMENT, PRESSURE, SALT[0], heat, other)] == [0.1, 1e-2, 0.3, 0.4, 0.5]


# two biphasic cubes, the upper one smaller, a solid one on top, whose upper face is a rigid plate's
_CUBES = {1: (0.0, 1.0, 0.0, 1.0), 2: (0.1, 0.9, 1.0, 2.0), 3: (0.1, 0.9, 2.0, 3.0), 4: (0.1, 0.9, 3.0, 3.5)}
_CORNERS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
_SOLID = '<material id="{}" name="{}" type="{}"><E>{}</E><v>0.2</v></material>'
_BIPHASIC = """<material id="{}" name="{}" type="biphasic"><phi0>0.2</phi0><fluid_density>0.3</fluid_density>
<solid type="neo-Hookean"><density>2</density><E>5</E><v>0.2</v></solid>
<permeability type="{}</permeability></material>"""


def _model(contact: str) -> str:
    """Every kind of condition that a biphasic model has, where it is asked for its unknowns' columns."""
    nodes, elements, tops = [], "", {}
    known: dict[tuple[float, ...], int] = {}
    for part, (a, b, low, high) in _CUBES.items():
        ids = []
        for x, y, z in _CORNERS:
            place = (a + (b - a) * x, a + (b - a) * y, low + (high - low) * z)
            key = (*place, float(part == 1))  # the lowest cube is apart
            if key not in known:
                known[key] = len(nodes) + 1
                nodes.append(f'<node id="{len(nodes) + 1}">{place[0]},{place[1]},{place[2]}</node>')
            ids.append(known[key])
        text = ",".join(map(str, ids))
        elements += f'<Elements type="hex8" name="p{part}"><elem id="{part}">{text}</elem></Elements>'
        tops[part] = ids
    one, two = tops[1], tops[2]
    held = "<Rx_dof>1</Rx_dof><Rw_dof>1</Rw_dof>" if contact.startswith("sliding") else ""
    facet = '<Surface name="{}"><quad4 id="1">{}</quad4></Surface>'

    def quad(ids: list[int], local: tuple[int, ...]) -> str:
        return ",".join(str(ids[k]) for k in local)

    return f"""<?xml version="1.0"?>
<febio_spec version="4.0">
<Module type="biphasic"/>
<Control><analysis>TRANSIENT</analysis><time_steps>2</time_steps><step_size>0.1</step_size>
<solver type="biphasic"><dtol>1e-10</dtol><ptol>1e-10</ptol><etol>0</etol><min_residual>1e-30</min_residual>
<max_refs>50</max_refs><qn_method type="full Newton"/></solver></Control>
<Globals><Constants/></Globals>
<Material>{_BIPHASIC.format(1, "low", 'perm-const-iso"><perm>0.1</perm>')}
{_BIPHASIC.format(2, "middle", 'perm-Holmes-Mow"><perm>0.1</perm><M>1</M><alpha>2</alpha>')}
{_SOLID.format(3, "dry", "neo-Hookean", 3)}
<material id="4" name="plate" type="rigid body"><density>1</density></material></Material>
<Mesh><Nodes name="all">{"".join(nodes)}</Nodes>{elements}
<NodeSet name="base">{",".join(map(str, one[:4]))}</NodeSet><NodeSet name="wet">{two[1]}</NodeSet>
<NodeSet name="side">{two[5]}</NodeSet>
{facet.format("below", quad(one, (4, 5, 6, 7)))}{facet.format("above", quad(two, (0, 3, 2, 1)))}
{facet.format("flank", quad(one, (0, 1, 5, 4)))}{facet.format("back", quad(two, (2, 3, 7, 6)))}
<SurfacePair name="pair"><primary>above</primary><secondary>below</secondary></SurfacePair>
<DiscreteSet name="pull"><delem>{one[6]},{two[6]}</delem></DiscreteSet>
</Mesh>
<MeshDomains><SolidDomain name="p1" mat="low"/><SolidDomain name="p2" mat="middle"/><SolidDomain name="p3" mat="dry"/>
<SolidDomain name="p4" mat="plate"/></MeshDomains>
<Boundary><bc node_set="base" type="zero displacement"><x_dof>1</x_dof><y_dof>1</y_dof><z_dof>1</z_dof></bc>
<bc node_set="base" type="zero fluid pressure"/>
<bc node_set="wet" type="prescribed fluid pressure"><value>0.05</value></bc>
<bc type="linear constraint"><node>{two[6]}</node><dof>x</dof><offset>0</offset>
<child_dof><node>{two[2]}</node><dof>y</dof><value>0.5</value></child_dof></bc></Boundary>
<Rigid><rigid_bc type="rigid_displacement"><rb>plate</rb><dof>z</dof><value>-0.05</value></rigid_bc>
<rigid_bc type="rigid_fixed"><rb>plate</rb><Ru_dof>1</Ru_dof><Rv_dof>1</Rv_dof><Ry_dof>1</Ry_dof>{held}</rigid_bc>
<rigid_load type="rigid_force"><rb>plate</rb><dof>Rx</dof><value>0.002</value></rigid_load></Rigid>
<Loads><surface_load surface="flank" type="normal_traction"><traction>-0.05</traction><effective>1</effective>
</surface_load>
<surface_load surface="back" type="fluidflux"><flux>0.002</flux><mixture>1</mixture></surface_load>
<nodal_load node_set="side" type="nodal_load"><dof>y</dof><scale>0.001</scale></nodal_load>
<nodal_load node_set="side" type="nodal fluidflux"><value>0.002</value></nodal_load>
<body_load type="body force"><force>0,0,0.05</force></body_load></Loads>
<Discrete><discrete_material id="1" type="linear spring"><E>0.3</E></discrete_material>
<discrete dmat="1" discrete_set="pull"/></Discrete>
<Contact><contact type="{contact}" surface_pair="pair"><penalty>20</penalty><pressure_penalty>5</pressure_penalty>
<search_tol>0.05</search_tol><search_radius>2</search_radius></contact></Contact>
</febio_spec>
"""


@pytest.mark.parametrize("contact", ["tied-biphasic", "sliding-biphasic"])
def test_answers_do_not_depend_on_columns(contact: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The pressure before the displacement, and fields of others between them."""
    path = tmp_path / "all.feb"
    path.write_text(_model(contact))
    model = febkit.read(path)

    def solve(fields: list[Field]) -> Any:
        monkeypatch.setattr(lower, "_layout", lambda model, blocks: Layout(fields))
        result = run(lower.lower(model), options=Options(threads=1))
        assert result.converged, result.reason
        return result.state

    plain = solve([DISPLACEMENT, PRESSURE])
    assert np.abs(plain.u[:, :2]).max() > 0.005 and np.abs(plain.p).max() > 0.01
    for fields in ([PRESSURE, DISPLACEMENT], [SALT[0], DISPLACEMENT, SALT[1], PRESSURE]):
        other = solve(fields)
        np.testing.assert_allclose(other.u, plain.u, atol=1e-9)
        np.testing.assert_allclose(other.p, plain.p, atol=1e-9)
        np.testing.assert_allclose(other.reaction, plain.reaction, atol=1e-9)
        np.testing.assert_allclose(other.extra["q"], plain.extra["q"], atol=1e-9)


def _tangent(fields: list[Field]) -> tuple[Any, Any]:
    """The tangent of a solid cube on a biphasic one, two planes of symmetry held, by (node, x y z p), and which
    unknowns are free."""
    X, conn = scenes.grid((1, 1, 2))
    solid, layout = NeoHookean(1.0, 0.3), Layout(fields)
    blocks = [
        Block("wet", "hex8", conn[:1], np.array([1]), solid, Biphasic(ConstIso(0.1))),
        Block("dry", "hex8", conn[1:], np.array([2]), solid),
    ]
    held = [Fixed(layout.column("xyz"[k]), np.flatnonzero(X[:, k] < 1e-9)) for k in (0, 2)]
    problem = Problem(X, blocks, [Step(analysis=TRANSIENT, conditions=held)], fields=layout)
    state = State.at_rest(problem)
    groups = [Group(b, X, 64, layout) for b in blocks]
    s = System(problem, problem.steps[0], groups, state, Schedule(groups, Team(1)))
    state.dt, order = 0.1, [layout.column(c) for c in "xyzp"]
    state.d[:, order] = 0.05 * np.random.default_rng(4).normal(size=(len(X), 4))
    s.update()
    A, _ = s.tangent(np.zeros(s.eqs.n))
    full = np.zeros((A.n, A.n))
    for r in range(A.n):
        full[r, A.indices[A.indptr[r] : A.indptr[r + 1]]] = A.data[A.indptr[r] : A.indptr[r + 1]]
    at = s.pattern.row[:, order].ravel()
    return (full + np.triu(full, 1).T)[np.ix_(at[at >= 0], at[at >= 0])], (at >= 0).reshape(-1, 4)


def test_the_tangent_where_a_solid_meets_a_fluid_on_a_plane_of_symmetry() -> None:
    """Nodes with as many free unknowns as the solid has components, but others (y, z and the pressure): as it is made
    where the unknowns of no node follow each other as the blocks have them."""
    (K, free), (other, same) = _tangent([DISPLACEMENT, PRESSURE]), _tangent([PRESSURE, DISPLACEMENT])
    assert (free == same).all() and (free[:, 1:].all(axis=1) & ~free[:, 0]).sum() >= 2
    np.testing.assert_allclose(K, other, atol=1e-14)
