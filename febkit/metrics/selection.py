"""Which elements make which cell."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from febkit.model import InputError

if TYPE_CHECKING:
    import xarray as xr

Ints = NDArray[np.int64]
Cells = None | str | Sequence[str] | Mapping[str, object] | NDArray
_USUAL = re.compile(r"(cell|chondrocyte)s?[\s_\-.]*\d*", re.IGNORECASE)


@dataclass(frozen=True, slots=True, eq=False)
class Selection:
    """``names`` of the cells; ``rows`` (e,) element rows in use; ``owner`` (e,) cell index of each."""

    names: tuple[str, ...]
    rows: Ints
    owner: Ints

    def of(self, cell: int) -> Ints:
        return np.asarray(self.rows[self.owner == cell])


def select_cells(ds: xr.Dataset, cells: Cells = None, split: bool = True) -> Selection:
    """Cells of a result.

    ``cells`` is None (parts, else element sets, called "cell..." or "chondrocyte..."), a name or glob,
    names, {name: part, set, element rows or mask}, or labels (element,) with 0 for no cell. One part
    that holds several pieces not connected by nodes is split into "name1", "name2", ... unless
    ``split`` is false. Raises InputError where nothing matches or cells overlap.
    """
    found = _collect(ds, cells)
    if split and len(found) == 1:
        found = _pieces(ds, *next(iter(found.items())))
    names = tuple(found)
    rows = np.concatenate([found[n] for n in names])
    owner = np.repeat(np.arange(len(names)), [len(found[n]) for n in names])
    if len(np.unique(rows)) < len(rows):
        raise InputError(f"cells overlap: an element belongs to more than one of {', '.join(names[:8])}")
    return Selection(names, rows, owner)


def part_names(ds: xr.Dataset) -> list[str]:
    from febkit.results.mesh import texts

    return texts(ds, "parts")


def part_rows(ds: xr.Dataset, name: str) -> Ints:
    """Element rows of a part or element set."""
    rows = _named(ds).get(name)
    if rows is None:
        known = ", ".join(_named(ds)) or "none"
        raise InputError(f"no part or element set is called {name!r}; the result has {known}")
    return rows


def _collect(ds: xr.Dataset, cells: Cells) -> dict[str, Ints]:
    if isinstance(cells, np.ndarray):
        return _labels(ds, cells)
    if isinstance(cells, Mapping):
        return {str(k): _rows(ds, v) for k, v in cells.items()}
    named = _named(ds)
    if cells is None:
        found = {k: v for k, v in named.items() if _USUAL.fullmatch(k) and len(v)}
        if not found:
            raise InputError(
                'no part or element set is called "cell..." or "chondrocyte..."; name the cells: '
                f"{', '.join(named) or 'the result names no parts'}"
            )
        return found
    wanted = [cells] if isinstance(cells, str) else list(cells)
    out: dict[str, Ints] = {}
    for w in wanted:
        hits = [k for k in named if k == w] or [k for k in named if fnmatchcase(k, w)]
        if not hits:
            part_rows(ds, w)  # raises with the names there are
        out.update({k: named[k] for k in hits})
    return out


def _named(ds: xr.Dataset) -> dict[str, Ints]:
    """Parts, then element sets of other names, with their rows; parts of one name are one."""
    parts: dict[str, Ints] = {}
    index = np.asarray(ds["part"].values) if "part" in ds.variables else None
    for k, name in enumerate(part_names(ds)):
        if index is not None:
            rows = np.flatnonzero(index == k)
            parts[str(name)] = np.concatenate([parts[str(name)], rows]) if str(name) in parts else rows
    for name, rows in _element_sets(ds).items():
        parts.setdefault(name, rows)
    return parts


def _element_sets(ds: xr.Dataset) -> dict[str, Ints]:
    """Rows of each element set; the results know them by element ids."""
    from febkit.results import mesh

    sets = mesh.of(ds).element_sets
    if not sets:
        return {}
    ids = np.asarray(ds["element_id"].values)
    order = np.argsort(ids, kind="stable")
    out = {}
    for name, members in sets.items():
        at = np.searchsorted(ids[order], members).clip(max=len(ids) - 1)
        rows = order[at]
        out[name] = rows[ids[rows] == members]
    return out


def _rows(ds: xr.Dataset, value: object) -> Ints:
    if isinstance(value, str):
        return part_rows(ds, value)
    a = np.asarray(value)
    if a.dtype == bool:
        return np.flatnonzero(a)
    if a.dtype.kind in "iu":
        return a.astype(np.int64)
    return np.concatenate([part_rows(ds, str(v)) for v in a])


def _labels(ds: xr.Dataset, labels: NDArray) -> dict[str, Ints]:
    if len(labels) != ds.sizes["element"]:
        raise InputError(f"{len(labels)} labels for {ds.sizes['element']} elements")
    return {f"cell{k}": np.flatnonzero(labels == k) for k in np.unique(labels) if k != 0}


def _pieces(ds: xr.Dataset, name: str, rows: Ints) -> dict[str, Ints]:
    """Pieces connected by nodes, in the order of their first element."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    conn = np.asarray(ds["connectivity"].values)[rows]
    e, a = np.nonzero(conn >= 0)
    link = coo_matrix((np.ones(len(e)), (e, conn[e, a])), shape=(len(rows), ds.sizes["node"])).tocsr()
    count, label = connected_components(link @ link.T, directed=False)
    if count == 1:
        return {name: rows}
    first = np.argsort([np.flatnonzero(label == k)[0] for k in range(count)])
    stem = name[:-1] if name.lower().endswith("cells") or name.lower().endswith("chondrocytes") else name
    return {f"{stem}{i + 1}": rows[label == k] for i, k in enumerate(first)}
