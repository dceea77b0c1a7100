"""Units that metrics are given in, whatever the model's: kPa, um, um^3, um/s, pg/s, mM, nmol, mV."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from febkit import units

if TYPE_CHECKING:
    import xarray as xr

    from febkit.model import Model

# kind -> FEBio's symbol of the quantity, unit; None: in that unit already, or in the model's own
_KINDS: Mapping[str, tuple[str, str | None]] = {
    "": ("1", None),
    "stress": ("P", "kPa"),
    "length": ("L", "um"),
    "volume": ("L^3", "um^3"),
    "flux": ("L/t", "um/s"),
    "time": ("t", None),
    "concentration": ("c", "mM"),
    "amount": ("n", "nmol"),
    "amount rate": ("n/t", "nmol/s"),
    "potential": ("V", "mV"),
}


@dataclass(frozen=True, slots=True)
class Scale:
    """From a model's numbers to those units; plain numbers without units where its system is not known."""

    system: units.System | None

    def unit(self, kind: str) -> str:
        """The unit of a kind of value, "" where it is not known."""
        if kind == "":
            return "1"
        if self.system is None:
            return ""
        if kind == "mass":
            return "pg/s"
        symbol, unit = _KINDS[kind]
        return unit or self.system.of(symbol)

    def by(self, kind: str) -> float:
        """What the model's numbers of this kind are multiplied by."""
        symbol, unit = _KINDS.get(kind, ("", None))
        return units.factor(self.system.of(symbol), unit) if self.system and unit else 1.0

    def attrs(self, kind: str) -> dict[str, str]:
        unit = self.unit(kind)
        return {"units": unit} if unit else {}


def unit_system(ds: xr.Dataset, model: Model | None = None) -> units.System | None:
    """The system of a result and its model. Raises InputError where they name different ones."""
    name = units.one(ds.attrs.get("unit_system"), model.units if model else None, what="the result and its model")
    return units.system(name)
