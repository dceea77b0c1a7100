"""The solutes and solid-bound molecules that a model lists in its <Globals>."""

from __future__ import annotations

from dataclasses import replace

from febkit.record import value_record

from . import values
from .component import Component
from .model import Model
from .source import InputError, Where


@value_record
class Species:
    """A solute or solid-bound molecule of <Globals>; ``index``: its place in the tuple it comes in, from 0."""

    name: str
    id: int
    index: int
    charge: int
    molar_mass: float
    density: float


def solutes(model: Model) -> tuple[Species, ...]:
    """The solutes of <Globals> in the order of their ids, whatever the file's: that of id k has the degree of
    freedom c<k>. Raises InputError where ids are not 1, 2, ...: FEBio would take degrees of freedom that are not there.
    """
    found = _species(model, "Solutes", "solute")
    if sorted(s.id for s in found) != list(range(1, len(found) + 1)):
        said, first = ", ".join(str(s.id) for s in found), _listed(model, "Solutes", "solute")[0]
        raise InputError(f"the ids of {len(found)} solutes must be 1 to {len(found)}, not {said}", first.where)
    return tuple(replace(s, index=s.id - 1) for s in sorted(found, key=lambda s: s.id))


def dof(model: Model, name: str) -> str:
    """A degree of freedom by FEBio's name, or by that of the solute whose effective concentration it is."""
    return next((f"c{s.id}" for s in solutes(model) if s.name == name), name)


def solid_bound(model: Model) -> tuple[Species, ...]:
    """The solid-bound molecules of <Globals>, in file order."""
    return _species(model, "SolidBoundMolecules", "solid_bound")


def _listed(model: Model, section: str, tag: str) -> list[Component]:
    return [c for u in model.unknown if u.tag == "Globals" for table in u.all(section) for c in table.all(tag)]


def _species(model: Model, section: str, tag: str) -> tuple[Species, ...]:
    found: list[Species] = []
    for k, c in enumerate(_listed(model, section, tag)):
        charge = c.child("charge_number")
        s = Species(
            c.name or f"{tag} {c.id or k + 1}", c.id or k + 1, k, 0 if charge is None else charge.as_int(),
            c.float("molar_mass", 1.0), c.float("density", 1.0),
        )  # fmt: skip
        if s.density <= 0.0 or s.molar_mass <= 0.0:
            raise InputError(f'{tag} "{s.name}": density and molar_mass must be more than 0', c.where)
        found.append(s)
    return tuple(found)


def find(species: tuple[Species, ...], ref: str, what: str, where: Where | None) -> Species:
    """A species by its name, or by its id. Raises InputError, naming those there are."""
    named = {s.name: s for s in species}
    if ref in named:
        return named[ref]
    by_id = {str(s.id): s for s in species}
    if ref.strip() in by_id:
        return by_id[ref.strip()]
    raise InputError(f'there is no {what} "{ref}" in <Globals>' + values.near(ref, named), where)
