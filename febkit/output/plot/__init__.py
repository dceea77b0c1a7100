"""Plot variables by FEBio's names; a file is read when one of its names is first asked for.

What a variable is given and returns is said in :mod:`.base`. What the physics of a part offers at its integration
points under FEBio's name (``outputs`` of :mod:`febkit.solver.physics`) is written as means over elements.
"""

from __future__ import annotations

from importlib import import_module

from febkit.solver import physics

from .base import Face, Give, Part, View, table, told
from .base import mean as _mean

FILES: dict[str, tuple[str, ...]] = {
    "nodes": (
        "displacement", "nodal velocity", "nodal acceleration", "reaction forces", "incremental displacement",
        "rotation",
    ),
    "kinematics": (
        "deformation gradient", "Lagrange strain", "infinitesimal strain", "Almansi strain", "right Cauchy-Green",
        "left Cauchy-Green", "right stretch", "left stretch", "right Hencky", "left Hencky", "rate of deformation",
        "relative volume", "nodal strain",
    ),
    "stresses": (
        "PK1 stress", "PK2 stress", "s norm", "uncoupled pressure", "elasticity", "deviatoric elasticity",
        "mixture stress", "volume fraction", "nodal stress", "ut4 nodal stress", "Drucker shear stress",
        "Drucker-Prager stress", "Deshpande-Fleck stress",
    ),
    "energies": (
        "density", "strain energy density", "specific strain energy", "deviatoric strain energy density",
        "mixture strain energy density", "mixture deviatoric strain energy density", "mixture specific strain energy",
        "element strain energy", "current element strain energy", "element stress power",
    ),
    "motion": (
        "velocity", "acceleration", "kinetic energy density", "element kinetic energy",
        "current element kinetic energy", "element center of mass", "current element center of mass",
        "element linear momentum", "current element linear momentum", "element angular momentum",
        "current element angular momentum", "total energy", "total linear momentum", "total angular momentum",
    ),
    "fibers": ("material axes", "fiber vector", "fiber stretch", "deviatoric fiber stretch"),
    "shells": (
        "shell displacement", "nodal shell director", "effective shell fluid pressure",
        "effective shell solute concentration", "shell director", "shell thickness", "sbm areal concentration",
    ),
    "shell_faces": (
        "shell relative volume", "shell strain", "shell top stress", "shell bottom stress", "shell top strain",
        "shell bottom strain", "shell top nodal stress", "shell bottom nodal stress", "shell top nodal strain",
        "shell bottom nodal strain",
    ),
    "recovery": (
        "SPR stress", "SPR-P1 stress", "SPR principal stress", "SPR Lagrange strain", "SPR infinitesimal strain",
        "SPR relative volume", "stress error",
    ),
    "growth": (
        "growth Lagrange strain", "growth infinitesimal strain", "growth right stretch", "growth left stretch",
        "growth right Hencky", "growth left Hencky", "growth relative volume",
    ),
    "rigid": (
        "rigid position", "rigid velocity", "rigid acceleration", "rigid angular position", "rigid rotation vector",
        "rigid angular velocity", "rigid angular acceleration", "rigid linear momentum", "rigid angular momentum",
        "rigid kinetic energy", "Euler angle", "rigid force", "rigid torque",
    ),
    "springs": (
        "discrete element length", "discrete element elongation", "discrete element percent elongation",
        "discrete element stretch", "discrete element direction", "discrete element force",
        "discrete element signed force", "discrete element strain energy",
    ),
    "surfaces": (
        "facet area", "surface area", "enclosed volume", "enclosed volume change", "surface reaction force",
        "surface reaction moment", "surface traction", "nodal surface traction", "fluid flow rate", "fluid force2",
    ),
    "contacts": (
        "contact gap", "contact pressure", "contact traction", "nodal contact gap", "nodal contact pressure",
        "nodal contact traction", "vector gap", "nodal vector gap", "contact stick", "contact status",
        "contact penalty", "effective friction coefficient", "contact area", "contact force", "pressure gap",
        "fluid force", "local fluid load support", "fluid load support",
    ),
    "bonds": (
        "damage", "intact bond fraction", "yielded bond fraction", "fatigue bond fraction",
        "octahedral plastic strain", "plasticity heat supply density", "plastic yield stress", "RVE generations",
        "RVE reforming bonds", "RVE recruitment", "RVE strain", "strong bond SED", "weak bond SED",
        "deviatoric strong bond SED", "deviatoric weak bond SED", "continuous damage", "continuous damage D1",
        "continuous damage Ds", "continuous damage D2", "continuous damage D3", "continuous damage P",
        "continuous damage Psi0", "continuous damage beta", "continuous damage gamma", "continuous damage D2beta",
    ),
    "prestrain": (
        "in-situ target stretch", "prestrain stretch", "prestrain stretch error", "prestrain correction",
        "SPR prestrain correction", "prestrain compatibility",
    ),
    "loads": ("body force", "scalar surface load", "ideal gas pressure"),
    "volumes": ("PK1 norm", "micro energy"),
    "feedback": ("pid controller",),
    "absent": ("G norm", "QK1 norm", "mortar-gap", "edge contact gap"),
    "maps": ("field", "parameter", "mesh_data"),
    "fluids": ("effective fluid pressure", "nodal fluid flux", "permeability", "effective elasticity"),
    "solutes": ("effective solute concentration", "osmotic coefficient", "concentration gap"),
}  # fmt: skip
_FILE = {name: file for file, names in FILES.items() for name in names}
# arrays over the model's solutes, and over its solid-bound molecules
ARRAYS = {
    "effective solute concentration": "solute", "solute concentration": "solute", "partition coefficient": "solute",
    "solute flux": "solute", "solute volumetric flux": "solute", "concentration gap": "solute",
    "sbm concentration": "solid_bound", "sbm referential apparent density": "solid_bound",
    "sbm areal concentration": "solid_bound",
}  # fmt: skip
# what depends on values and reactions of nodes alone
NODAL = {
    "displacement", "nodal velocity", "nodal acceleration", "reaction forces", "incremental displacement",
    "effective fluid pressure",
}  # fmt: skip
PARTS = {"pid controller": ("measurement", "error", "output")}  # names of other arrays' values


def find(name: str, solutes: bool = True) -> Give | None:
    """What gives a variable, None where febkit has none of this name.

    Physics that cannot be in a model (mixtures in one without ``solutes``) are not read.
    """
    if name in _FILE:
        import_module(f"{__name__}.{_FILE[name]}")
        return table[name]
    if any(name in physics.load(p).work.outputs for p in physics.FILES if solutes or p != "multiphasic"):
        return _mean(lambda part: part.at_points(name), lines=True)
    return None


__all__ = ["ARRAYS", "FILES", "PARTS", "Face", "Give", "Part", "View", "find", "told"]
