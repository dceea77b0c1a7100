"""Unit symbols of FEBio ("P", "L/t", ...) as units of one of its unit systems."""

from __future__ import annotations

import re

from .variables import VARIABLES

_BASE = ("L", "M", "t", "T", "I", "n", "F", "P", "E", "W", "V", "c", "R", "r", "d")

SYSTEMS: dict[str, dict[str, str]] = {  # as FEBio Studio names them
    name: dict(zip(_BASE, row.split()))
    for name, row in {
        "SI": "m kg s K A mol N Pa J W V mM degC rad deg",
        "mm-N-s": "mm tonne s K A nmol N MPa mJ mW mV mM degC rad deg",
        "mm-kg-s": "mm kg s K mA nmol mN kPa uJ uW mV mM degC rad deg",
        "um-nN-s": "um g s K pA amol nN kPa fJ fW mV mM degC rad deg",
        "CGS": "cm g s K cA umol dyn dyn/cm^2 erg erg/s mV mM degC rad deg",
        "mm-g-s": "mm g s K uA nmol uN Pa nJ nW mV mM degC rad deg",
        "mm-mg-s": "mm mg s K nA nmol nN mPa pJ pW mV mM degC rad deg",
    }.items()
}


def symbol(name: str) -> str | None:
    """FEBio's unit symbol of a plot variable, if it has one."""
    v = VARIABLES.get(name.split("=")[0].split("[")[0].strip())
    return v.units if v else None


def resolve(text: str, system: str) -> str:
    """"L/t^2" in "SI" becomes "m/s^2"; the symbol itself where the system is unknown."""
    table = SYSTEMS.get(system)
    if table is None:
        return text
    return re.sub(r"[A-Za-z]+", lambda m: table.get(m.group(), m.group()), text)
