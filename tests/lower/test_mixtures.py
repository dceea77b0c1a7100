"""Models with solutes through the front door: known answers, and what is said of bad ones."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest

from helpers.forked import febkit
from helpers.mixture_deck import (
    FC,
    HELD,
    SYMMETRY,
    R,
    T,
    deck,
    initial,
    material,
    prescribed,
    refused,
    solute,
    solve,
)


# ---- known answers --------------------------------------------------------------------------------------
@pytest.mark.parametrize("kind", ["triphasic", "multiphasic"])
def test_donnan_swelling(kind: str, tmp_path: Path) -> None:
    """A charged cube in a salt bath swells until its solid bears R T (sqrt(cF^2 + 4 c0^2) - 2 c0)."""
    c0, charge, E = 0.15, -0.3, 1e-3
    bath = prescribed("fluid pressure", "all", -2 * R * T * c0)
    bath += prescribed("concentration", "all", c0, "c1") + prescribed("concentration", "all", c0, "Cl")
    more = f"<fixed_charge_density>{charge}</fixed_charge_density>"
    ds = solve(
        deck(
            material(kind, solute("Na") + solute("Cl"), more, E), SYMMETRY + bath,
            initial("c1", c0) + initial("c2", c0),
            analysis="STEADY-STATE", steps=(4, 0.25),
        ), tmp_path,
    )  # fmt: skip

    def unbalanced(stretch: float) -> float:
        J = stretch**3
        cF = charge * 0.8 / (J - 0.2)
        return 0.5 * E * (stretch**2 - 1) / J - R * T * (math.hypot(cF, 2 * c0) - 2 * c0)

    lo, hi = 1.0, 2.0
    for _ in range(80):
        mid = 0.5 * (lo + hi)
        lo, hi = (mid, hi) if unbalanced(mid) < 0 else (lo, mid)
    assert lo > 1.05
    last = ds.isel(time=-1)
    assert float(last["displacement"].max()) == pytest.approx(lo - 1.0, rel=1e-5)
    cF = charge * 0.8 / (lo**3 - 0.2)
    assert float(last["fixed_charge_density"].mean()) == pytest.approx(cF, rel=1e-5)
    zeta = (-cF + math.hypot(cF, 2 * c0)) / (2 * c0)
    assert float(last["electric_potential"].mean()) == pytest.approx(-R * T / FC * math.log(zeta), rel=1e-5)
    inside = last["solute_concentration"].mean("element")
    assert inside.sel(solute="Na").item() == pytest.approx(c0 * zeta, rel=1e-5)
    assert inside.sel(solute="Cl").item() == pytest.approx(c0 / zeta, rel=1e-5)
    assert inside.sel(solute="Glc").item() == 0.0  # not in this material


def _slab(n: int, count: int, folder: Path) -> float:
    """Error of the concentration at the closed end of a slab, relative to that of its bath."""
    D, end, L = 0.3, 0.4, 1.0
    text = deck(
        material("biphasic-solute", solute("Glc", D)), HELD + prescribed("concentration", "start", 1.0, "c3"), n=n,
        length=L, steps=(count, end / count), module="solute", constants=f"<T>{T}</T><R>1e-20</R>",
    )  # fmt: skip
    c = solve(text, folder)["effective_solute_concentration"].isel(time=-1).sel(solute="Glc").values[-1]
    terms = [
        (-1) ** k / (2 * k + 1) * math.exp(-(((2 * k + 1) * math.pi / 2) ** 2) * D * end / L**2) for k in range(20)
    ]
    return float(abs(c - (1 - 4 / math.pi * sum(terms))))


def test_diffusion_into_a_slab_converges(tmp_path: Path) -> None:
    """Second order in space, first in time: elements halved and steps quartered leave a quarter of the error."""
    coarse, fine = _slab(4, 8, tmp_path), _slab(8, 32, tmp_path)
    assert 1e-4 < coarse < 0.05
    assert coarse / fine == pytest.approx(4.0, rel=0.1)


def test_first_order_decay_is_backward_euler_s(tmp_path: Path) -> None:
    k, c0, n, dt = 0.7, 0.4, 5, 0.2
    reaction = f"""<reaction type="mass-action-forward"><Vbar>0</Vbar>
