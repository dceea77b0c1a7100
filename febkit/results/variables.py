"""How FEBio stores each plot variable: section, item type, format and unit.

Unit symbols are FEBio's (L length, P pressure, t time, ...; "" where it names none). Source: the plot field
registrations of FEBio 4.11 (FEBioMech, FEBioMix, FEBioFluid, FEBioRVE, FEAMR).
"""

from __future__ import annotations

from collections.abc import Iterator

from .xplt.records import PlotVariable

# (section, type, format) -> unit -> names
_STORAGE: dict[tuple[str, str, str], dict[str, tuple[str, ...]]] = {
    ("node", "float", "node"): {
        "": ("fluid dilatation",),
        "R": ("nodal fluid temperature",),
    },
    ("node", "float", "item"): {
        "": ("field",),
    },
    ("domain", "float", "mult"): {
        "": ("parameter", "mesh_data"),  # section, type and format are those of what is named
        "L": ("shell thickness",),
    },
    ("node", "vec3f", "node"): {
        "F": ("reaction forces",),
        "L": ("displacement", "incremental displacement", "nodal shell director", "shell displacement"),
        "L/t": ("nodal fluid velocity", "nodal velocity"),
        "L/t^2": ("nodal acceleration",),
        "r": ("rotation",),
        "r/t": ("nodal polar fluid angular velocity",),
    },
    ("domain", "float", "node"): {
        "": ("effective shell solute concentration", "SPR relative volume"),
        "P": ("effective fluid pressure", "effective shell fluid pressure"),
    },
    ("domain", "float", "item"): {
        "": ("continuous damage", "continuous damage beta", "continuous damage D1",
            "continuous damage D2", "continuous damage D2beta", "continuous damage D3",
            "continuous damage Ds", "continuous damage gamma", "continuous damage P",
            "continuous damage Psi0", "current element kinetic energy", "current element strain energy",
            "damage", "deviatoric fiber stretch", "deviatoric strain energy density",
            "deviatoric strong bond SED", "deviatoric weak bond SED", "discrete element elongation",
            "discrete element length", "discrete element percent elongation",
            "discrete element signed force", "discrete element strain energy",
            "discrete element stretch", "element stress power", "fatigue bond fraction", "fiber stretch",
            "fluid shear stress error", "fluid volume ratio", "G norm", "growth relative volume",
            "in-situ target stretch", "intact bond fraction", "kinetic energy density", "micro energy",
            "octahedral plastic strain", "osmotic coefficient", "PK1 norm",
            "plasticity heat supply density", "porosity", "prestrain compatibility", "prestrain stretch",
            "prestrain stretch error", "QK1 norm", "referential solid volume fraction",
            "relative volume", "RVE generations", "RVE recruitment", "RVE reforming bonds", "RVE strain",
            "shell relative volume", "solid volume fraction", "specific strain energy",
            "strain energy density", "stress error", "strong bond SED", "truss stretch",
            "volume fraction", "weak bond SED", "yielded bond fraction"),
        "1/L": ("fluid relative Reynolds number", "fluid relative thermal Peclet number"),
        "E": ("element kinetic energy", "element strain energy", "fluid element kinetic energy",
            "fluid element strain energy"),
        "E/L^3": ("fluid energy density", "fluid kinetic energy density", "fluid strain energy density"),
        "E/M": ("fluid specific free energy", "fluid specific free enthalpy",
            "fluid specific gauge enthalpy", "fluid specific internal energy",
            "fluid specific strain energy", "mixture specific strain energy"),
        "E/M.T": ("fluid isobaric specific heat capacity", "fluid isochoric specific heat capacity",
            "fluid pressure tangent strain", "fluid pressure tangent temperature",
            "fluid specific entropy"),
        "M/L^3": ("density", "fluid density", "receptor-ligand concentration"),
        "M/L^3.t": ("fluid density rate",),
        "P": ("Deshpande-Fleck stress", "Drucker shear stress", "Drucker-Prager stress",
            "elastic fluid pressure", "fluid bulk modulus", "fluid pressure",
            "mixture deviatoric strain energy density", "mixture strain energy density",
            "plastic yield stress", "s norm", "uncoupled pressure"),
        "P.t": ("fluid shear viscosity",),
        "R": ("fluid temperature",),
        "V": ("electric potential",),
        "W/L.T": ("fluid thermal conductivity",),
        "W/L^3": ("fluid heat supply density", "fluid stress power density"),
        "c": ("fixed charge density", "osmolarity", "referential fixed charge density"),
    },
    ("domain", "float", "region"): {
        "E": ("rigid kinetic energy", "total energy"),
    },
    ("domain", "vec3f", "item"): {
        "": ("beam curvature", "beam reference stress", "beam reference stress couple", "beam strain",
            "beam stress", "beam stress couple", "current element angular momentum",
            "current element linear momentum", "dilatation gradient", "discrete element direction",
            "element angular momentum", "element linear momentum", "fiber vector",
            "fluid volume ratio gradient"),
        "E.t": ("fluid element angular momentum",),
        "F": ("discrete element force",),
        "F.t": ("fluid element linear momentum",),
        "F/M": ("body force", "fluid body force"),
        "I/L^2": ("current density",),
        "L": ("current element center of mass", "element center of mass", "fluid element center of mass"),
        "L/t": ("fluid flux", "fluid velocity", "relative fluid velocity", "velocity"),
        "L/t^2": ("acceleration", "fluid acceleration"),
        "W/L^2": ("fluid heat flux",),
        "r/t": ("fluid vorticity", "polar fluid angular velocity",
            "polar fluid regional angular velocity", "polar fluid relative angular velocity"),
    },
    ("domain", "vec3f", "mult"): {
        "": ("shell director",),
        "L/t": ("nodal fluid flux",),
    },
    ("domain", "vec3f", "region"): {
        "": ("rigid angular acceleration", "rigid angular momentum", "rigid angular position",
            "rigid angular velocity", "rigid linear momentum", "rigid rotation vector", "rigid torque"),
        "E": ("total angular momentum", "total linear momentum"),
        "F": ("rigid force",),
        "L": ("rigid position",),
        "L/t": ("rigid velocity",),
        "L/t^2": ("rigid acceleration",),
        "r": ("Euler angle",),
    },
    ("domain", "mat3fs", "node"): {
        "": ("SPR infinitesimal strain", "SPR Lagrange strain", "ut4 nodal stress"),
        "P": ("SPR stress", "SPR-P1 stress"),
    },
    ("domain", "mat3fs", "item"): {
        "": ("Almansi strain", "growth infinitesimal strain", "growth Lagrange strain",
            "growth left Hencky", "growth left stretch", "growth right Hencky", "growth right stretch",
            "infinitesimal strain", "Lagrange strain", "left Cauchy-Green", "left Hencky",
            "left stretch", "rate of deformation", "right Cauchy-Green", "right Hencky", "right stretch",
            "shell bottom strain", "shell strain", "shell top strain"),
        "1/t": ("fluid rate of deformation",),
        "L^4/F.t": ("permeability",),
        "P": ("fluid stress", "mixture stress", "PK2 stress", "shell bottom stress", "shell top stress",
            "solid stress", "stress"),
    },
    ("domain", "mat3fs", "mult"): {
        "": ("nodal strain", "shell bottom nodal strain", "shell top nodal strain"),
        "P": ("nodal stress", "shell bottom nodal stress", "shell top nodal stress"),
    },
    ("domain", "mat3fd", "node"): {
        "P": ("SPR principal stress",),
    },
    ("domain", "tens4fs", "item"): {
        "": ("deviatoric elasticity",),
        "P": ("effective elasticity", "elasticity"),
    },
    ("domain", "mat3f", "node"): {
        "": ("SPR prestrain correction",),
    },
    ("domain", "mat3f", "item"): {
        "": ("deformation gradient", "material axes", "prestrain correction"),
        "E/L^2": ("polar fluid couple stress",),
        "P": ("PK1 stress", "polar fluid stress"),
    },
    ("domain", "array", "node"): {
        "c": ("effective solute concentration",),
    },
    ("domain", "array", "item"): {
        "": ("partition coefficient",),
        "1/L": ("solute relative Peclet number",),
        "M/L^3": ("sbm referential apparent density",),
        "c": ("sbm concentration", "solute concentration"),
        "n/L^2": ("sbm areal concentration",),
    },
    ("domain", "array vec3f", "item"): {
        "L/t": ("solute volumetric flux",),
        "n/L^2.t": ("solute flux",),
    },
    ("surface", "float", "node"): {
        "L": ("mortar-gap",),
    },
    ("surface", "float", "item"): {
        "": ("contact penalty", "contact status", "contact stick", "effective friction coefficient",
            "local fluid load support", "scalar surface load"),
        "L": ("contact gap",),
        "L^2": ("facet area",),
        "P": ("contact pressure", "fluid surface pressure", "pressure gap"),
    },
    ("surface", "float", "mult"): {
        "L": ("nodal contact gap",),
        "P": ("nodal contact pressure",),
    },
    ("surface", "float", "region"): {
        "": ("fluid load support", "ideal gas pressure"),
        "L^2": ("contact area", "surface area"),
        "L^3": ("enclosed volume", "enclosed volume change"),
        "L^3/t": ("fluid flow rate",),
        "M/t": ("fluid mass flow rate",),
        "W": ("fluid surface energy flux", "fluid surface traction power"),
    },
    ("surface", "vec3f", "item"): {
        "L": ("vector gap",),
        "P": ("contact traction", "surface traction"),
    },
    ("surface", "vec3f", "mult"): {
        "L": ("nodal vector gap",),
        "P": ("nodal contact traction", "nodal surface traction"),
    },
    ("surface", "vec3f", "region"): {
        "": ("surface reaction force", "surface reaction moment"),
        "F": ("contact force", "fluid force", "fluid force2", "fluid surface force"),
        "F.L": ("fluid surface moment",),
    },
    ("surface", "array", "item"): {
        "c": ("concentration gap",),
    },
    ("edge", "float", "node"): {
        "L": ("edge contact gap",),
    },
    ("global", "array", "region"): {
        "": ("pid controller",),
    },
}


