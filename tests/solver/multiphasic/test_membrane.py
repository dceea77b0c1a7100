"""Membrane reactions: derivatives of rates and exchange against differences, and solutions in closed form."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import febkit
from febkit.lower import lower
from febkit.solver import membrane_rates, membrane_reactions
from febkit.solver.group import Group
from febkit.solver.multiphasic.sides import BACK, FRONT, Sides
from febkit.solver.multiphasic.solution import Solution
from febkit.solver.points import Points
from febkit.solver.schedule import Schedule
from febkit.solver.state import State
from febkit.solver.system import System
from febkit.solver.threads import Team
from helpers.mixture_deck import deck, material, refused, rod, solute, solve

RNG = np.random.default_rng(5)
N = 6
RATES = {
    "constant": membrane_rates.load("membrane constant reaction rate")(k=0.7),
    "gated": membrane_rates.load("membrane voltage-gated reaction rate")(a=0.4, b=1.6, c=0.3, d=0.2, sol=1),
    "channel": membrane_rates.load("membrane ion channel reaction rate")(g=2.0, sol=1, z=2.0, RT=1.3, Fc=0.9),
    "channels bound": membrane_rates.load("membrane ion channel reaction rate")(
        g=2.0, sol=1, sbm=0, z=-1.0, RT=1.3, Fc=0.9
    ),
}


def points() -> Points:
    F = np.tile(np.eye(3), (N, 1, 1)) + 0.1 * RNG.uniform(-1, 1, (N, 3, 3))
    return Points(F, np.linalg.det(F), np.zeros((N, 3)), np.zeros(N, int))


def solution(close: bool = False) -> Solution:
    """Two solutes and a bound molecule between faces with three solutes; ``close``: of about equal concentrations."""
    sol = Solution.at(
        np.zeros(2), RNG.uniform(0.5, 1.5, (N, 2)), np.full(N, 0.2), RNG.uniform(1, 2, (N, 1)), np.array([1.5])
    )
    sol.sides = Sides(RNG.uniform(0.5, 2.0, (N, 2, 3)), RNG.uniform(0.8, 1.2, N), np.full(N, 0.1))
    if close:
        sol.sides.c[:, BACK] = sol.sides.c[:, FRONT] * (1.0 + np.array([0, 1e-9, -1e-6, 3e-5, 2e-4, 1e-3]))[:, None]
    return sol


def difference(value: Any, array: np.ndarray, at: tuple[Any, ...], h: float = 1e-6) -> np.ndarray:
    """Central difference of value() by the entries ``at`` of an array."""
    array[at] += h
    up = value()
    array[at] -= 2 * h
    down = value()
    array[at] += h
    return np.asarray((up - down) / (2 * h))


@pytest.mark.parametrize("close", [False, True], ids=["apart", "close"])
@pytest.mark.parametrize("name", RATES)
def test_rates_have_their_derivatives(name: str, close: bool) -> None:
    law, pts, sol = RATES[name], points(), solution(close)
    assert sol.sides is not None
    slopes = law.by_sides(pts, sol)
    for side in (FRONT, BACK):
        for k in range(3):
            true = difference(lambda: law.rate(pts, sol) * np.ones(N), sol.sides.c, (slice(None), side, k))
            np.testing.assert_allclose(0.0 if slopes is None else slopes[:, side, k], true, rtol=1e-6, atol=1e-8)


def test_channels_carry_the_current_of_their_conductance() -> None:
    """k (c_i - c_e) = R T g / (z Fc)^2 ln(c_i / c_e): g times the Nernst potential, as moles."""
    law, sol = RATES["channel"], solution()
    assert sol.sides is not None
    e, i = sol.sides.c[:, FRONT, 1], sol.sides.c[:, BACK, 1]
    nernst = 1.3 / (2.0 * 0.9) * np.log(i / e)
    np.testing.assert_allclose(law.rate(points(), sol) * (i - e), 2.0 * nernst / (2.0 * 0.9), rtol=1e-12)


OUTSIDE = np.array([[1, 0, 2], [0, 1, 0]], float)
REACTIONS = {
    "forward": ("membrane-mass-action-forward", (1, 0, 0)),
    "reversible": ("membrane-mass-action-reversible", (1, 0, 2)),
}


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("name", REACTIONS)
def test_reactions_have_their_derivatives(name: str, rate: str) -> None:
    kind, v = REACTIONS[name]
    rates = [RATES[rate]] * (2 if "reversible" in kind else 1)
    r = membrane_reactions.load(kind)(
        np.array(v, float), np.array([0, 1, 1.0]), 0.0, *rates,
        reactants_outside=OUTSIDE, products_outside=OUTSIDE[::-1].copy(), charges=np.zeros(3),
    )  # fmt: skip
    pts, sol = points(), solution()
    assert sol.sides is not None
    slopes = r.by_sides(pts, sol)
    for side in (FRONT, BACK):
        for k in range(3):
            true = difference(lambda: r.supply(pts, sol), sol.sides.c, (slice(None), side, k))
            np.testing.assert_allclose(slopes[:, side, k], true, rtol=1e-6, atol=1e-7)
    for k in range(2):  # kappa = 1: actual concentrations are effective ones
        true = difference(lambda: r.supply(pts, sol), sol.ca, (slice(None), k))
        np.testing.assert_allclose(r.by_concentration(pts, sol)[:, k], true, rtol=1e-6, atol=1e-7)


# ---- decks: two boxes of fluid with a membrane between ---------------------------------------------------------------
def boxes(reaction: str, inside: str = "Glc", bound: str = "", h: float = 0.1, dissolved: str = "Na Cl Glc") -> str:
    """Two held rods of one element, on either side of a shell; glucose 2 behind (z < 1) and 5 in front."""
    mesh, _ = rod(2, 2.0)
    first, last = mesh.split('<elem id="2">')
    mesh = first + '</Elements><Elements type="hex8" name="q"><elem id="2">' + last
    mesh += '<Elements type="quad4" name="S"><elem id="3">5,6,7,8</elem></Elements>'
    mesh += '<NodeSet name="below">1,2,3,4</NodeSet><NodeSet name="above">5,6,7,8,9,10,11,12</NodeSet>'
    both = "".join(solute(s, 50.0) for s in dissolved.split())
    within = "".join(solute(s, 1e-9) for s in inside.split())
    made = material("multiphasic", both) + material("multiphasic", within, bound + reaction).replace(
        'id="1" name="m"', 'id="2" name="s"'
    ).replace("<perm>1<", "<perm>1e-9<")
    fixed = '<x_dof>1</x_dof><y_dof>1</y_dof><z_dof>1</z_dof></bc>'
    held = '<bc type="zero displacement" node_set="all">' + fixed
    held += '<bc type="zero shell displacement" node_set="all">' + fixed.replace("x_", "sx_").replace(
        "y_", "sy_").replace("z_", "sz_")  # fmt: skip
    held += '<bc type="zero fluid pressure" node_set="all"/><bc type="fix" node_set="all"><dofs>q</dofs></bc>'
    start = "".join(
        f'<ic type="initial {kind}concentration" node_set="{where}"><dof>{dof}</dof><value>{value}</value></ic>'
        for where, kind, letter, glucose in (("below", "", "c", 2), ("above", "", "c", 5), ("above", "shell ", "d", 2))
        for dof, value in ((f"{letter}1", 10), (f"{letter}2", 10), (f"{letter}3", glucose))
        if dof[1] == "3" or "Na" in dissolved
    )
    domains = (
        '<SolidDomain name="p" mat="m"/><SolidDomain name="q" mat="m"/>'
        f'<ShellDomain name="S" mat="s"><shell_thickness>{h}</shell_thickness></ShellDomain>'
    )
    return deck(made, held, start, steps=(8, 0.25), mesh=mesh, domains=domains)


def membrane(rates: list[tuple[str, str]], **species: str) -> str:
    """A reaction; species: vRe="Glc" and the like."""
    kind = "reversible" if len(rates) > 1 else "forward"
    each = "".join(
        f'<{tag} species="{s}"><{tag}>1</{tag}></{tag}>' for tag, names in species.items() for s in names.split()
    )
    law = "".join(
        f'<{which}_rate type="membrane {name} reaction rate">{body}</{which}_rate>'
        for which, (name, body) in zip(("forward", "reverse"), rates)
    )
    return f'<membrane_reaction type="membrane-mass-action-{kind}">{each}<Vbar>0</Vbar>{law}</membrane_reaction>'


CONST = [("constant", "<k>0.3</k>")]
BOTH = [("constant", "<k>0.3</k>"), ("constant", "<k>0.1</k>")]
CHANNEL = [("ion channel", "<g>1e-7</g><sol>1</sol>")] * 2
GATED = [("voltage-gated", "<a>1</a><b>2</b><c>0.1</c><d>0.2</d><sol>Na</sol>")] * 2
BOUND = '<solid_bound sbm="CS"><rho0>60</rho0></solid_bound>'
DECKS = {
    "forward": boxes(membrane(CONST, vRe="Glc", vPi="Glc")),
    "backward": boxes(membrane(CONST, vRi="Glc", vPe="Glc")),
    "reversible": boxes(membrane(BOTH, vRe="Glc", vPi="Glc")),
    "salt": boxes(membrane(BOTH, vRe="Na Cl", vPi="Na Cl")),
    "channel": boxes(membrane(CHANNEL, vRi="Na", vPe="Na")),
    "gated": boxes(membrane(GATED, vRi="Na", vPe="Na")),
    "from within": boxes(membrane(BOTH, vR="Glc", vPi="Glc")),
    "into a shell without": boxes(membrane(BOTH, vRe="Glc", vPi="Glc"), inside="Na Cl"),
    "by channels": boxes(membrane(
        [("ion channel", "<g>1e-7</g><sol>1</sol><sbm>CS</sbm>")] * 2, vRi="Na", vPe="Na", vR="CS", vP="CS"
    ), bound=BOUND),
}  # fmt: skip


def system(text: str, folder: Path) -> System:
    (folder / "m.feb").write_text(text)
    p = lower(febkit.read(folder / "m.feb"))
    groups = [Group(b, p.X, layout=p.layout) for b in p.blocks]
    state = State.at_rest(p)
    for c in (*p.common.initial, *p.steps[0].initial):
        state.d[c.nodes, c.column] = c.value(0.0, p.X[c.nodes], np.arange(len(c.nodes)))
    p.steps[0].conditions, p.common.conditions = [], []  # all unknowns are free
    s = System(p, p.steps[0], groups, state, Schedule(groups, Team(1)))
    for a in s.acting:
        a.begin(state, groups)
    state.time = state.dt = 0.25
    s.update()
    for g in groups:
        g.begin_step(state)
    return s


@pytest.mark.parametrize("name", DECKS)
def test_the_tangent_is_the_derivative(name: str, tmp_path: Path) -> None:
    """By pressures and concentrations; that of the exchange by displacements too (the mixture's own is FEBio's)."""
    s = system(DECKS[name], tmp_path)
    state = s.state
    u = state.layout.displacement
    state.d += 0.1 * RNG.uniform(-1, 1, state.d.shape) * np.where(np.isin(range(state.d.shape[1]), u), 0.1, 1.0)
    s.update()

    def force() -> np.ndarray:
        s.update()
        return s.residual()

    A, _ = s.tangent(np.zeros(s.eqs.n))
    K = np.zeros((A.n, A.n))
    np.add.at(K, (np.repeat(np.arange(A.n), np.diff(A.indptr)), A.indices), A.data)
    check(s, K, force, [c for c in range(state.d.shape[1]) if c not in u], slice(None))
    (flux,) = s.loads
    K[:] = 0.0
    for part, nodes, columns in flux.stiffness(state):
        for k, row in zip(part, nodes, strict=True):
            at = s.eqs.eq[row, columns]
            keep = np.flatnonzero(at >= 0)
            K[np.ix_(at[keep], at[keep])] += k[np.ix_(keep, keep)]

    def exchange() -> np.ndarray:
        s.update()
        out = np.zeros_like(state.d)
        flux.residual(state, out)
        return s.gather(out)

    rows = np.flatnonzero(exchange())
    assert len(rows)
    check(s, K, exchange, list(u), rows)


def check(s: System, K: np.ndarray, force: Any, columns: list[int], rows: Any) -> None:
    """Columns of K against minus the differences of a force, at the nodes of the shell."""
    shell = np.unique(next(g.conn for g in s.groups if g.shell))
    size = np.abs(K[rows]).max()
    for node in shell:
        for c in columns:
            eq = s.eqs.eq[node, c]
            if eq >= 0:
                true = -difference(force, s.state.d, (node, c))
                np.testing.assert_allclose(K[rows, eq], true[rows], atol=2e-6 * size)


# ---- solutions -----------------------------------------------------------------------------------------------------
def moles(ds: Any, name: str, thickness: float) -> np.ndarray:
    """Moles of a solute in the box behind, the box in front and the shell (time, 3), the porosity being 0.8."""
    volume = np.array([1.0 - thickness, 1.0, thickness])
    return np.asarray(0.8 * ds["solute_concentration"].sel(solute=name).values * volume)


@pytest.mark.parametrize(("rates", "inward", "kF", "kR"), [
    (CONST, True, 0.3, 0.0), (CONST, False, 0.3, 0.0), (BOTH, True, 0.3, 0.1),
])  # fmt: skip
def test_a_thin_membrane_between_two_boxes(
    rates: list[tuple[str, str]], inward: bool, kF: float, kR: float, tmp_path: Path
) -> None:  # fmt: skip
    """Backward Euler of dn_front/dt = -kF c_front + kR c_behind, or the other way round, in well mixed boxes."""
    h, dt = 1e-4, 0.25
    names = {"vRe": "Glc", "vPi": "Glc"} if inward else {"vRi": "Glc", "vPe": "Glc"}
    out = moles(solve(boxes(membrane(rates, **names), h=h, dissolved="Glc"), tmp_path), "Glc", h)
    np.testing.assert_allclose(out.sum(axis=1), out[0].sum(), rtol=1e-6)
    n = out[0, :2].copy()  # behind, in front
    A = np.array([[-kR, kF], [kR, -kF]]) if inward else np.array([[-kF, kR], [kF, -kR]])
    step = np.linalg.inv(np.eye(2) - dt * A / (0.8 * np.array([1.0 - h, 1.0])))
    for now in out[1:, :2]:
        n = step @ n
        np.testing.assert_allclose(now, n, rtol=2e-3)
    assert abs(out[-1, 0] - out[0, 0]) > 0.3


BAD = {
    "makes a net charge of +1": membrane(CONST, vRe="Glc", vPi="Glc Na"),
    'no mixture in front of it has the solute "Glc"': None,
    '"CS" is bound to the solid': membrane(CONST, vRe="CS", vPi="Glc"),
    'the solute "Glc" is no ion': membrane([("ion channel", "<g>1</g><sol>Glc</sol>")], vRi="Glc", vPe="Glc"),
    "must not be negative": membrane(CONST, vRe="Glc", vPi="Glc").replace("<vPi>1<", "<vPi>-1<"),
    'lacks <sol>': membrane([("voltage-gated", "<a>1</a>")], vRi="Na", vPe="Na"),
    "must be at least 0": membrane([("ion channel", "<g>-1</g><sol>1</sol>")], vRi="Na", vPe="Na"),
    "has membrane reactions but no shells": None,
}  # fmt: skip


@pytest.mark.parametrize("said", BAD)
def test_what_membranes_are_not(said: str, tmp_path: Path) -> None:
    reaction = BAD[said]
    if "in front" in said:
        text = boxes(membrane(CONST, vRe="Glc", vPi="Glc"))
        text = text.replace('<SolidDomain name="q" mat="m"/>', '<SolidDomain name="q" mat="t"/>')
        salt = material("multiphasic", solute("Na") + solute("Cl")).replace('id="1" name="m"', 'id="3" name="t"')
        text = text.replace("</Material>", salt + "</Material>")
    elif reaction is None:
        text = boxes(membrane(CONST, vRe="Glc", vPi="Glc")).replace("<ShellDomain", "<SolidDomain").replace(
            "</ShellDomain>", "</SolidDomain>").replace('"q" mat="m"', '"q" mat="s"')  # fmt: skip
        text = text.replace('<SolidDomain name="S" mat="s"><shell_thickness>0.1</shell_thickness></SolidDomain>', "")
        text = text.replace('<Elements type="quad4" name="S"><elem id="3">5,6,7,8</elem></Elements>', "")
    else:
        text = boxes(reaction)
    message = refused(text, tmp_path)
    assert said in message and "m.feb:" in message