<forward_rate type="constant reaction rate"><k>{k}</k></forward_rate><vR species="Glc"><vR>1</vR></vR></reaction>"""
    text = deck(
        material("multiphasic", solute("Glc"), reaction), HELD, initial("c3", c0), steps=(n, dt),
    )  # fmt: skip
    ds = solve(text, tmp_path)
    c = ds["solute_concentration"].sel(solute="Glc").isel(element=0).values[-n:]
    assert c == pytest.approx(c0 / (1 + k * dt) ** np.arange(1, n + 1), rel=1e-6)


def test_a_reaction_that_binds_a_solute_builds_up_solid(tmp_path: Path) -> None:
    """The density of what is bound is the trapezoidal sum of the molar supply times (1 - phi0) M."""
    k, c0, n, dt, M = 0.7, 0.4, 5, 0.2, 500.0
    reaction = f"""<solid_bound sbm="CS"><rho0>1</rho0></solid_bound><reaction type="mass-action-forward"><Vbar>0</Vbar>
<forward_rate type="constant reaction rate"><k>{k}</k></forward_rate><vR species="Glc"><vR>1</vR></vR>
<vP species="CS"><vP>1</vP></vP></reaction>"""
    ds = solve(deck(material("multiphasic", solute("Glc"), reaction), HELD, initial("c3", c0), steps=(n, dt)), tmp_path)
    c = np.concatenate([[0.0], c0 / (1 + k * dt) ** np.arange(1, n + 1)])  # FEBio takes the first rate at no solute
    rates = 0.8 * M * k * c
    expected = 1.0 + np.cumsum(0.5 * dt * (rates[1:] + rates[:-1]))
    rho = ds["sbm_referential_apparent_density"].sel(solid_bound="CS").isel(element=0).values[-n:]
    assert rho == pytest.approx(expected, rel=1e-5)


def test_concentrations_stay_positive_where_asked(tmp_path: Path) -> None:
    """A reaction that takes what is not there drives the concentration below zero unless the file says otherwise."""
    reaction = """<reaction type="concentration-independent"><Vbar>0</Vbar>
<forward_rate type="constant reaction rate"><k>1</k></forward_rate><vR species="Glc"><vR>1</vR></vR></reaction>"""
    made = material("multiphasic", solute("Glc"), reaction)
    free = "<force_positive_concentrations>0</force_positive_concentrations>"
    ds = solve(deck(made, HELD, initial("c3", 0.1), steps=(1, 0.5), solver=free), tmp_path)
    c = ds["effective_solute_concentration"].sel(solute="Glc").isel(time=-1)
    assert float(c.min()) == pytest.approx(0.1 - 0.5, rel=1e-6)


# ---- bad models -----------------------------------------------------------------------------------------
NEUTRAL = solute("Glc")
BAD = {
    "unknown solute": (material("multiphasic", solute("K")), 'there is no solute "K"'),
    "twice": (material("multiphasic", NEUTRAL + NEUTRAL), 'the solute "Glc" is there twice'),
    "one ion": (material("triphasic", solute("Na")), "+1 and -1, not [1]"),
    "two solutes": (material("biphasic-solute", NEUTRAL + solute("Na")), "takes one <solute>, not 2"),
    "charge": (
        material("multiphasic", NEUTRAL + solute("Na"), """<reaction type="mass-action-forward">
<forward_rate type="constant reaction rate"><k>1</k></forward_rate><vR species="Glc"><vR>1</vR></vR>
<vP species="Na"><vP>1</vP></vP></reaction>"""), "net charge of +1",
    ),
    "foreign species": (
        material("multiphasic", NEUTRAL, """<reaction type="mass-action-forward">
