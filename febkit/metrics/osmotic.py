"""What cells of charged mixtures hold: solutes, water, charge, and how fast solutes leave."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from febkit.model import UnsupportedError

from . import mixtures, shape
from .kinematics import Group, State
from .sources import Sources

if TYPE_CHECKING:
    import xarray as xr

Floats = NDArray[np.float64]
# of each cell, and of each cell and solute
SCALARS = ("osmolarity", "fixed_charge_density", "electric_potential", "donnan_pressure", "osmotic_swelling")
BY_SOLUTE = ("solute_concentration", "solute_amount", "solute_exchange_rate")
# name -> long name, unit kind, formula; means are weighted by the volume of water
TABLE = {
    "osmolarity": (
        "osmolarity", "concentration", "integral of phi_w sum c_i over integral of phi_w, of the solutes that diffuse"
    ),
    "fixed_charge_density": (
        "fixed charge density", "concentration", "integral of phi_w cF over integral of phi_w, cF per volume of water"
    ),
    "electric_potential": (
        "electric potential", "potential", "integral of phi_w psi over integral of phi_w, by electroneutrality"
    ),
    "donnan_pressure": (
        "Donnan osmotic pressure", "stress",
        "integral of phi_w R T Phi (sum c_i - sum c*_i) over integral of phi_w, c* of the solution without fixed "
        "charge in equilibrium with the cell's: R T Phi (sqrt(cF^2 + 4 c*^2) - 2 c*) for one salt",
    ),
    "osmotic_swelling": (
        "osmotic swelling", "", "volume of water over its reference value - 1, volume of water = integral of phi_w"
    ),
    "solute_concentration": (
        "mean concentration of a solute", "concentration", "integral of phi_w c_i over integral of phi_w"
    ),
    "solute_amount": ("amount of a solute", "amount", "integral of phi_w c_i over the deformed cell"),
    "solute_exchange_rate": (
        "net exchange rate of a solute", "amount rate",
        "-dN_i/dt, difference to the state before, N_i the amount: what leaves through the surface less what is made "
        "inside, on average between the two states, outward > 0",
    ),
}  # fmt: skip
HOW = (
    "at the integration points, from displacement, effective fluid pressure, effective concentrations and the model's "
    "mixture, as the discrete balances have them"
)


@dataclass(slots=True, eq=False)
class Osmotic:
    """Metrics of the cells whose groups are mixtures; ``laws`` None for groups that are not."""

    groups: list[Group]
    laws: list[mixtures.Law | None]
    cells: int

    @classmethod
    def make(cls, groups: list[Group], cells: int, sources: Sources) -> Osmotic | None:
        """None where no cell is a mixture with solutes, or a source is missing, which the notes then say."""
        kinds = [getattr(sources.parts.get(g.material), "type", None) for g in groups]
        charged = any(k in mixtures.KINDS for k in kinds)
        if not charged:
            if mixtures.CONCENTRATION in sources.ds and sources.model is None:
                sources.notes.add(SCALARS[0], "missing: no model was given to get concentrations in the cells from")
            return None
        try:
            laws = [mixtures.make(sources, g) for g in groups]
        except UnsupportedError as e:
            sources.notes.add(SCALARS[0], f"missing: {e}")
            return None
        if not any(laws):
            sources.notes.add(
                SCALARS[0], "missing: it needs the effective fluid pressure and the effective solute concentration"
            )
            return None
        for name in TABLE:
            sources.notes.add(name, HOW)
        return cls(groups, laws, cells)

    def at(self, states: list[State], t: int) -> dict[str, Floats]:
        """Values (cell,) and (cell, solute) at time index ``t``."""
        total: dict[str, Floats] = {}

        def add(name: str, g: Group, v: Floats) -> None:
            total[name] = total.get(name, 0.0) + shape.sums(g.owner, v.sum(axis=-2), self.cells)

        for g, law, s in zip(self.groups, self.laws, states):
            if law is None:
                continue
            now = law(s, t)
            water = now.water * s.dv
            add("water", g, water)
            add("rest", g, now.water_at_rest * g.dV)
            add("solute_amount", g, now.concentration * water)
            for name, v in (
                ("osmolarity", now.osmolarity),
                ("fixed_charge_density", now.fixed_charge),
                ("electric_potential", now.potential),
                ("donnan_pressure", now.donnan),
            ):
                add(name, g, v * water)
        V = total.pop("water")
        V0 = total.pop("rest")
        V, V0 = (np.where(v > 0, v, np.nan) for v in (V, V0))  # cells without water hold nothing
        amount = total.pop("solute_amount").T
        out = {name: v / V for name, v in total.items()}
        return out | {
            "osmotic_swelling": V / V0 - 1,
            "solute_amount": amount,
            "solute_concentration": amount / V[:, None],
        }


def column(name: str, solute: str) -> str:
    """ "solute_concentration[Na+]": one solute's metric where each stands for itself."""
    return f"{name}[{solute}]"


def split(ds: xr.Dataset) -> xr.Dataset:
    """The metrics with those over ``solute`` as one variable (cell, time) for each solute."""
    if "solute" not in ds.dims:
        return ds
    out = ds.drop_dims("solute")
    for name in [n for n in ds.data_vars if "solute" in ds[n].dims]:
        for s in ds["solute"].values:
            one = ds[name].sel(solute=s).drop_vars("solute")
            one.attrs["long_name"] = f"{one.attrs.get('long_name', name)}: {s}"
            out[column(str(name), str(s))] = one
    return out


def names(ds: xr.Dataset) -> Iterator[str]:
    """Those of the osmotic metrics that a split dataset has, in the order of :data:`TABLE`."""
    for name in TABLE:
        yield from (str(k) for k in ds.data_vars if k == name or str(k).startswith(f"{name}["))
