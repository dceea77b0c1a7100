"""<Loads> to solver loads."""

from __future__ import annotations

from typing import Any

from febkit.model import Component

from .context import Context


def loads(ctx: Context, specs: tuple[Component, ...]) -> tuple[list[Any], list[Any]]:
    """(surface and nodal loads, body loads)."""
    for c in specs:
        ctx.refuse(f'<{c.tag} type="{c.type}">', c.where)
    return [], []
