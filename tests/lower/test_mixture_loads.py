"""Loads and conditions of mixtures that depend on what is dissolved, through the installed command."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from helpers.mixture_deck import HELD, R, T, deck, initial, material, prescribed, refused, rod, solute, solve

N = 8
GLUCOSE = material("multiphasic", solute("Glc"))
FACES = (
    '<Surface name="in"><quad4 id="1">1,4,3,2</quad4></Surface>'
    f'<Surface name="out"><quad4 id="1">{",".join(str(4 * N + i) for i in (1, 2, 3, 4))}</quad4></Surface>'
)


def actual(surface: str, pressure: float) -> str:
    return f'<bc type="actual fluid pressure" surface="{surface}"><pressure lc="1">{pressure!r}</pressure></bc>'


def natural(more: str = "<update>0</update>") -> str:
    load = f'<surface_load type="solute natural flux" surface="out"><solute_id>Glc</solute_id>{more}</surface_load>'
    return f"<Loads>{load}</Loads>"


RAMP = """<LoadData><load_controller id="1" type="loadcurve"><interpolate>LINEAR</interpolate><points><pt>0,0</pt>
<pt>4,1</pt></points></load_controller></LoadData>"""


def driven(more: str, ctol: float = 1e-7) -> str:
    """Fluid driven through a held rod by an actual pressure of 0.7, with solute at 1 where it enters."""
    boundary = HELD + prescribed("concentration", "start", 1.0, "c3") + actual("in", 0.7) + actual("out", 0.0)
    made = deck(
        GLUCOSE, boundary, initial("c3", 0.5), mesh=rod(N, 1.0)[0] + FACES, more=more + RAMP, steps=(40, 0.25),
        solver="<lstol>0</lstol>",
    )  # fmt: skip
    return made.replace("<ctol>1e-8<", f"<ctol>{ctol}<")


def test_solute_is_carried_out_by_its_natural_flux(tmp_path: Path) -> None:
    """With the fluid's solute leaving as it comes the concentration is the same everywhere; else it piles up."""
    free, closed = (solve(driven(more, 1e-3), tmp_path).isel(time=-1) for more in (natural(), ""))
    c = free["effective_solute_concentration"].sel(solute="Glc").values
    assert c == pytest.approx(1.0, rel=2e-3)
    assert closed["effective_solute_concentration"].sel(solute="Glc").values[-4:].min() > 1.5


def test_body_loads_pass_over_mixtures_as_in_febio(tmp_path: Path) -> None:
    heavy = GLUCOSE.replace("<phi0>", "<fluid_density>2</fluid_density><phi0>")
    force = '<Loads><body_load type="body force"><force>0,0,0.5</force></body_load></Loads>'
    foot = '<bc type="zero displacement" node_set="start"><x_dof>1</x_dof><y_dof>1</y_dof><z_dof>1</z_dof></bc>'
    last = solve(deck(heavy, foot, steps=(2, 0.5), more=force), tmp_path).isel(time=-1)
    assert float(np.abs(last["displacement"]).max()) == 0.0


@pytest.mark.parametrize("osmcoef", [1.0, 0.9])
def test_actual_pressures_follow_the_concentrations(osmcoef: float, tmp_path: Path) -> None:
    text = driven("").replace("<osmcoef>1<", f"<osmcoef>{osmcoef}<")
    last = solve(text, tmp_path).isel(time=-1)
    c = last["effective_solute_concentration"].sel(solute="Glc").values
    p = last["effective_fluid_pressure"].values
    assert c[-1] > 1.2
    assert p[-4:] == pytest.approx(-osmcoef * R * T * c[-4:], rel=1e-5)
    assert p[:4] == pytest.approx(0.7 - osmcoef * R * T * 1.0, rel=1e-6)


def test_a_bath_of_the_tissue_s_osmotic_coefficient(tmp_path: Path) -> None:
    bath = (
        '<bc type="matching_osm_coef" surface="out"><ambient_pressure>0.3</ambient_pressure>'
        "<ambient_osmolarity>50</ambient_osmolarity></bc>"
    )
    boundary = HELD + prescribed("concentration", "start", 1.0, "c3") + bath
    text = deck(GLUCOSE.replace("<osmcoef>1<", "<osmcoef>0.8<"), boundary, mesh=rod(N, 1.0)[0] + FACES)
    p = solve(text, tmp_path)["effective_fluid_pressure"].isel(time=-1).values
    assert p[-4:] == pytest.approx(0.3 - 0.8 * R * T * 50.0, rel=1e-6)


def test_the_load_fluid_pressure_is_febios(tmp_path: Path) -> None:
    """It takes the whole parts of R and T, here 1 and 3."""
    load = '<surface_load type="fluid pressure" surface="{}"><pressure{}</pressure></surface_load>'
    loads = "<Loads>" + load.format("in", ' lc="1">0.7') + load.format("out", ">0") + "</Loads>"
    text = driven(loads).replace(actual("in", 0.7), "").replace(actual("out", 0.0), "")
    text = text.replace("<osmcoef>1<", "<osmcoef>0.9<").replace(f"<T>{T}</T><R>{R}</R>", "<T>3.5</T><R>1.25</R>")
    last = solve(text, tmp_path).isel(time=-1)
    p, c = last["effective_fluid_pressure"].values, last["effective_solute_concentration"].sel(solute="Glc").values
    np.testing.assert_allclose([p[0], p[-1], c[-1]], [-2.0391326, -3.3456643, 1.2568377], rtol=1e-5)


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (natural("<update>1</update>"), "<update>"),
        (natural("").replace("Glc", "Na"), "no solid with this solute"),
        (natural("").replace("Glc", "K"), 'no solute "K"'),
    ],
)
def test_what_a_natural_flux_lacks_is_said(more: str, said: str, tmp_path: Path) -> None:
    assert said in refused(driven(more), tmp_path)


