"""Units: FEBio's systems, what its symbols of quantities ("L", "P", "L/t") stand for in them, and factors.

A model names its system in ``<Module><units>``. Numbers pass through febkit as they are; where a system is known,
units are named beside them and physical constants and customary units are used, and nowhere else.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING

from febkit.record import value_record

if TYPE_CHECKING:
    from febkit.model import InputError

_SYMBOLS = ("L", "M", "t", "T", "I", "n", "F", "P", "E", "W", "V", "c", "R", "r", "d")


@value_record
class System:
    """A unit system by FEBio's name of it; ``units`` of each symbol (FECore/units.h)."""

    name: str
    units: Mapping[str, str]

    def of(self, quantity: str) -> str:
        """The unit of a quantity: "L^4/F.t" is "mm^4/(N s)" in mm-N-s, "" is "" and "1" is "1"."""
        powers: dict[str, int] = {}
        for symbol, n in _powers(quantity).items():
            for unit, m in _powers(self.units.get(symbol, symbol)).items():
                powers[unit] = powers.get(unit, 0) + n * m
        return _written(powers) if quantity else ""

    @property
    def water(self) -> float:
        """Density of water in pg per cubic unit of length."""
        return factor("g/cm^3", f"pg/{self.units['L']}^3")


SYSTEMS: dict[str, System] = {  # as FEBio Studio names them
    name: System(name, dict(zip(_SYMBOLS, row.split())))
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

# power of ten, then powers of m, kg, s, K, A, mol
_UNITS: dict[str, tuple[int, tuple[int, ...]]] = {
    "m": (0, (1, 0, 0, 0, 0, 0)), "g": (-3, (0, 1, 0, 0, 0, 0)), "tonne": (3, (0, 1, 0, 0, 0, 0)),
    "s": (0, (0, 0, 1, 0, 0, 0)), "K": (0, (0, 0, 0, 1, 0, 0)), "A": (0, (0, 0, 0, 0, 1, 0)),
    "mol": (0, (0, 0, 0, 0, 0, 1)), "M": (3, (-3, 0, 0, 0, 0, 1)), "N": (0, (1, 1, -2, 0, 0, 0)),
    "dyn": (-5, (1, 1, -2, 0, 0, 0)), "Pa": (0, (-1, 1, -2, 0, 0, 0)), "J": (0, (2, 1, -2, 0, 0, 0)),
    "erg": (-7, (2, 1, -2, 0, 0, 0)), "W": (0, (2, 1, -3, 0, 0, 0)), "V": (0, (2, 1, -3, 0, -1, 0)),
}  # fmt: skip
_PREFIXES = {"M": 6, "k": 3, "c": -2, "m": -3, "u": -6, "n": -9, "p": -12, "f": -15, "a": -18}


def system(name: object) -> System | None:
    """The system that a file names; None where it names none, or one that FEBio does not know."""
    return SYSTEMS.get(name) if isinstance(name, str) else None


def told(name: str) -> str:
    """The name of a system that a user gave. Raises InputError where FEBio knows none of that name."""
    if name not in SYSTEMS:
        raise _error(f"units {name!r} are none of FEBio's: {', '.join(SYSTEMS)}")
    return name


def one(*names: object, what: str) -> str | None:
    """The one system that all of ``names`` agree on, those that name none apart.

    Raises InputError with ``what`` ("the result and its model") where two differ.
    """
    said = list(dict.fromkeys(n for n in names if isinstance(n, str) and n))
    if len(said) > 1:
        raise _error(f"{what} differ in units: {' and '.join(said)}")
    return said[0] if said else None


def factor(a: str, b: str) -> float:
    """How many ``b`` one ``a`` is: 1000 for ("MPa", "kPa"). Raises InputError where they measure different things."""
    if a == b:
        return 1.0
    mine, others = _measured(a), _measured(b)
    if mine is None or others is None:
        raise _error(f"{(b if mine else a)!r} is no unit that can be converted")
    if mine[1] != others[1]:
        raise _error(f"{a} and {b} are units of different quantities")
    tens = mine[0] - others[0]
    return float(10**tens) if tens >= 0 else 1.0 / 10**-tens


def measures(unit: str, like: str) -> bool:
    """Whether ``unit`` is one of the quantity that ``like`` is a unit of."""
    mine, others = _measured(unit), _measured(like)
    return bool(unit) and mine is not None and others is not None and mine[1] == others[1]


def _error(text: str) -> InputError:
    """An error in words; febkit.model imports numpy, and the command line lists the systems without it."""
    from febkit.model import InputError

    return InputError(text)


def _measured(text: str) -> tuple[int, tuple[int, ...]] | None:
    """Power of ten and powers of the base quantities of a unit, None where it has an unknown one."""
    ten, powers = 0, [0] * 6
    for name, n in _powers(text).items():
        prefix = 0
        if name not in _UNITS and name[:1] in _PREFIXES:
            prefix, name = _PREFIXES[name[0]], name[1:]
        if name not in _UNITS:
            return None
        own, of = _UNITS[name]
        ten += n * (prefix + own)
        powers = [p + n * q for p, q in zip(powers, of)]
    return ten, tuple(powers)


def _powers(text: str) -> dict[str, int]:
    """Factors of "L^4/F.t" and of "mm^4/(N s)" with their powers: what stands behind a stroke divides."""
    out: dict[str, int] = {}
    for k, part in enumerate(text.split("/")):
        for name, power in re.findall(r"([A-Za-z]+)(?:\^(-?\d+))?", part):
            out[name] = out.get(name, 0) + (int(power or 1) if k == 0 else -int(power or 1))
    return out


def _written(powers: Mapping[str, int]) -> str:
    """ "mm^4/(N s)": a space between factors, as UDUNITS and people read it."""
    above = [u if n == 1 else f"{u}^{n}" for u, n in powers.items() if n > 0]
    below = [u if n == -1 else f"{u}^{-n}" for u, n in powers.items() if n < 0]
    if not below:
        return " ".join(above) or "1"
    return f"{' '.join(above) or '1'}/{below[0] if len(below) == 1 else '(' + ' '.join(below) + ')'}"
