"""One chondron in a block of extracellular matrix of its own: three superellipsoids, one O-grid, hexahedra."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from .cell_cube import block, named, volume_report
from .cells import Chondron, make_chondrons, rotations
from .parts import Parts
from .places import steps
from .quality import volumes
from .superellipsoids import Superellipsoid


@dataclass(frozen=True, slots=True, eq=False)
class ChondronBlock:
    """The mesh, its chondron, and the exact body of cell, PCM and ECM together."""

    mesh: Parts
    chondron: Chondron
    whole: Superellipsoid

    def report(self) -> dict[str, float]:
        """Volume fractions and thickness of the PCM."""
        meshed = sum(float(volumes(self.mesh.X, *part).sum()) for part in self.mesh.parts.values())
        return volume_report(self.mesh, [self.chondron], self.whole.volume, meshed)


def chondron_block(p: dict[str, Any]) -> ChondronBlock:
    """Build the block from the template's parameters (see templates/chondron/template.toml).

    The ECM's surface is the PCM's, enlarged about its middle until the ECM has its share of the volume.
    """
    chondron = make_chondrons(p | {"orientation": "aligned"}, 1, np.random.default_rng(int(p["seed"])))[0]
    enlarged = (1.0 - float(p["ecm_share"])) ** (-1.0 / 3.0)
    whole = replace(chondron.pcm, semi_axes=chondron.pcm.semi_axes * enlarged)
    nx, ny, nz = (int(m) for m in np.array(p["divisions"]) * steps([chondron])[0])
    a, b, c = (int(m) for m in p["layers"])
    made = block(chondron, (nx, ny, nz), (a, b, c), np.zeros(3), whole, float(p["growth"]))
    R = rotations(1, p["orientation"], np.random.default_rng(int(p["seed"])))[0]
    return ChondronBlock(Parts(made.X @ R.T, named(made.ecm, [made.pcm], list(made.cells))), chondron, whole)