def _known() -> Iterator[PlotVariable]:
    for (section, type_, format_), by_unit in _STORAGE.items():
        for unit, names in by_unit.items():
            for name in names:
                yield PlotVariable(name, section, type_, format_, units=unit or None)


VARIABLES: dict[str, PlotVariable] = {v.name: v for v in _known()}

# what FEBio gives no unit but has one all the same ("1": a pure number); others of its "" stay without
_UNNAMED: dict[str, tuple[str, ...]] = {
    "1": (
        "Almansi strain", "beam strain", "contact status", "contact stick", "continuous damage",
        "continuous damage beta", "continuous damage D1", "continuous damage D2", "continuous damage D2beta",
        "continuous damage D3", "continuous damage Ds", "continuous damage gamma", "continuous damage P",
        "continuous damage Psi0", "damage", "deformation gradient",
        "deviatoric fiber stretch", "discrete element direction", "discrete element percent elongation",
        "discrete element stretch", "effective friction coefficient",
        "fatigue bond fraction", "fiber stretch", "fiber vector", "fluid dilatation", "fluid load support",
        "fluid volume ratio", "growth Lagrange strain", "growth infinitesimal strain", "growth left Hencky",
        "growth left stretch", "growth relative volume", "growth right Hencky", "growth right stretch",
        "in-situ target stretch", "infinitesimal strain", "intact bond fraction", "Lagrange strain",
        "left Cauchy-Green", "left Hencky", "left stretch", "local fluid load support", "material axes",
        "nodal strain", "octahedral plastic strain", "osmotic coefficient", "partition coefficient", "porosity",
        "prestrain correction", "prestrain stretch", "prestrain stretch error", "referential solid volume fraction",
        "relative volume", "RVE generations", "RVE recruitment", "RVE reforming bonds", "right Cauchy-Green",
        "right Hencky", "right stretch", "shell bottom nodal strain", "shell bottom strain", "shell relative volume",
        "shell strain", "shell top nodal strain", "shell top strain", "solid volume fraction",
        "SPR infinitesimal strain", "SPR Lagrange strain", "SPR prestrain correction", "SPR relative volume",
        "stress error", "truss stretch", "volume fraction", "yielded bond fraction",
    ),
    "1/t": ("rate of deformation",),
    "1/L": ("beam curvature", "dilatation gradient", "fluid volume ratio gradient", "prestrain compatibility"),
    "L": ("discrete element elongation", "discrete element length", "shell director"),
    "F": ("beam reference stress", "beam stress", "discrete element signed force", "surface reaction force"),
    "F.L": ("beam reference stress couple", "beam stress couple", "rigid torque", "surface reaction moment"),
    "F.t": ("current element linear momentum", "element linear momentum", "rigid linear momentum"),
    "E": ("current element kinetic energy", "current element strain energy", "discrete element strain energy"),
    "E.t": ("current element angular momentum", "element angular momentum", "rigid angular momentum"),
    "E/M": ("specific strain energy",),
    "W": ("element stress power",),
    "W/L^3": ("plasticity heat supply density",),
    "P": ("deviatoric elasticity", "deviatoric strain energy density", "deviatoric strong bond SED",
          "deviatoric weak bond SED", "ideal gas pressure", "kinetic energy density", "micro energy",
          "strain energy density", "strong bond SED", "ut4 nodal stress", "weak bond SED"),
    "P^2": ("PK1 norm",),
    "P^2.L^2": ("QK1 norm",),
    "1/L^2": ("G norm",),
    "c": ("effective shell solute concentration",),
    "r": ("rigid angular position", "rigid rotation vector"),
    "r/t": ("rigid angular velocity",),
    "r/t^2": ("rigid angular acceleration",),
}  # fmt: skip
_OWN: dict[str, str] = {name: unit for unit, names in _UNNAMED.items() for name in names}


def unit_symbol(name: str) -> str:
    """FEBio's symbol of a plot variable's unit, "1" for pure numbers, "" where nothing is known."""
    plain = name.split("=")[0].split("[")[0].strip()
    known = VARIABLES.get(plain)
    return (known.units if known else None) or _OWN.get(plain, "")
