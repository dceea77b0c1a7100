"""<constraint type="prestrain"> and "in-situ stretch": how prestrains of materials are corrected."""

from __future__ import annotations

from febkit.model import Component
from febkit.solver.fields import DISPLACEMENT
from febkit.solver.loads.prestrain import PrestrainCorrection, StretchCorrection
from febkit.solver.problem import Step

from .context import Context

TAGS = frozenset({"update", "tolerance", "min_iters", "max_iters"})


def constraint(ctx: Context, out: Step, c: Component) -> None:
    """Of all solid parts whose material is strained in the reference; of mixtures none, as in FEBio."""
    stretch = c.type == "in-situ stretch"
    ctx.check_tags(c, TAGS | {"max_stretch", "isochoric"} if stretch else TAGS)
    solids = [b.solid for b in ctx.made if hasattr(b.solid, "correctable") and b.physics.fields == (DISPLACEMENT,)]
    for solid in solids:
        solid.correctable()
    given = _flag(c, "update"), c.float("tolerance", 0.0), c.int("min_iters", 0), c.int("max_iters", -1)
    if stretch:
        out.loads.append(StretchCorrection(*given, c.float("max_stretch", 0.0), _flag(c, "isochoric")))
    else:
        out.loads.append(PrestrainCorrection(*given))


def _flag(c: Component, tag: str) -> bool:
    """A flag that is set where it is not given."""
    return c.child(tag) is None or c.bool(tag)