def test_a_surface_without_elements_is_said(tmp_path: Path) -> None:
    text = driven("").replace('<quad4 id="1">1,4,3,2</quad4>', '<quad4 id="1">1,4,3,6</quad4>')
    assert "no element is behind facet 1" in refused(text, tmp_path)


def test_a_retry_starts_from_the_pressures_of_the_try_that_failed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """FEBio 4.11 gives a failed step's state back but for those; its retries take iterations by them."""
    import febkit
    from febkit.solver.newton import Counts, Newton, NotConverged, Strategy

    step, left, tries = Newton.step, [], []

    def failing(self: Newton, how: Strategy) -> Counts:
        (condition, *_) = self.system.following
        at = condition.nodes, condition.column
        if left:
            tries.append((self.system.targets(self.system.state.time)[at], self.system.state.d[at]))
        counts = step(self, how)
        if not left:
            left.append(np.array(condition.last))
            raise NotConverged("for the test")
        return counts

    monkeypatch.setattr(Newton, "step", failing)
    text = driven(natural()).replace("</solver>", "</solver><time_stepper><dtmax>0.25</dtmax></time_stepper>")
    (tmp_path / "m.feb").write_text(text.replace("<time_steps>40", "<time_steps>2"))
    assert febkit.read(tmp_path / "m.feb").solve(threads=1).totals.retries == 1
    wanted, had = tries[0]
    np.testing.assert_array_equal(wanted, left[0])
    assert np.abs(had - wanted).min() > 1e-4


def test_the_tangent_of_a_natural_flux(tmp_path: Path) -> None:
    """Against differences, with what is carried held, as FEBio does: by concentrations, and by nodes that are not on
    the facet."""
    from febkit.solver import loads, physics
    from febkit.solver.group import Group
    from febkit.solver.loads.base import Patch
    from febkit.solver.problem import Block, Problem, Step
    from febkit.solver.solids.registry import load
    from febkit.solver.state import State
    from helpers.mixture_element import mixture
    from helpers.mixture_element import solute as record

    rng = np.random.default_rng(5)
    X = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1.0]])
    X = X + 0.1 * rng.uniform(-1, 1, X.shape)
    mix = mixture((record(0, 0),), model_solutes=1)
    block = Block("b", "hex8", np.arange(8)[None], np.array([1]), load("solid", "neo-Hookean")(E=2.0, v=0.2),
                  physics.load("multiphasic")(mix))  # fmt: skip
    g = Group(block, X)
    state = State.at_rest(Problem(X, [block], [Step()]))
    state.dt = 0.7
    g.physics.at.w[:], g.physics.at.ca[:] = [0.3, -0.2, 0.5], 0.5
    on = np.array([[4, 5, 6, 7]])
    flux = loads.load("solute natural flux")((Patch.of("quad4", on, X),), solute=1, owner=(np.array([[0, 0]]),))
    flux.begin(state, [g])
    d0 = 0.1 * rng.uniform(-1, 1, (8, 5))
    d0[:, 4] += 0.6

    def forces(d: np.ndarray) -> np.ndarray:
        state.d[:] = d
        g.deform(np.ascontiguousarray(d[:, :3]), g.F, g.J)
        out = np.zeros_like(d)
        flux.residual(state, out)
        return out.ravel()

    forces(d0)
    K = np.zeros((40, 40))
    for k, nodes, columns in flux.stiffness(state):
        at = nodes[0] * 5 + columns
        np.add.at(K, (at[:, None], at[None]), k[0])
    h = 1e-6
    for j in range(40):
        node, column = divmod(j, 5)
        if column == 3 or (column < 3 and node >= 4):
            continue
        step = np.zeros(40)
        step[j] = h
        D = -(forces(d0 + step.reshape(8, 5)) - forces(d0 - step.reshape(8, 5))) / (2 * h)
        assert K[:, j] == pytest.approx(D, rel=1e-6, abs=1e-10)
        assert np.abs(D).max() > 1e-6


def injected(steps: int) -> str:
    """A closed rod into which glucose, the third solute, is given at the four nodes of its start."""
    load = '<nodal_load type="nodal_load" node_set="start"><dof>c3</dof><scale>-0.02</scale></nodal_load>'
    held = HELD + '<bc type="zero fluid pressure" node_set="all"/>'
    return deck(GLUCOSE, held, initial("c3", 1.0), n=4, steps=(steps, 1.0 / steps), more=f"<Loads>{load}</Loads>")


def given(text: str, folder: Path) -> float:
    """Moles that came into the unit cube, four fifths of which are fluid."""
    last = solve(text, folder).isel(time=-1)
    return 0.8 * (float(last["solute_concentration"].sel(solute="Glc").mean()) - 1.0)


@pytest.mark.parametrize("steps", [2, 4])
def test_nodal_loads_on_concentrations(steps: int, tmp_path: Path) -> None:
    """FEBio 4.11 takes one on c1 as moles per time, those on other concentrations as moles in each step."""
    text = injected(steps)
    assert given(text, tmp_path) == pytest.approx(0.08 * steps, rel=1e-5)
    first = text.replace('id="1" name="Na"', 'id="0" name="Na"').replace('id="3" name="Glc"', 'id="1" name="Glc"')
    first = first.replace('id="0" name="Na"', 'id="3" name="Na"').replace("c3", "c1")
    assert given(first, tmp_path) == pytest.approx(0.08, rel=1e-5)
