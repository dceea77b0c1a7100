"""<MeshAdaptor>: elements that are eroded, and what adaptors choose elements by."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from febkit.model import Component
from febkit.model.sets import element_ids
from febkit.solver import criteria as records
from febkit.solver.erosion import Erosion
from febkit.solver.problem import Step

from .context import Context

SURFACES = {k: k for k in ("no", "yes", "grow", "reconstruct")}
SURFACES |= {str(i): k for i, k in enumerate(("no", "yes", "grow", "reconstruct"))}
METRICS = ("von Mises stress", "largest deviatoric stress")  # by <metric>
TAGS = {"stress": {"metric"}, "max_variable": {"dof"}, "math": {"math"}}
DOFS = {"0": "x", "1": "y", "2": "z"}  # FEBio's numbers of unknowns
MEASURES = ("stress", "damage", "relative volume", "max_variable", "math")


def erosion(ctx: Context, c: Component) -> Erosion:
    """<mesh_adaptor type="erosion">."""
    ctx.check_tags(c, {"max_iters", "max_elems", "sort", "remove_islands", "erode_surfaces", "criterion"})
    surfaces = c.choice("erode_surfaces", SURFACES, "yes")
    if surfaces in ("no", "reconstruct"):
        ctx.refuse(f"<erode_surfaces>{surfaces}</erode_surfaces>", c.need("erode_surfaces").where)
    own = among(ctx, c)
    return Erosion(
        criterion(ctx, c.need("criterion"), own), c.int("max_iters", -1), c.int("max_elems", 0), c.int("sort", 0),
        c.bool("remove_islands"), own, surfaces == "grow",
    )  # fmt: skip


def among(ctx: Context, c: Component) -> dict[str, np.ndarray] | None:
    """The elements of ``elem_set`` by part; None: all."""
    where = c.attrs.get("elem_set", "")
    if not where:
        return None
    ids = element_ids(ctx.model.mesh, where, c.where)
    return {b.name: np.flatnonzero(np.isin(b.ids, ids)) for b in ctx.made}


def owners(ctx: Context, steps: list[Step]) -> None:
    """Surfaces in contact know the elements behind their facets."""
    from .contact import find_owners

    for contact in (q for s in steps for q in s.contacts):
        for side in (contact.primary, contact.secondary):
            if not side.owner:
                find_owners(ctx, side)


def criterion(ctx: Context, c: Component, own: dict[str, np.ndarray] | None = None) -> records.Criterion:
    """What <criterion> selects, among the elements ``own``. One that has a value for every element selects them all, as
    in FEBio."""
    if c.type == "min-max filter":
        return records.Range(_of_elements(ctx, c.need("data")), *_filter(ctx, c))
    if c.type in (*MEASURES, "element data"):
        return records.Range(_of_elements(ctx, c))
    if c.type == "element_selection":
        ctx.check_tags(c, {"value", "element_list"})
        return records.Listed(np.array(c.need("element_list").as_floats(), np.int64), c.float("value", 1.0))
    if c.type == "relative error":
        ctx.check_tags(c, {"error", "data"})
        return records.RelativeError(_measure(ctx, c.need("data")), c.float("error", 0.0), own)
    if c.type == "contact gap":
        ctx.check_tags(c, {"gap"})
        return records.Overlap(c.float("gap", 0.0))
    ctx.refuse(f'<{c.tag} type="{c.type}"> of <mesh_adaptor>', c.where)
    return records.Listed(np.zeros(0, np.int64))


def _of_elements(ctx: Context, c: Component) -> Callable[..., records.Floats | None]:
    """What is measured of elements: the mean over their points."""
    if c.type != "element data":
        return _measure(ctx, c)
    ctx.check_tags(c, {"element_data"})
    leaf = c.need("element_data")
    found = records.ITEMS.get(leaf.text.strip())
    if found is None:
        known = ", ".join(records.ITEMS)
        ctx.refuse(f"<element_data>{leaf.text.strip()}</element_data> (known are {known})", leaf.where)
    return found or records.relative_volume


def _filter(ctx: Context, c: Component) -> tuple[float, float, bool]:
    """Least and largest value, and whether others are cut to these rather than left out."""
    ctx.check_tags(c, {"min", "max", "clamp", "data"})
    return c.float("min", -1e37), c.float("max", 1e37), c.bool("clamp", True)


def _measure(ctx: Context, c: Component) -> Callable[..., records.Floats | None]:
    """What is measured at integration points."""
    if c.type == "min-max filter":
        least, most, clamp = _filter(ctx, c)
        return records.clipped(_measure(ctx, c.need("data")), least, most) if clamp else _measure(ctx, c.need("data"))
    if c.type not in MEASURES:
        ctx.refuse(f'<{c.tag} type="{c.type}"> of <mesh_adaptor>', c.where)
        return records.relative_volume
    ctx.check_tags(c, TAGS.get(c.type, set()))
    name = c.type
    if name == "max_variable":
        dof = c.need("dof")
        return records.variable(ctx.column(DOFS.get(dof.text.strip(), dof.text.strip()), dof))
    if name == "math":
        return records.given(ctx.value(c.need("math")))
    if name == "stress":
        name = METRICS[c.choice("metric", {"0": 0, "1": 1}, 0)]
    return records.MEASURES[name]
