"""A solved tissue as the hand-off sees it: nodes, elements, nodal histories of displacement and pressure."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from febkit.model import InputError

if TYPE_CHECKING:
    import xarray as xr

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

DISPLACEMENT = "displacement"
PRESSURE = ("effective_fluid_pressure", "fluid_pressure")  # the first that is there at nodes


@dataclass(frozen=True, slots=True, eq=False)
class Block:
    """Elements of one type: ``conn`` (element, local node) 0-based, ``part`` (element,) their part."""

    type: str
    conn: Ints
    part: Ints
    index: Ints  # (element,) position of each element in the whole result
    ids: Ints  # (element,) labels of the file


@dataclass(frozen=True, slots=True, eq=False)
class Field:
    """Nodal histories on a mesh: ``X`` (n, 3), ``times`` (t,), ``u`` (t, n, 3), ``p`` (t, n) or None."""

    X: Floats
    blocks: tuple[Block, ...]
    times: Floats
    u: Floats
    p: Floats | None = None
    source: str = ""
    units: str | None = None
    node_ids: Ints | None = None
    cache: dict[str, Any] = field(default_factory=dict, repr=False)

    @property
    def values(self) -> Floats:
        """Displacement and pressure side by side (t, n, 3 or 4)."""
        if self.p is None:
            return self.u
        return np.concatenate([self.u, self.p[..., None]], axis=2)

    def at(self, times: Floats) -> Field:
        """The field at other times, linear in between (the times themselves are kept exactly)."""
        t = np.asarray(times, dtype=float)
        slack = 1e-9 * max(abs(self.times[-1]), abs(self.times[0]), 1e-30)
        if t.min() < self.times[0] - slack or t.max() > self.times[-1] + slack:
            raise InputError(f"times {t.min():g} to {t.max():g} asked for, but the result covers "
                             f"{self.times[0]:g} to {self.times[-1]:g}")
        if len(self.times) == 1:
            return self
        j = np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, len(self.times) - 2)
        w = np.clip((t - self.times[j]) / (self.times[j + 1] - self.times[j]), 0.0, 1.0)
        u = self.u[j] * (1 - w)[:, None, None] + self.u[j + 1] * w[:, None, None]
        p = None if self.p is None else self.p[j] * (1 - w)[:, None] + self.p[j + 1] * w[:, None]
        return Field(self.X, self.blocks, t, u, p, self.source, self.units, self.node_ids)


def blocks_of(X: Floats, pieces: list[tuple[str, Ints]], ids: list[Ints] | None = None) -> tuple[Block, ...]:
    """Blocks of (type, conn) pieces, numbered one after the other, each its own part."""
    out, start = [], 0
    for k, (type_, conn) in enumerate(pieces):
        index = np.arange(start, start + len(conn))
        label = index + 1 if ids is None else np.asarray(ids[k])
        out.append(Block(type_, np.asarray(conn, dtype=np.int64), np.full(len(conn), k), index, label))
        start += len(conn)
    return tuple(out)


def from_mesh(mesh: Any, times: Floats, u: Floats, p: Floats | None = None, source: str = "") -> Field:
    """A field on a :class:`febkit.model.Mesh` with nodal arrays in the order of its nodes."""
    solid = [b for b in mesh.blocks if _is_volume(b.type)]
    blocks = blocks_of(mesh.X, [(b.type, b.conn) for b in solid], [b.ids for b in solid])
    return Field(np.asarray(mesh.X, float), blocks, np.asarray(times, float), np.asarray(u, float),
                 None if p is None else np.asarray(p, float), source, node_ids=np.asarray(mesh.node_ids))


def from_dataset(ds: xr.Dataset) -> Field:
    """The field of a result opened by :func:`febkit.results.open`.

    Raises InputError where the result holds no displacement, or no element that fills space.
    """
    if DISPLACEMENT not in ds:
        raise InputError('the result holds no "displacement": add <var type="displacement"/> to its plotfile')
    blocks = _blocks(ds)
    if not blocks:
        raise InputError("the result holds no solid elements")
    name = next((v for v in PRESSURE if v in ds and "node" in ds[v].dims), None)
    p = None if name is None else np.asarray(ds[name].values, dtype=float).reshape(ds.sizes["time"], -1)
    source = str(ds.attrs.get("source", ds.encoding.get("source", "")))
    ids = np.asarray(ds["node_id"].values) if "node_id" in ds.coords else None
    return Field(np.asarray(ds["X"].values, float), blocks, np.asarray(ds["time"].values, float),
                 np.asarray(ds[DISPLACEMENT].values, float), p, source, ds.attrs.get("units"), ids)


def _blocks(ds: xr.Dataset) -> tuple[Block, ...]:
    code = np.asarray(ds["element_type"].values)
    names = ds.attrs.get("element_types")
    names = [names] if isinstance(names, str) else list(names) if names is not None else []
    kinds = np.array([names[c] for c in code]) if code.dtype.kind in "iu" else code.astype(str)
    conn = np.asarray(ds["connectivity"].values, dtype=np.int64)
    part = np.asarray(ds["part"].values, dtype=np.int64)
    ids = np.asarray(ds["element_id"].values, dtype=np.int64)
    out = []
    for kind in dict.fromkeys(kinds.tolist()):
        if not _is_volume(kind):
            continue
        rows = np.nonzero(kinds == kind)[0]
        from febkit.solver import elements

        width = elements.get(kind).nodes
        out.append(Block(kind, conn[rows, :width], part[rows], rows, ids[rows]))
    return tuple(out)


def _is_volume(kind: str) -> bool:
    from febkit.solver import elements

    return kind in elements.VOLUMES
