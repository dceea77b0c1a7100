"""The lists of the README, from the tables the solver itself looks into. ``--write`` renews them."""

from __future__ import annotations

import sys
from pathlib import Path

README = Path(__file__).parents[2] / "README.md"
START, END = "<!-- supported: start -->", "<!-- supported: end -->"


def lists() -> str:
    """Markdown of what the solver knows."""
    from febkit.lower import CONSTRAINTS
    from febkit.lower.beams import KINDS as BEAMS
    from febkit.lower.conditions import READERS
    from febkit.lower.connectors import KINDS
    from febkit.lower.materials import UNPROVEN
    from febkit.lower.rigid import READERS as RIGID
    from febkit.lower.ties import LAWS
    from febkit.solver import (
        contact,
        diffusivities,
        elements,
        loads,
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
        "solids": sorted(set(tables()["solid"]) - UNPROVEN),
        "permeabilities": sorted(permeabilities.TYPES),
        "solvent supplies": sorted(supplies.TYPES),
        "diffusivities": sorted(diffusivities.TYPES),
        "solubilities": sorted(solubilities.TYPES),
        "osmotic coefficients": sorted(osmotic_coefficients.TYPES),
        "solute supplies": sorted(solute_supplies.TYPES),
        "reactions": sorted(reactions.TYPES),
        "reaction rates": sorted(reaction_rates.TYPES),
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


def renewed(text: str) -> str:
    """The README with its lists as they should be."""
    head, rest = text.split(START)
    _, tail = rest.split(END)
    return f"{head}{START}\n{lists()}\n{END}{tail}"


if __name__ == "__main__":
    new = renewed(README.read_text())
    if "--write" in sys.argv:
        README.write_text(new)
    else:
        print(lists())
