"""Stress and permeability by the solver's own materials, for those without a closed form in materials.py."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from febkit.model import InputError, UnsupportedError

if TYPE_CHECKING:
    import xarray as xr

    from febkit.model import Model
    from febkit.solver.multiphasic.material import Mixture
    from febkit.solver.physics.biphasic import Biphasic
    from febkit.solver.points import Points
    from febkit.solver.problem import Block

    from .kinematics import Group
    from .materials import Permeability, Stress, Supply

Floats = NDArray[np.float64]


@dataclass(slots=True, eq=False)
class SolverLaws:
    """Laws of a model's parts, lowered when first asked for. Groups must lie in one part each.

    Raises UnsupportedError for materials that remember their past, or that febkit does not solve.
    """

    model: Model
    ds: xr.Dataset
    _blocks: dict[str, Block] | None = field(default=None, init=False)

    def stress(self, group: Group) -> Stress:
        """Cauchy stress of the solid."""
        block = self._block(group)
        if any(s.history for s in block.solid.walk()):
            raise UnsupportedError(
                f"the material of part {block.name!r} remembers its past: its stress does "
                "not follow from the displacement at one time"
            )

        def law(F: Floats, J: Floats, t: float) -> Floats:
            out = np.zeros((J.size, 6))
            block.solid.stress(self.points(group, F, J, t), out, None)
            return _components_first(out, J)

        return law

    def permeability(self, group: Group) -> Permeability:
        """Spatial permeability of the mixture."""
        block = self._block(group)
        mixture = _mixture(block)
        if mixture is None:
            raise UnsupportedError(f"the material of part {block.name!r} carries no fluid")

        def law(F: Floats, J: Floats, t: float) -> Floats:
            points = self.points(group, F, J, t)
            out = np.zeros((J.size, 6))
            mixture.permeability.permeability(points, mixture.phi0(t, points.X, points.e), out, None)
            return _components_first(out, J)

        return law

    def supply(self, group: Group) -> Supply | None:
        """Solvent supply of the mixture, None where it has none."""
        block = self._block(group)
        mixture = _mixture(block)
        if mixture is None or mixture.supply is None:
            return None
        source = mixture.supply

        def law(F: Floats, J: Floats, p: Floats, t: float) -> Floats:
            out = np.zeros(J.size)
            source.supply(self.points(group, F, J, t), p.T.reshape(-1), out, None, None)
            return np.ascontiguousarray(out.reshape(J.shape[1], J.shape[0]).T)

        return law

    def mixture(self, group: Group) -> Mixture:
        """Fluid, solutes and charges of a part."""
        from febkit.solver.physics.multiphasic import Multiphasic

        block = self._block(group)
        if not isinstance(block.physics, Multiphasic):
            raise UnsupportedError(f"the material of part {block.name!r} carries no solutes")
        return block.physics.mixture

    def _block(self, group: Group) -> Block:
        if self._blocks is None:
            from febkit.lower.context import Context
            from febkit.lower.materials import blocks

            context = Context(self.model)
            self._blocks = {b.name: b for b in blocks(context)}
        if group.material not in self._blocks:
            raise UnsupportedError(f"febkit has no law for the material of part {group.material!r}")
        return self._blocks[group.material]

    def points(self, group: Group, F: Floats, J: Floats, t: float) -> Points:
        """Points element by element, as the solver orders them."""
        from febkit.solver.points import Points

        block = self._block(group)
        g = J.shape[0]
        e = np.repeat(self._index(group, block), g)
        axes = block.axes
        if axes is not None:
            axes = axes[e] if axes.ndim == 3 else axes[e, np.tile(np.arange(g), J.shape[1])]
        X = group.at_points(group.x0).transpose(2, 1, 0).reshape(-1, 3)
        f = np.ascontiguousarray(F.transpose(3, 2, 0, 1)).reshape(-1, 3, 3)
        return Points(f, J.T.reshape(-1).copy(), np.ascontiguousarray(X), e, t=t, Q=axes)

    def _index(self, group: Group, block: Block) -> NDArray[np.int64]:
        """Place of each element in its block, by the file's element ids."""
        ids = np.asarray(self.ds["element_id"].values)[group.rows]
        order = np.argsort(block.ids, kind="stable")
        at = order[np.searchsorted(block.ids[order], ids).clip(max=len(order) - 1)]
        if (block.ids[at] != ids).any():
            raise InputError(f"the model's part {block.name!r} has other elements than the result's")
        return np.asarray(at)


def _mixture(block: Block) -> Biphasic | None:
    """The physics of a block with a fluid, None where it has none."""
    from febkit.solver.physics.biphasic import Biphasic

    return block.physics if isinstance(block.physics, Biphasic) else None


def _components_first(v: Floats, J: Floats) -> Floats:
    """(6, g, e) of rows (e*g, 6)."""
    return np.ascontiguousarray(v.reshape(J.shape[1], J.shape[0], 6).transpose(2, 1, 0))
