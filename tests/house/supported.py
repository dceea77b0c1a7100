"""The lists of docs/features.md, from FEBio's table and those the solver itself looks into. ``--write`` renews them."""

from __future__ import annotations

import sys
from itertools import groupby
from pathlib import Path

PAGE = Path(__file__).parents[2] / "docs" / "features.md"
START, END = "<!-- supported: start -->", "<!-- supported: end -->"


def lists() -> str:
    """Markdown of what the solver knows."""
    from febkit.lower import CONSTRAINTS
    from febkit.lower.beams import KINDS as BEAMS
    from febkit.lower.conditions import READERS
    from febkit.lower.connectors import KINDS
    from febkit.lower.rigid import READERS as RIGID
    from febkit.lower.ties import LAWS
    from febkit.solver import (
        contact,
        diffusivities,
        elements,
        loads,
        membrane_rates,
        membrane_reactions,
        osmotic_coefficients,
        permeabilities,
        reaction_rates,
        reactions,
        solubilities,
        solute_supplies,
        supplies,
    )
    from febkit.solver.solids.registry import tables

    rows = {
        "solids": sorted(tables()["solid"]),
        "permeabilities": sorted(permeabilities.TYPES),
        "solvent supplies": sorted(supplies.TYPES),
        "diffusivities": sorted(diffusivities.TYPES),
        "solubilities": sorted(solubilities.TYPES),
        "osmotic coefficients": sorted(osmotic_coefficients.TYPES),
        "solute supplies": sorted(solute_supplies.TYPES),
        "reactions": sorted(reactions.TYPES),
        "reaction rates": sorted(reaction_rates.TYPES),
        "membrane reactions": sorted(membrane_reactions.TYPES),
        "rates of membrane reactions": sorted(membrane_rates.TYPES),
        "loads": sorted(loads.TYPES),
        "boundary conditions": sorted([*READERS, "linear constraint", "rigid"]),
        "constraints": sorted(CONSTRAINTS),
        "contact": sorted(contact.TYPES),
        "rigid bodies": sorted({kind for _, kind in RIGID} | set(KINDS)),
        "springs": sorted(LAWS),
        "elements": list(elements.VOLUMES),
        "beams and trusses": sorted(BEAMS),
        "shells": [s.removeprefix("shell_") for s in elements.SHELLS],
    }
    out = ["| | |", "|---|---|"]
    out += [f"| {name} ({len(items)}) | {', '.join(items)} |" for name, items in rows.items()]
    return "\n".join(out)


def beside() -> str:
    """Markdown of FEBio's types by kind, those that febkit solves and those that it does not."""
    from febkit.census import census
    from febkit.model.reasons import reason

    out = []
    for kind, entries in groupby(census(), lambda e: e.kind):
        found = sorted(entries, key=lambda e: e.name.lower())
        has, lacks = ([e.name for e in found if e.solved is said] for said in (True, False))
        lacks = [f"{n} ({reason(n)})" if reason(n) else n for n in lacks]
        out += [f"### {kind}: {len(has)} of {len(found)}", ""]
        out += [f"Solved: {_listed(has)}", "", f"Not: {_listed(lacks)}", ""]
    return "\n".join(out).rstrip()


def _listed(names: list[str]) -> str:
    return ", ".join(n.replace("|", r"\|").replace("<", r"\<") for n in names) or "none"


def renewed(text: str) -> str:
    """The page with its lists as they should be."""
    head, rest = text.split(START)
    _, tail = rest.split(END)
    return f"{head}{START}\n{lists()}\n\n## Type by type\n\n{beside()}\n{END}{tail}"


if __name__ == "__main__":
    new = renewed(PAGE.read_text())
    if "--write" in sys.argv:
        PAGE.write_text(new)
    else:
        print(lists(), beside(), sep="\n\n")
