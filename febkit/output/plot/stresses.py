"""Stresses and elasticities at integration points: (m, g, 6) of symmetric tensors, else (m, g[, 9 | 21])."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from febkit.solver.points import Points
from febkit.solver.solids.uncoupled import Uncoupled, distortional

from . import laws
from .base import Floats, Part, at_nodes, full, mean, of_solids, register, shared, voigt

# places of the 21 components of a fourth-order tensor with all symmetries, as FEBio stores them (upper triangle,
# column after column, of the 6 x 6 matrix over xx yy zz xy yz xz)
UPPER = tuple((i, j) for j in range(6) for i in range(j + 1))


@shared
def cauchy(part: Part) -> Floats | None:
    """Stress sigma (m, g, 3, 3); of mixtures with the fluid's pressure."""
    s = part.at_points("stress")
    return None if s is None else full(s)


@shared
def inverse(part: Part) -> Floats:
    """F^-1 (m, g, 3, 3)."""
    return np.asarray(np.linalg.inv(part.g.F), float)


def first(part: Part) -> Floats | None:
    """First Piola-Kirchhoff stress P = J sigma F^-T (m, g, 9), by rows."""
    s = cauchy(part)
    if s is None:
        return None
    P = part.g.J[..., None, None] * np.einsum("egik,egjk->egij", s, inverse(part))
    return P.reshape(*P.shape[:2], 9)


def second(part: Part) -> Floats | None:
    """Second Piola-Kirchhoff stress S = J F^-1 sigma F^-T."""
    s, Fi = cauchy(part), inverse(part)
    if s is None:
        return None
    return voigt(part.g.J[..., None, None] * np.einsum("egik,egkl,egjl->egij", Fi, s, Fi))


def norm(part: Part) -> Floats | None:
    """sqrt(sigma : sigma) of the mean stress of each element (m,)."""
    s = part.at_points("stress") if part.group is not None else None
    if s is None:
        return None
    mean_stress = s.mean(axis=1)
    return np.sqrt((mean_stress[:, :3] ** 2).sum(axis=1) + 2.0 * (mean_stress[:, 3:] ** 2).sum(axis=1))


def pressure(part: Part) -> Floats | None:
    """-U'(J) of an uncoupled solid, positive where it is compressed; of the element where it has one pressure."""
    law, own = part.g.block.solid, getattr(part.g.physics, "ep", None)
    if not isinstance(law, Uncoupled):
        return None
    if own is not None:
        return -np.broadcast_to(own[:, None], part.g.J.shape)
    pts = part.points()
    return -part.shaped(law.pressure(pts.J, pts))


def elasticity(part: Part) -> Floats:
    """Spatial elasticity of the solid (m, g, 21)."""
    return upper(part, laws.tangent(part.g.block.solid.stress, part.points()))


def distortional_elasticity(part: Part) -> Floats | None:
    """Spatial elasticity of the distortional stress of an uncoupled solid (m, g, 21)."""
    law = part.g.block.solid
    return upper(part, laws.tangent(distortional(law), part.points())) if isinstance(law, Uncoupled) else None


def upper(part: Part, c: Floats) -> Floats:
    """Elasticities (n, 6, 6) of all points as FEBio stores them (m, g, 21)."""
    return part.shaped(np.stack([c[:, i, j] for i, j in UPPER], axis=-1))


def of_component(part: Part, which: str = "") -> Floats | None:
    """Stress of a solid of a mixture."""
    found = laws.component(part, which)
    if found is None:
        return None
    inside = isinstance(part.g.block.solid, Uncoupled)
    return part.shaped(laws.share(*found) if inside else laws.stress(*found))


def weight(part: Part) -> Floats | None:
    """Weight of the first solid of a mixture, 1 in all files."""
    return np.ones_like(part.g.J) if type(part.g.block.solid).__name__ == "SolidMixture" else None


def of_tets(part: Part) -> Floats | None:
    """Stress at the nodes of tetrahedra integrated there (node, 6)."""
    from febkit.solver.physics.nodal_tets import NodalWork

    work = None if part.group is None else part.g.physics
    if not isinstance(work, NodalWork):
        return None
    return np.asarray(work.sn[np.searchsorted(work.nodes, part.mesh.nodes())])


# ---- stresses of yield and damage criteria --------------------------------------------------------------
class _Given:
    """A law whose stress is given (n, 6), as criteria want one."""

    def __init__(self, given: Floats) -> None:
        self.given = given

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        s += self.given


def of_criterion(name: str) -> Callable[[Part], Floats | None]:
    """The stress measured by the first criterion of this class in the law."""

    def points(part: Part) -> Floats | None:
        found, s = criterion(part, name), part.at_points("stress")
        if found is None or s is None:
            return None
        return part.shaped(found.of(_Given(s.reshape(-1, 6)), part.points()))

    return points


def criterion(part: Part, name: str) -> Any:
    """The first criterion of a class in the law of a part, None where there is none."""
    every = (field for law in part.g.block.solid.walk() for field in vars(law).values())
    return next((field for field in every if type(field).__name__ == name), None)


register("PK1 stress", mean(first))
register("PK2 stress", mean(second))
register("s norm", norm)
register("uncoupled pressure", mean(pressure))
register("elasticity", mean(elasticity))
register("deviatoric elasticity", mean(distortional_elasticity))
register("mixture stress", mean(of_component), more=True)
register("volume fraction", mean(weight))
register("nodal stress", at_nodes(of_solids(lambda part: part.at_points("stress"))))
register("ut4 nodal stress", of_tets)
register("Drucker shear stress", mean(of_criterion("Drucker")))
register("Drucker-Prager stress", mean(of_criterion("DruckerPrager")))
register("Deshpande-Fleck stress", mean(of_criterion("DeshpandeFleck")))
