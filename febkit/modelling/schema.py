"""What FEBio knows about a component: its parameters, their defaults, ranges and choices.

The names are those of :mod:`febkit.feb.features`, ranges those of :mod:`febkit.model.ranges`; defaults come from the
solver's own records, so that a new material appears by itself.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import MISSING, fields, is_dataclass
from keyword import iskeyword
from math import isfinite
from typing import Any

from febkit.feb.check_features import KINDS, VALUES
from febkit.feb.features import anywhere, table
from febkit.model import Component, ranges

__all__ = ["VALUES", "attribute", "choices", "default", "is_numeric", "out_of_range", "parameters", "record", "tag"]


def parameters(c: Component) -> set[str]:
    """Tags that FEBio knows below a component; empty where it is not known."""
    if c.tag == "Control":
        return set(frozenset().union(*table()["analysis"].values())) | {"time_stepper", "solver"}
    kind = "solver" if c.tag == "solver" else KINDS.get(c.tag)
    if c.type is None and c.tag in ("solute", "solid_bound"):  # properties that are their own type
        return set(table()["other"][c.tag])
    own = {} if kind is None else table()[kind]
    return set(own.get(c.type or "") or anywhere().get(c.type or "", frozenset()))


def attribute(tag: str) -> str:
    """The Python name of a tag."""
    name = tag.replace(" ", "_").replace("-", "_")
    return name + "_" if iskeyword(name) else name


def tag(name: str, known: Iterable[str]) -> str | None:
    """The tag of a Python name, None where there is none."""
    return next((t for t in known if name in (t, attribute(t))), None)


def record(c: Component) -> Any:
    """The solver's class of a material or property, None where it has none. Imports that one file."""
    from febkit.solver.solids import registry

    kind = c.type or c.tag
    for laws in mixture_laws():
        if laws.known(kind):
            return laws.load(kind)
    for name in registry.tables():
        if registry.known(name, kind):
            return registry.load(name, kind)
    return None


def mixture_laws() -> tuple[Any, ...]:
    """Registries of the laws of fluids and solutes."""
    from febkit.solver import (
        diffusivities,
        membrane_rates,
        osmotic_coefficients,
        permeabilities,
        reaction_rates,
        solubilities,
        solute_supplies,
        supplies,
    )

    solutes = diffusivities, solubilities, osmotic_coefficients, solute_supplies, reaction_rates, membrane_rates
    return permeabilities, supplies, *solutes


def _field(tag_: str) -> str:
    from febkit.solver.solids import registry

    return registry.field_name(tag_)


def default(c: Component, tag_: str) -> Any:
    """FEBio's default of a parameter that the model does not give; None where it has none."""
    cls = record(c)
    if cls is None:
        return None
    own = {f.name: f.default for f in fields(cls)} if is_dataclass(cls) else {}
    value = own.get(_field(tag_), MISSING) if _field(tag_) in (*cls.parameters, *cls.options) else MISSING
    return None if value is MISSING else value


def is_numeric(c: Component, tag_: str) -> bool:
    """May the parameter be a formula?"""
    cls = record(c)
    return cls is not None and _field(tag_) in cls.parameters


def out_of_range(c: Component, tag_: str, value: float) -> str:
    """What a number must be where FEBio refuses it; empty where it takes it."""
    if not isfinite(value):
        return "a finite number"
    kind = {"Control": "(control)", "solver": "(solver)"}.get(c.tag, c.type or c.tag)
    limit = ranges.of(kind).get(tag_)
    return "" if limit is None or limit.holds(value) else limit.said


def choices(c: Component, tag_: str) -> tuple[str, ...]:
    """The words that a parameter may be; empty where any will do."""
    if c.tag == "Control" and tag_ == "analysis":
        return ("STATIC", "STEADY-STATE", "TRANSIENT", "DYNAMIC")
    return ()
