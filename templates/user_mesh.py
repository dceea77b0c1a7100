"""A user's own mesh of cells, read through meshio, with its parts named.

Parts come from an integer array on the elements (``gmsh:physical``, ``medit:ref``, ... or the one
named). A table of names says what the numbers mean; without one, names of the file's physical groups
are used; without these, parts are told from where they lie: ``ecm`` has the outer surface, a part
inside that encloses nothing is a cell, a part between is the PCM of the cells it encloses.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from febkit.model import InputError, Where
from febkit.model.elements import ELEMENTS
from febkit.model.mesh import Floats, Ints

from .facets import between_parts
from .parts import Parts, without_loose_nodes
from .quality import jacobians
from .segmented import Wedges, from_image

# the corners whose swap turns an element outside in
MIRROR = {
    "hex8": (4, 5, 6, 7, 0, 1, 2, 3), "tet4": (0, 2, 1, 3), "penta6": (3, 4, 5, 0, 1, 2),
    "hex20": (4, 5, 6, 7, 0, 1, 2, 3, 12, 13, 14, 15, 8, 9, 10, 11, 16, 17, 18, 19),
    "tet10": (0, 2, 1, 3, 6, 5, 4, 7, 9, 8), "pyra5": (0, 3, 2, 1, 4),
}
TYPES = {ELEMENTS[n].meshio: n for n in MIRROR}  # meshio's name: FEBio's
USUAL = ("part", "gmsh:physical", "medit:ref", "cell_tags", "label", "labels", "material", "MaterialID")


def user_mesh(path: str | Path, names: Mapping[str, str], array: str = "", scale: float = 1.0) -> Parts:
    """Read a mesh; ``names`` maps the numbers (as text) to part names, ``scale`` multiplies lengths."""
    import meshio

    where = Where(str(path))
    try:
        m = meshio.read(path)
    except (OSError, meshio.ReadError, SystemExit, ValueError, KeyError, ImportError) as e:
        raise InputError(f"meshio cannot read this mesh: {e}", where) from None
    X = np.asarray(m.points, dtype=float) * scale
    if X.ndim != 2 or X.shape[1] != 3:
        raise InputError("the mesh must be in three dimensions", where)
    blocks = [(TYPES[b.type], np.asarray(b.data, dtype=np.int64), i)
              for i, b in enumerate(m.cells) if b.type in TYPES]
    if not blocks:
        raise InputError(f"no solid elements here, only {', '.join(sorted({b.type for b in m.cells}))}; "
                         f"read are {', '.join(TYPES)}", where)
    tags = _tags(m, blocks, array, where)
    groups: dict[tuple[int, str], list[Ints]] = {}
    for (kind, conn, _), tag in zip(blocks, tags, strict=True):
        for value in np.unique(tag):
            groups.setdefault((int(value), kind), []).append(_upright(X, kind, conn[tag == value], where))
    merged = {key: np.concatenate(c) for key, c in groups.items()}
    return _named(X, merged, names, m.field_data, where)


def named_image(path: str | Path, names: Mapping[str, str], voxel: Sequence[float], smoothing: int,
                wedges: Wedges = None) -> Parts:
    """Elements in an image of labels, its parts named as those of a mesh."""
    where = Where(str(path))
    X, found = from_image(path, voxel, smoothing, wedges)
    groups = {key: _upright(X, key[1], conn, where) for key, conn in found.items()}
    return _named(X, groups, names, {}, where)


def _tags(m: Any, blocks: list[tuple[str, Ints, int]], array: str, where: Where) -> list[Ints]:
    """The part number of each element, block by block."""
    data = m.cell_data
    if array and array not in data:
        raise InputError(f"no element array '{array}' here; there are {', '.join(data) or 'none'}", where)
    found = array or next((a for a in USUAL if a in data), "")
    if not found:
        whole = [a for a, v in data.items() if all(np.issubdtype(np.asarray(v[i]).dtype, np.integer)
                                                  and np.asarray(v[i]).ndim == 1 for _, _, i in blocks)]
        if len(whole) > 1:
            raise InputError(f"which array holds the parts? Set part_array to {' or '.join(whole)}", where)
        if not whole:
            return [np.zeros(len(conn), dtype=np.int64) for _, conn, _ in blocks]
        found = whole[0]
    values = [np.asarray(data[found][i]) for _, _, i in blocks]
    if any(v.ndim != 1 or (v != np.rint(v)).any() for v in values):
        raise InputError(f"element array '{found}' must hold one whole number per element", where)
    return [v.astype(np.int64) for v in values]


def _upright(X: Floats, kind: str, conn: Ints, where: Where) -> Ints:
    """Elements with positive volume: those numbered the other way round are mirrored."""
    turned = jacobians(X, kind, conn).sum(axis=1) < 0
    if turned.any():
        conn = conn.copy()
        conn[turned] = conn[turned][:, list(MIRROR[kind])]
    bad = int((jacobians(X, kind, conn).min(axis=1) <= 0).sum())
    if bad:
        raise InputError(f"{bad} {kind} elements have a Jacobian that is not positive at an integration "
                         "point; repair the mesh first", where)
    return conn


def _named(X: Floats, groups: dict[tuple[int, str], Ints], names: Mapping[str, str],
           fields: Mapping[str, Any], where: Where) -> Parts:
    """Parts with names, ordered as ecm, pcm_1, ..., cell_1, ... and then all others."""
    numbers = sorted({number for number, _ in groups})
    physical = {str(int(v[0])): k for k, v in fields.items() if int(v[1]) == 3}
    known = dict(names) or physical
    if known:
        missing = [str(n) for n in numbers if str(n) not in known]
        if missing:
            raise InputError(f"parts {', '.join(missing)} have no name: add them to part_names", where)
        title = {n: known[str(n)] for n in numbers}
    else:
        title = _from_outside_in(len(X), groups, numbers)
    kinds = {n: [k for number, k in groups if number == n] for n in numbers}
    parts: dict[str, tuple[str, Ints]] = {}
    for n in sorted(numbers, key=lambda n: _rank(title[n])):
        for kind in kinds[n]:
            name = title[n] if len(kinds[n]) == 1 else f"{title[n]}_{kind}"
            before = parts.get(name)
            if before is not None and before[0] != kind:
                raise InputError(f"part '{name}' mixes {before[0]} and {kind}: name them apart", where)
            conn = groups[n, kind]
            parts[name] = (kind, conn if before is None else np.concatenate([before[1], conn]))
    return without_loose_nodes(X, parts)


def _rank(name: str) -> tuple[int, int, str]:
    role, _, number = name.partition("_")
    order = {"ecm": 0, "pcm": 1, "cell": 2}.get(role, 3)
    return order, int(number) if number.isdigit() else 0, name


def _from_outside_in(nodes: int, groups: dict[tuple[int, str], Ints], numbers: list[int]) -> dict[int, str]:
    """Names told from which part touches which."""
    keys = list(groups)
    touch: dict[int, set[int]] = {n: set() for n in numbers}
    outer = set()
    for f in between_parts([(kind, groups[n, kind]) for n, kind in keys], nodes):
        for a, b in np.unique(np.stack([f.inside, f.outside], axis=1), axis=0):
            if b < 0:
                outer.add(keys[a][0])
            elif keys[a][0] != keys[b][0]:
                touch[keys[a][0]].add(keys[b][0])
    title = dict.fromkeys(outer, "ecm")
    next_to_ecm = [n for n in numbers if n not in outer and touch[n] & outer]
    inner = [n for n in numbers if n not in outer and n not in next_to_ecm]
    for count, n in enumerate(next_to_ecm, start=1):
        enclosed = [c for c in inner if n in touch[c]]
        title[n] = f"pcm_{count}" if enclosed else f"cell_{count}"
        for extra, c in enumerate(enclosed):
            title[c] = f"cell_{count}" if len(enclosed) == 1 else f"cell_{count}_{extra + 1}"
    for n in numbers:
        title.setdefault(n, f"part_{n}")
    return title
