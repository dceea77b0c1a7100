"""Membranes: shells of mixtures that react with the mixtures on their two faces."""

from __future__ import annotations

from typing import Any

import numpy as np

from febkit.model import Domain, InputError
from febkit.model.species import solutes
from febkit.solver import elements
from febkit.solver.multiphasic.membrane import MembraneFlux
from febkit.solver.problem import Block

from .context import Context

SIDES = ("in front of", "behind")


def fluxes(ctx: Context, blocks: list[Block], domains: dict[str, Domain]) -> list[MembraneFlux]:
    """What parts with membrane reactions exchange with their faces. Raises InputError where a face lacks a solute."""
    out = []
    for number, b in enumerate(blocks):
        mixture = getattr(b.physics, "mixture", None)
        if mixture is not None and mixture.membrane:
            if b.name not in domains:
                part = next(d for d in ctx.model.domains if d.block == b.name)
                raise InputError(f'part "{b.name}" has membrane reactions but no shells', part.where)
            out.append(_flux(ctx, blocks, number, domains[b.name]))
    return out


def _flux(ctx: Context, blocks: list[Block], number: int, d: Domain) -> MembraneFlux:
    b, species = blocks[number], solutes(ctx.model)
    n = b.conn.shape[1] // 2
    corners = elements.shape(b.element.removeprefix("shell_")).corners
    faces = _faces(blocks, b.conn)
    meets = np.zeros((len(b.conn), 2, len(species)), bool)
    needed = _needed(b.physics, len(species))
    for e, nodes in enumerate(b.conn.tolist()):
        for side, facet in enumerate((nodes[n : n + corners], nodes[:corners])):
            there = faces.get(tuple(sorted(facet)), ())
            meets[e, side, list(there)] = True
            lacks = np.flatnonzero(needed[side] & ~meets[e, side])
            if len(lacks):
                what = f'the solute "{species[lacks[0]].name}", which a membrane reaction needs there'
                element = f'shell element {b.ids[e]} of part "{b.name}"'
                raise InputError(f"{element}: no mixture {SIDES[side]} it has {what}", d.where)
    return MembraneFlux(number, meets)


def _needed(physics: Any, count: int) -> np.ndarray:
    """Which solutes reactions name on each face (2, M), in front and behind."""
    out = np.zeros((2, count), bool)
    for r in physics.mixture.membrane:
        out |= (r.reactants_outside + r.products_outside) > 0
        for rate in r.rates:
            if hasattr(rate, "sol"):
                out[:, rate.sol] = True
    return out


def _faces(blocks: list[Block], shells: np.ndarray) -> dict[tuple[int, ...], tuple[int, ...]]:
    """The solutes of the multiphasic solid at each face that nodes of shells make, by the face's corners."""
    on = np.zeros(1 + max(int(b.conn.max()) for b in blocks), bool)
    on[shells] = True
    out: dict[tuple[int, ...], tuple[int, ...]] = {}
    for b in blocks:
        mixture = getattr(b.physics, "mixture", None)
        if mixture is None or b.element.startswith("shell_"):
            continue
        have = tuple(s.index for s in mixture.solutes)
        for kind, local in elements.get(b.element).facets:
            facets = b.conn[:, list(local[: elements.shape(kind).corners])]
            for nodes in facets[on[facets].all(axis=1)].tolist():
                out[tuple(sorted(nodes))] = have
    return out
