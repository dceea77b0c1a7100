"""Solutes and solid-bound molecules of a model's <Globals>, declared in Python."""

from __future__ import annotations

from dataclasses import replace

from febkit.feb.tree import number
from febkit.model import Component, InputError
from febkit.model import Model as Record
from febkit.model.species import solid_bound, solutes

from .sets import missing

SECTIONS = {"solute": "Solutes", "solid_bound": "SolidBoundMolecules"}


def declared(model: Record, kind: str, name: str, charge: int, molar_mass: float, density: float) -> Record:
    """The model with one more species of ``kind``, a key of SECTIONS.

    Raises InputError where the name is taken, the charge number is not whole, or a mass or density is not positive.
    """
    held = solutes(model) if kind == "solute" else solid_bound(model)
    if name in {s.name for s in (*solutes(model), *solid_bound(model))}:
        raise InputError(f"the model has a species {name!r} already")
    if charge != int(charge):
        raise InputError(f"{name}: a charge number is a whole number, not {charge!r}")
    for what, v in (("molar_mass", molar_mass), ("density", density)):
        if not 0.0 < v < float("inf"):
            raise InputError(f"{name}: {what} must be more than 0, not {v!r}")
    values = {"charge_number": float(charge), "molar_mass": molar_mass, "density": density}
    made = Component(
        kind, name=name, id=max((s.id for s in held), default=0) + 1,
        children=tuple(Component(k, text=number(v)) for k, v in values.items()),
    )  # fmt: skip
    return replace(model, unknown=_with(model.unknown, SECTIONS[kind], made))


def _with(sections: tuple[Component, ...], name: str, made: Component) -> tuple[Component, ...]:
    """The model's other sections with ``made`` at the end of the list ``name`` of <Globals>."""
    whole = next((u for u in sections if u.tag == "Globals"), None)
    if whole is None:
        return (*sections, Component("Globals", children=(Component(name, children=(made,)),)))
    table = whole.child(name)
    if table is None:
        new = replace(whole, children=(*whole.children, Component(name, children=(made,))))
    else:
        longer = replace(table, children=(*table.children, made))
        new = replace(whole, children=tuple(longer if c is table else c for c in whole.children))
    return tuple(new if u is whole else u for u in sections)


def number_of(model: Record, name: str) -> int:
    """Number of a solute, from 1. Raises InputError where the model has none of this name."""
    known = {s.name: s.index + 1 for s in solutes(model)}
    if name not in known:
        raise InputError(missing("solute", name, known))
    return known[name]
