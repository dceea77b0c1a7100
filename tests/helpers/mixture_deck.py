"""Small models with solutes as .feb text, solved."""

from __future__ import annotations

from pathlib import Path

import xarray as xr

import febkit

from . import forked

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
    mesh: str = "", domains: str = '<SolidDomain name="p" mat="m"/>', more: str = "",
) -> str:  # fmt: skip
    """A model of ``mesh``, or of a rod of n elements."""
    given = f"<T>{T}</T><R>{R}</R><Fc>{FC}</Fc>" if constants is None else constants
    return f"""<?xml version="1.0"?><febio_spec version="4.0"><Module type="{module}"/>
<Control><analysis>{analysis}</analysis><time_steps>{steps[0]}</time_steps><step_size>{steps[1]}</step_size>
<solver type="{module}"><max_refs>50</max_refs><dtol>1e-8</dtol><etol>1e-14</etol><ptol>1e-8</ptol><ctol>1e-8</ctol>
{solver}<qn_method type="Broyden"><max_ups>0</max_ups></qn_method></solver></Control>
<Globals><Constants>{given}</Constants><Solutes>{SOLUTES}</Solutes>
<SolidBoundMolecules>{BOUND}</SolidBoundMolecules></Globals>
<Material>{made_of}</Material><Mesh>{mesh or rod(n, length)[0]}</Mesh>
<MeshDomains>{domains}</MeshDomains><Boundary>{boundary}</Boundary><Initial>{initial}</Initial>{more}
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
    assert febkit.solve(febkit.read(folder / "m.feb"), folder / "m.xplt").converged
    return xr.open_dataset(folder / "m.xplt", engine="febkit").load()


def refused(text: str, folder: Path) -> str:
    (folder / "m.feb").write_text(text)
    done = forked.febkit("run", "m.feb", "-silent", folder=folder)
    assert done.returncode == 2, done.stderr
    assert "Traceback" not in done.stderr
    return done.stderr
