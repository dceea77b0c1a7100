"""One chondron in a block of extracellular matrix of its own: three superellipsoids, one O-grid, hexahedra."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from .cells import Chondron, make_chondrons, rotations
from .ogrid import block_nodes, pattern, unit
from .parts import Parts
from .superellipsoids import Superellipsoid


@dataclass(frozen=True, slots=True, eq=False)
class ChondronBlock:
    """The mesh, its chondron, and the exact body of cell, PCM and ECM together."""

    mesh: Parts
    chondron: Chondron
    whole: Superellipsoid


def chondron_block(p: dict[str, Any]) -> ChondronBlock:
    """Build the block from the template's parameters (see templates/chondron/template.toml).

    The ECM's surface is the PCM's, enlarged about its middle until the ECM has its share of the volume.
    """
    chondron = make_chondrons(p | {"orientation": "aligned"}, 1, np.random.default_rng(int(p["seed"])))[0]
    enlarged = (1.0 - float(p["ecm_share"])) ** (-1.0 / 3.0)
    whole = replace(chondron.pcm, semi_axes=chondron.pcm.semi_axes * enlarged)
    nx, ny, nz = (int(m) for m in p["divisions"])
    a, b, c = (int(m) for m in p["layers"])
    grid = pattern((nx, ny, nz), (a, b, c))
    skin = whole.surface(unit(grid.parameters[grid.skin]))
    X = np.concatenate([block_nodes(grid, np.zeros(3), chondron, skin, float(p["growth"])), skin])
    R = rotations(1, p["orientation"], np.random.default_rng(int(p["seed"])))[0]
    parts = {"ecm": ("hex8", grid.ecm), "pcm_1": ("hex8", grid.pcm), "cell_1": ("hex8", grid.cell)}
    return ChondronBlock(Parts(X @ R.T, parts), chondron, whole)
