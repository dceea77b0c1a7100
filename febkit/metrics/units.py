"""What the units of a model mean for the metrics; the numbers themselves pass through."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Units:
    """Names of the derived units and the density of water in pg per cubic unit of length."""

    length: str
    stress: str
    water: float
    assumed: bool = False

    @property
    def flux(self) -> str:
        return f"{self.length}/s"


# FEBio's <units> -> length, stress, pg of water per cubic length
SYSTEMS: Mapping[str, Units] = {
    "SI": Units("m", "Pa", 1e18),
    "mm-N-s": Units("mm", "MPa", 1e9),
    "mm-kg-s": Units("mm", "kPa", 1e9),
    "um-nN-s": Units("um", "kPa", 1.0),
    "CGS": Units("cm", "dyn/cm^2", 1e12),
    "mm-g-s": Units("mm", "Pa", 1e9),
    "mm-mg-s": Units("mm", "mPa", 1e9),
}


def of(name: object) -> Units:
    """Units of a system named as in FEBio's ``<units>``; mm-N-s where the model names none."""
    if isinstance(name, str) and name in SYSTEMS:
        return SYSTEMS[name]
    mm = SYSTEMS["mm-N-s"]
    return Units(mm.length, mm.stress, mm.water, assumed=True)
