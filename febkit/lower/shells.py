"""<ShellDomain> to solver blocks: thick elements between the mesh's nodes and back nodes of their own."""

from __future__ import annotations

import numpy as np

from febkit.model import Domain, InputError
from febkit.solver import elements, physics
from febkit.solver.problem import Block

from . import element_types
from .context import Context

#: formulations of <ShellDomain type=> by the material's type; where none is said it is FEBio's choice
MIXTURES = {m: (f"{m}-shell",) for m in ("biphasic", "biphasic-solute", "multiphasic")}
ELASTIC = ("elastic-shell", "three-field-shell", "elastic-shell-eas", "elastic-shell-ans")
AUGMENTED = frozenset({"laugon", "atol", "minaug", "maxaug"})
OPTIONS = frozenset({"shell_thickness", "shell_normal_nodal", "secant_stress", "secant_tangent",
                     "secant_permeability_tangent", "elem_type"})  # fmt: skip


def check(ctx: Context, d: Domain, material: str) -> bool:
    """Refuse what shells of a material cannot do; True where nothing is refused."""
    before, facet = len(ctx.refused), ctx.blocks[d.block].type
    if f"shell_{facet}" not in elements.SHELLS:
        ctx.refuse(f"shell element type {facet}", d.where)
    if material == "triphasic":
        message = f'part "{d.block}": FEBio has no triphasic shells; a multiphasic material does the same'
        raise InputError(message, d.where)
    if d.type and d.type not in (MIXTURES.get(material) or ELASTIC):
        ctx.refuse(f'<ShellDomain type="{d.type}"> of a {material} material', d.where)
    if d.spec is not None:
        ctx.check_tags(d.spec, OPTIONS | AUGMENTED if d.type == "three-field-shell" else OPTIONS)
        leaf = d.spec.child("shell_normal_nodal")
        if leaf is not None and not leaf.as_bool():
            ctx.refuse("<shell_normal_nodal>0</shell_normal_nodal> (directors per element)", leaf.where)
    return len(ctx.refused) == before


def assumed(ctx: Context, d: Domain, block: Block) -> bool:
    """Give a block the physics of assumed strains where its domain asks for it."""
    what = f'<ShellDomain type="{d.type}">'
    if d.type not in ("elastic-shell-eas", "elastic-shell-ans"):
        return False
    if block.element != "quad4":
        ctx.refuse(f"{what} of {block.element}", d.where)
    if any(q.history for q in block.solid.walk()):
        ctx.refuse(f"{what} of a material with a memory", d.where)
    block.physics = physics.load("assumed strain")(d.type == "elastic-shell-eas")
    return True


def three_field(d: Domain, facet: str) -> bool:
    """FEBio's choice for uncoupled materials: three-field on quad4, standard on the others."""
    return d.type == "three-field-shell" or (not d.type and facet == "quad4")


def thickness(ctx: Context, d: Domain, needed: bool = True) -> np.ndarray:
    """Thickness (element, node) of a shell domain: <shell_thickness>, then element data over it.

    ``needed``: it must be positive.
    """
    block = ctx.blocks[d.block]
    out = np.full(block.conn.shape, d.spec.float("shell_thickness", 0.0) if d.spec is not None else 0.0)
    data = [m for m in ctx.model.mesh_data if m.name == "shell thickness"]
    if data:
        rows = ctx.element_map(data, d.block)
        said = ~np.isnan(rows).all(axis=1)
        counts = np.unique((~np.isnan(rows[said])).sum(axis=1))
        width = block.conn.shape[1]
        if any(n not in (1, width) for n in counts):
            bad = next(n for n in counts if n not in (1, width))
            message = f'shell thickness of part "{d.block}": {bad} numbers a row for elements of {width} nodes'
            raise InputError(message, data[0].where)
        rows = rows[said]
        out[said] = rows[:, :width] if rows.shape[1] >= width else rows[:, :1]
        single = np.isnan(out)
        out[single] = np.broadcast_to(out[:, :1], out.shape)[single]
    if needed and not (out > 0).all():
        e = int(block.ids[int(np.argmax((out <= 0).any(axis=1)))])
        where = f"shell element {e} of part \"{d.block}\""
        raise InputError(f"{where} has no positive thickness; give <shell_thickness>", d.where)
    return out


def _check_normals(ctx: Context, b: Block, d: Domain) -> None:
    """Each corner of a shell spans a plane with the nodes next to it; an element without has no normal."""
    x = ctx.model.mesh.X[b.conn]
    n = np.cross(np.roll(x, -1, axis=1) - x, np.roll(x, 1, axis=1) - x)
    size = np.linalg.norm(n, axis=2)
    flat = ~((size > 0) & np.isfinite(size)).all(axis=1)
    if flat.any():
        where = f'shell element {b.ids[int(np.argmax(flat))]} of part "{b.name}"'
        raise InputError(f"{where} has no normal: its nodes lie on a line or in one place", d.where)


def thick(ctx: Context, blocks: list[Block], domains: dict[str, Domain]) -> tuple[np.ndarray, np.ndarray]:
    """Make shell blocks thick, in place; ``domains`` gives the domain of each shell block.

    Returns the nodes (mesh and back) and each mesh node's back node (-1 where it has none).
    """
    shells = [b for b in blocks if b.name in domains]
    for b in shells:
        _check_normals(ctx, b, domains[b.name])
    solids = [b for b in blocks if b.name not in domains and b.element in elements.VOLUMES]
    from febkit.solver.shells import Shell, Solid, thicken  # where a model has shells

    made = thicken(
        ctx.model.mesh.X,
        [Shell(ctx.blocks[b.name].type, b.conn, thickness(ctx, domains[b.name])) for b in shells],
        [Solid(b.element, b.conn) for b in solids],
    )
    if not np.isfinite(made.X).all():
        where = domains[shells[0].name].where
        raise InputError("the thickness of a shell is too large: its back nodes have no position", where)
    for b, conn in zip([*shells, *solids], [*made.shells, *made.solids], strict=True):
        b.conn = conn
    for b in shells:
        b.element = f"shell_{ctx.blocks[b.name].type}"
        b.rule = element_types.rule(ctx, domains[b.name], b.element)
    return made.X, made.back
