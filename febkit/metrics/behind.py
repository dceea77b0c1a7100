"""Elements behind shells, such as those of a cell in its membrane: which of their nodes are the shells' back nodes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from febkit.results.mesh import texts

if TYPE_CHECKING:
    import xarray as xr

Ints = NDArray[np.int64]


def solid_elements(ds: xr.Dataset) -> NDArray[np.bool_]:
    """(element,) True for solid elements, False for shells, beams and trusses."""
    solid = np.array([_dim(name) == 3 for name in texts(ds, "element_types")], dtype=bool)
    return np.asarray(solid[np.asarray(ds["element_type"].values)])


def _dim(name: str) -> int:
    from febkit.solver import elements

    try:
        return elements.get(name).dim
    except KeyError:
        return 0


def back_nodes(ds: xr.Dataset) -> NDArray[np.bool_] | None:
    """(element, local node) True where a solid has a shell's back node, not the mesh's; None without shells.

    Source: :func:`febkit.solver.shells.thicken`, FEBio's rule.
    """
    kinds = texts(ds, "element_types")
    if not any(name.startswith(("quad", "tri")) for name in kinds):
        return None
    from febkit.solver import elements

    conn, code = np.asarray(ds["connectivity"].values), np.asarray(ds["element_type"].values)
    part = np.asarray(ds["part"].values) if "part" in ds.variables else np.zeros(len(code), dtype=int)
    shell = np.isin(code, [k for k, name in enumerate(kinds) if f"shell_{name}" in elements.SHELLS])
    if not shell.any():
        return None
    from febkit.solver.shells import Shell, Solid, thicken

    on = np.zeros(ds.sizes["node"] + 1, dtype=bool)
    on[np.unique(conn[shell])] = True
    on[-1] = False  # what pads connectivity is -1
    near = solid_elements(ds) & on[conn].any(axis=1)
    out = np.zeros(conn.shape, dtype=bool)
    shells, solids = _blocks(conn, part, code, kinds, shell), _blocks(conn, part, code, kinds, near)
    made = thicken(
        np.asarray(ds["X"].values, dtype=float),
        [Shell(name, c, np.ones(c.shape)) for name, _, c in shells],
        [Solid(name, c) for name, _, c in solids],
    )
    for (_, rows, c), new in zip(solids, made.solids):
        out[rows, : c.shape[1]] = new != c
    return out


def _blocks(
    conn: Ints, part: Ints, code: Ints, kinds: list[str], which: NDArray[np.bool_]
) -> list[tuple[str, Ints, Ints]]:
    """Element type, rows and connectivity of the chosen elements, part by part."""
    from febkit.solver import elements

    found = []
    for p, k in np.unique(np.stack([part[which], code[which]], axis=1), axis=0):
        rows = np.flatnonzero(which & (part == p) & (code == k))
        found.append((kinds[k], rows, conn[rows, : elements.get(kinds[k]).nodes]))
    return found
