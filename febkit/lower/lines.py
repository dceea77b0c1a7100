"""<constraint type="tied-line"> and <constraint type="slide-line">: edges held to edges."""

from __future__ import annotations

from typing import Any

import numpy as np

from febkit.model import Component, InputError
from febkit.model.sets import missing
from febkit.solver.contact.lines import SlideLine, TiedLine
from febkit.solver.problem import Step

from .context import Context

METHODS = {"penalty": False, "auglag": True, "0": False, "1": True}
COMMON = {"laugon", "tolerance", "penalty", "minaug", "maxaug", "primary", "secondary"}


def constraint(ctx: Context, out: Step, c: Component) -> None:
    """The edges <primary> and <secondary> of lines of two nodes."""
    slides = c.type == "slide-line"
    ctx.check_tags(c, COMMON | ({"gaptol", "seg_up"} if slides else {"max_distance"}))
    first, second = _edge(ctx, c, "primary"), _edge(ctx, c, "secondary")
    kw: dict[str, Any] = {
        "penalty": ctx.value(c.need("penalty")) if slides else ctx.value(c.child("penalty"), 1.0),
        "laugon": c.choice("laugon", METHODS, False), "tolerance": c.float("tolerance", 0.0 if slides else 0.01),
        "minaug": c.int("minaug", 0), "maxaug": c.int("maxaug", 10),
    }  # fmt: skip
    if ctx.refused:
        return
    if slides:
        out.contacts.append(SlideLine(first, second, gaptol=c.float("gaptol", 0.0), seg_up=c.int("seg_up", 0), **kw))
    else:
        out.contacts.append(TiedLine(first, second, max_distance=c.float("max_distance", 0.0), **kw))


def _edge(ctx: Context, c: Component, tag: str) -> np.ndarray:
    """Lines (k, 2) of the edge that ``tag`` names."""
    leaf, edges = c.need(tag), ctx.model.mesh.edges
    name = leaf.text.strip()
    if name not in edges:
        raise missing("edge", name, edges, leaf.where)
    lines = np.asarray(edges[name].lines, np.int64)
    if not len(lines):
        raise InputError(f'{c.what}: the edge "{name}" has no lines', leaf.where)
    if lines.shape[1] != 2:
        ctx.refuse(f'<constraint type="{c.type}"> on lines of {lines.shape[1]} nodes', leaf.where)
    return lines