<forward_rate type="constant reaction rate"><k>1</k></forward_rate><vR species="CS"><vR>1</vR></vR></reaction>"""),
        '"CS" is not in',
    ),
    "membrane": (
        material("multiphasic", NEUTRAL, '<membrane_reaction type="membrane-mass-action-forward"/>'),
        "membrane_reaction",
    ),
    "diffusivity": (
        material("multiphasic", NEUTRAL.replace("<free_diff>1.0</free_diff>", "<free_diff>0.5</free_diff>")),
        "free_diff (0.5) must not be less than diff (1)",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD)
def test_bad_materials_are_named(name: str, tmp_path: Path) -> None:
    made_of, said = BAD[name]
    message = refused(deck(made_of, HELD), tmp_path)
    assert said in message
    assert "m.feb:" in message


def test_constants_are_asked_for(tmp_path: Path) -> None:
    text = deck(material("multiphasic", NEUTRAL), HELD, constants="<T>300</T>")
    assert "needs a positive <R>" in refused(text, tmp_path)
    ions = material("multiphasic", solute("Na") + solute("Cl"))
    assert "needs a positive <Fc>" in refused(deck(ions, HELD, constants="<T>300</T><R>1</R>"), tmp_path)


def test_a_concentration_that_is_not_there(tmp_path: Path) -> None:
    text = deck(material("multiphasic", NEUTRAL), HELD + prescribed("concentration", "start", 1.0, "c7"))
    assert "c7" in refused(text, tmp_path)


@pytest.mark.parametrize("option", ["--accuracy=0.01", "--stabilise"])
def test_steps_of_second_order_and_projection_by_the_command_line(option: str, tmp_path: Path) -> None:
    text = deck(material("biphasic-solute", solute("Na")), HELD, "", steps=(2, 0.5))
    (tmp_path / "mixture.feb").write_text(text)
    done = febkit("run", option, "mixture.feb", folder=tmp_path)
    assert done.returncode == 0, done.stderr


def test_steps_of_second_order_are_refused_at_rest(tmp_path: Path) -> None:
    text = deck(material("biphasic-solute", solute("Na")), HELD, "", steps=(2, 0.5))
    (tmp_path / "mixture.feb").write_text(text.replace("TRANSIENT", "STEADY-STATE"))
    done = febkit("run", "--accuracy=0.01", "mixture.feb", folder=tmp_path)
    assert done.returncode == 2 and "transient analyses" in done.stderr and "Traceback" not in done.stderr, done.stderr
    assert not (tmp_path / "mixture.xplt").exists()


def test_a_solute_has_the_degree_of_freedom_of_its_id(tmp_path: Path) -> None:
    """As in FEBio, whatever the order in the file; its answers for this model."""
    held = HELD + prescribed("concentration", "start", 1.0, "c1")
    text = deck(material("multiphasic", solute("Glc") + solute("Ure", 3.0)), held, steps=(3, 1.0), n=4)
    text = re.sub("<Solutes>.*?</Solutes>", "<Solutes>" + "".join(
        f'<solute id="{i}" name="{n}"><molar_mass>180</molar_mass></solute>' for i, n in ((2, "Glc"), (1, "Ure"))
    ) + "</Solutes>", text, flags=re.DOTALL)  # fmt: skip
    c = solve(text, tmp_path).isel(time=-1)["solute_concentration"]
    assert c.sel(solute="Ure").values == pytest.approx([0.9996, 0.99885, 0.99829, 0.99798], abs=1e-5)
    assert (c.sel(solute="Glc").values == 0).all()
    wrong = text.replace('id="2" name="Glc"', 'id="3" name="Glc"')
    assert "ids of 2 solutes must be 1 to 2, not 3, 1" in refused(wrong, tmp_path)
