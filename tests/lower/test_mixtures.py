"""Models with solutes through the front door: known answers, and what is said of bad ones."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from helpers.command import febkit

R, T, FC = 8.314e-6, 310.0, 96.485e-6
SOLUTES = """<solute id="1" name="Na"><charge_number>1</charge_number><molar_mass>23</molar_mass></solute>
<solute id="2" name="Cl"><charge_number>-1</charge_number><molar_mass>35</molar_mass></solute>
<solute id="3" name="Glc"><charge_number>0</charge_number><molar_mass>180</molar_mass></solute>"""
BOUND = """<solid_bound id="1" name="CS"><charge_number>0</charge_number><molar_mass>500</molar_mass>
<density>1e9</density></solid_bound>"""


def solute(name: str, diff: float = 1.0) -> str:
    return f"""<solute sol="{name}"><diffusivity type="diff-const-iso"><free_diff>{diff}</free_diff><diff>{diff}</diff>
</diffusivity><solubility type="solub-const"><solub>1</solub></solubility></solute>"""


def material(kind: str, solutes: str, more: str = "", E: float = 1.0) -> str:
    return f"""<material id="1" name="m" type="{kind}"><phi0>0.2</phi0>
<solid type="neo-Hookean"><density>1</density><E>{E}</E><v>0</v></solid>
<permeability type="perm-const-iso"><perm>1</perm></permeability>
<osmotic_coefficient type="osm-coef-const"><osmcoef>1</osmcoef></osmotic_coefficient>{solutes}{more}</material>"""


def rod(n: int, length: float) -> tuple[str, dict[str, list[int]]]:
    """n hex8 along z: nodes and elements as text, and node sets."""
    nodes, elements = [], []
    for k in range(n + 1):
        nodes += [(x, y, length * k / n) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
    for k in range(n):
        elements.append([4 * k + i for i in range(1, 9)])
    text = "".join(f'<node id="{i}">{x},{y},{z}</node>' for i, (x, y, z) in enumerate(nodes, 1))
    text = f'<Nodes name="n">{text}</Nodes><Elements type="hex8" name="p">'
    text += "".join(f'<elem id="{i}">{",".join(map(str, e))}</elem>' for i, e in enumerate(elements, 1)) + "</Elements>"
    every = list(range(1, len(nodes) + 1))
    sets = {"all": every, "end": every[-4:], "start": every[:4]}
    for name, axis in (("x0", 0), ("y0", 1), ("z0", 2)):
        sets[name] = [i for i in every if nodes[i - 1][axis] == 0]
    text += "".join(f'<NodeSet name="{k}">{",".join(map(str, v))}</NodeSet>' for k, v in sets.items())
    return text, sets


def deck(
    made_of: str, boundary: str, initial: str = "", n: int = 1, length: float = 1.0,
    steps: tuple[int, float] = (1, 1.0),
    module: str = "multiphasic", analysis: str = "TRANSIENT", constants: str | None = None, solver: str = "",
) -> str:  # fmt: skip
    given = f"<T>{T}</T><R>{R}</R><Fc>{FC}</Fc>" if constants is None else constants
    return f"""<?xml version="1.0"?><febio_spec version="4.0"><Module type="{module}"/>
<Control><analysis>{analysis}</analysis><time_steps>{steps[0]}</time_steps><step_size>{steps[1]}</step_size>
<solver type="{module}"><max_refs>50</max_refs><dtol>1e-8</dtol><etol>1e-14</etol><ptol>1e-8</ptol><ctol>1e-8</ctol>
{solver}<qn_method type="Broyden"><max_ups>0</max_ups></qn_method></solver></Control>
<Globals><Constants>{given}</Constants><Solutes>{SOLUTES}</Solutes>
<SolidBoundMolecules>{BOUND}</SolidBoundMolecules></Globals>
<Material>{made_of}</Material><Mesh>{rod(n, length)[0]}</Mesh>
<MeshDomains><SolidDomain name="p" mat="m"/></MeshDomains><Boundary>{boundary}</Boundary><Initial>{initial}</Initial>
<Output><plotfile type="febio"><var type="displacement"/><var type="effective fluid pressure"/>
<var type="effective solute concentration"/><var type="solute concentration"/><var type="fluid pressure"/>
<var type="electric potential"/><var type="fixed charge density"/><var type="sbm referential apparent density"/>
<var type="referential solid volume fraction"/><var type="solute flux"/></plotfile></Output></febio_spec>"""


SYMMETRY = "".join(
    f'<bc type="zero displacement" node_set="{a}0"><x_dof>{int(a == "x")}</x_dof><y_dof>{int(a == "y")}</y_dof>'
    f"<z_dof>{int(a == 'z')}</z_dof></bc>"
    for a in "xyz"
)
HELD = '<bc type="zero displacement" node_set="all"><x_dof>1</x_dof><y_dof>1</y_dof><z_dof>1</z_dof></bc>'


def prescribed(what: str, where: str, value: float, dof: str = "") -> str:
    named = f"<dof>{dof}</dof>" if dof else ""
    return f'<bc type="prescribed {what}" node_set="{where}">{named}<value>{value!r}</value></bc>'


def initial(dof: str, value: float) -> str:
    return f'<ic type="initial concentration" node_set="all"><dof>{dof}</dof><value>{value!r}</value></ic>'


def solve(text: str, folder: Path) -> xr.Dataset:
    (folder / "m.feb").write_text(text)
    done = febkit("run", "m.feb", "-silent", folder=folder)
    assert done.returncode == 0, done.stderr
    return xr.open_dataset(folder / "m.xplt", engine="febkit").load()


def refused(text: str, folder: Path) -> str:
    (folder / "m.feb").write_text(text)
    done = febkit("run", "m.feb", "-silent", folder=folder)
    assert done.returncode == 2, done.stderr
    assert "Traceback" not in done.stderr
    return done.stderr


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
