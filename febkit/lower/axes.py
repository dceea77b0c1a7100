"""Local material axes and fiber directions: <mat_axis>, <fiber>, and element data of these."""

from __future__ import annotations

from typing import Any

import numpy as np

from febkit.model import Component

from .context import Context


def element_axes(ctx: Context, part: str) -> np.ndarray | None:
    """Axes (m, 3, 3) from <ElementData type="mat_axis"> or "fiber" on a part, or None."""
    for d in ctx.model.mesh_data:
        if d.kind == "element" and d.name in ("mat_axis", "fiber"):
            rows = _rows(ctx, d, part)
            if rows is not None:
                return rows
    return None


def _rows(ctx: Context, data: Any, part: str) -> np.ndarray | None:
    values = ctx.element_map(data, part)
    if np.isnan(values).all():
        return None
    from febkit.solver.solids import axes

    if data.name == "fiber":
        return axes.from_fiber(values[:, :3])
    return axes.from_two(values[:, :3], values[:, 3:6])


def mat_axis(ctx: Context, spec: Component, part: str) -> Any:
    """<mat_axis type=...> as a callable of points giving (1|n, 3, 3)."""
    ctx.refuse(f'<mat_axis type="{spec.type}">', spec.where)
    return None


def direction(ctx: Context, spec: Component, part: str) -> Any:
    """<fiber type=...> as a direction field."""
    ctx.refuse(f'<{spec.tag} type="{spec.type}">', spec.where)
    return None
