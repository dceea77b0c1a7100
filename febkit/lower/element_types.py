"""The integration rule that a domain asks for: FEBio's elem_type, such as TET10G4 or QUAD4G12."""

from __future__ import annotations

from febkit.model import Domain, InputError
from febkit.solver import elements

from .context import Context


def rule(ctx: Context, d: Domain, element: str) -> str | None:
    """Name of the rule among those of ``element`` ("tet10", "shell_quad4"), None for FEBio's choice.

    FEBio reads an attribute; febkit a child of this name too. HEX8G1 stands for elements of another formulation.
    """
    if d.spec is None:
        return None
    asked = d.spec.attrs.get("elem_type") or (d.spec.str("elem_type") if d.spec.child("elem_type") else "")
    if asked in ("", "default") or element not in (*elements.VOLUMES, *elements.SHELLS):
        return None
    name, found, facets = elements.from_spec(asked)
    own, known = element.removeprefix("shell_"), elements.shape(element).rules
    if name != own:
        choice = ", ".join(f"{own.upper()}{r}" for r in known)
        raise InputError(f'elem_type "{asked}" of part "{d.block}": elements of type {own} have {choice}', d.where)
    others = [f for f, r in facets.items() if r != next(iter(elements.shape(f).rules))]
    if asked == "HEX8G1" or found not in known or others:
        ctx.refuse(f'elem_type="{asked}"', d.where)
        return None
    return found
