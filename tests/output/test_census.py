"""FEBio's plot variables and log items for solids and biphasic models: febkit has each, or says here why not.

The names are those that FEBio 4.11 registers (:mod:`febkit.feb.features`).
"""

from __future__ import annotations

import pytest

from febkit.feb import features
from febkit.output import plot
from febkit.output.records.known import known
from febkit.results.variables import VARIABLES, unit_symbol

# reason -> names
PLOT: dict[str, str] = {
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

def names(table: dict[str, str]) -> set[str]:
    return {" ".join(n.split()) for text in table.values() for n in text.split(";")}


@pytest.mark.parametrize("name", sorted(features.table()["plot"]))
def test_a_plot_variable_is_there_or_has_a_reason(name: str) -> None:
    there, told = plot.find(name) is not None, name in names(PLOT)
    assert there or told, f'"{name}" is not computed, and nothing here says why'
    assert not (there and told), f'"{name}" is computed, though a reason is given why not'


@pytest.mark.parametrize("name", sorted(features.table()["log"]))
def test_a_log_item_is_there_or_has_a_reason(name: str) -> None:
    there, told = known(name), name in names(LOG)
    assert there or told, f'"{name}" is not computed, and nothing here says why'
    assert not (there and told), f'"{name}" is computed, though a reason is given why not'


def test_what_has_no_unit_depends_on_the_model() -> None:
    without = {n for n in VARIABLES if plot.find(n) is not None and not unit_symbol(n)}
    assert without == {"field", "parameter", "mesh_data", "contact penalty", "pid controller", "scalar surface load",
                       "RVE strain"}  # fmt: skip
