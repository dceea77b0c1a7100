"""FEBio's plot variables and log items for solids and biphasic models: febkit has each, or says here why not.

The names are those that FEBio 4.11 registers (:mod:`febkit.feb.features`).
"""

from __future__ import annotations

import pytest

from febkit.feb import features
from febkit.output import plot
from febkit.output.records import bodies, connectors, elements, faces, nodes, surfaces
from febkit.results.variables import VARIABLES, unit_symbol

# reason -> names
PLOT: dict[str, str] = {
    "materials of this kind (damage fiber ...) are not solved": """
    continuous damage; continuous damage D1; continuous damage D2; continuous damage D2beta; continuous damage D3;
    continuous damage Ds; continuous damage P; continuous damage Psi0; continuous damage beta; continuous damage gamma
    """,
    "mortar and edge contact are not solved": "mortar-gap; edge contact gap",
    "loads and controllers of these names are not solved": "ideal gas pressure; pid controller",
    "multiscale materials are not solved": "G norm; PK1 norm; QK1 norm; micro energy",
    "FEBio's fluid modules": """
    dilatation gradient; elastic fluid pressure; fluid acceleration; fluid body force; fluid bulk modulus;
    fluid density; fluid density rate; fluid dilatation; fluid element angular momentum; fluid element center
    of mass; fluid element kinetic energy; fluid element linear momentum; fluid element strain energy; fluid
    energy density; fluid heat flux; fluid heat supply density; fluid isobaric specific heat capacity; fluid
    isochoric specific heat capacity; fluid kinetic energy density; fluid mass flow rate; fluid pressure
    tangent strain; fluid pressure tangent temperature; fluid rate of deformation; fluid relative Reynolds
    number; fluid relative thermal Peclet number; fluid shear stress error; fluid shear viscosity; fluid
    specific entropy; fluid specific free energy; fluid specific free enthalpy; fluid specific gauge enthalpy;
    fluid specific internal energy; fluid specific strain energy; fluid strain energy density; fluid stress;
    fluid stress power density; fluid surface energy flux; fluid surface force; fluid surface moment; fluid
    surface pressure; fluid surface traction power; fluid temperature; fluid thermal conductivity; fluid
    velocity; fluid volume ratio; fluid volume ratio gradient; fluid vorticity; nodal fluid temperature; nodal
    fluid velocity; nodal polar fluid angular velocity; polar fluid angular velocity; polar fluid couple
    stress; polar fluid regional angular velocity; polar fluid relative angular velocity; polar fluid stress;
    relative fluid velocity; solid volume fraction; solute relative Peclet number
    """,
}
LOG: dict[str, str] = {
    "FEBio's fluid modules": """
    fJ; fax; fay; faz; fd; fdxx; fdxy; fdxz; fdyy; fdyz; fdzz; fmxs; fp; fs1; fs2; fs3; fsp; fsxx; fsxy; fsxz;
    fsyy; fsyz; fszz; fvx; fvy; fvz; fwx; fwy; fwz; fx; fy; fz; nfvx; nfvy; nfvz
    """,
}
# data of domains and of the model, and functions: tests/output/test_records.py
ELSEWHERE = {"_math", "avg", "integrate", "pct", "max contact gap", "normalized internal energy", "solution_norm",
             "total energy"}  # fmt: skip


def names(table: dict[str, str]) -> set[str]:
    return {" ".join(n.split()) for text in table.values() for n in text.split(";")}


@pytest.mark.parametrize("name", sorted(features.table()["plot"]))
def test_a_plot_variable_is_there_or_has_a_reason(name: str) -> None:
    there, told = plot.find(name) is not None, name in names(PLOT)
    assert there or told, f'"{name}" is not computed, and nothing here says why'
    assert not (there and told), f'"{name}" is computed, though a reason is given why not'


def _item(name: str) -> bool:
    tables = (elements.datum, bodies.datum, connectors.datum)
    nodal = (name[-1] in "xyz" and name[:-1] in nodes.VECTORS) or name in {*nodes.ALIASES, *nodes.REACTIONS}
    of_constraints = name in connectors.VOLUMES
    return nodal or of_constraints or any(f(name) for f in tables) or name in {*faces.ITEMS, *surfaces.ITEMS}


@pytest.mark.parametrize("name", sorted(set(features.table()["log"]) - ELSEWHERE))
def test_a_log_item_is_there_or_has_a_reason(name: str) -> None:
    there, told = _item(name), name in names(LOG)
    assert there or told, f'"{name}" is not computed, and nothing here says why'
    assert not (there and told), f'"{name}" is computed, though a reason is given why not'


def test_what_has_no_unit_depends_on_the_model() -> None:
    without = {n for n in VARIABLES if plot.find(n) is not None and not unit_symbol(n)}
    assert without == {"field", "parameter", "mesh_data", "contact penalty", "scalar surface load", "RVE strain"}
