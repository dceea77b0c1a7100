"""A solved tissue as the hand-off sees it: nodes, elements, nodal histories of what a mixture holds."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
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
CONCENTRATION = "effective_solute_concentration"
POTENTIAL = "electric_potential"


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
    """Nodal histories on a mesh: ``X`` (n, 3), ``times`` (t,), ``u`` (t, n, 3), effective pressure ``p`` (t, n),
    effective concentrations ``c`` (t, n, s) of ``solutes`` and, derived, the electric potential ``psi`` (t, n);
    None where the tissue has no such thing."""

    X: Floats
    blocks: tuple[Block, ...]
    times: Floats
    u: Floats
    p: Floats | None = None
    source: str = ""
    units: str | None = None
    node_ids: Ints | None = None
    c: Floats | None = None
    solutes: tuple[str, ...] = ()
    psi: Floats | None = None
    cache: dict[str, Any] = field(default_factory=dict, repr=False)

    @property
    def values(self) -> Floats:
        """All nodal values side by side (t, n, columns); :attr:`columns` says which are whose."""
        parts = [self.u, *(q[..., None] for q in (self.p,) if q is not None)]
        parts += [self.c] if self.c is not None else []
        parts += [self.psi[..., None]] if self.psi is not None else []
        return parts[0] if len(parts) == 1 else np.concatenate(parts, axis=2)

    @property
    def columns(self) -> dict[str, slice]:
        """Columns of :attr:`values` by "u", "p", "c", "psi", those that there are."""
        out, at = {}, 0
        for name, width in (("u", 3), ("p", 1), ("c", len(self.solutes)), ("psi", 1)):
            if getattr(self, name) is not None:
                out[name] = slice(at, at + width)
                at += width
        return out

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
        values: dict[str, Any] = {name: _between(getattr(self, name), j, w) for name in self.columns}
        return replace(self, times=t, cache={}, **values)


def _between(y: Floats, j: Ints, w: Floats) -> Floats:
    """Rows j and j + 1 of a history, weighed by 1 - w and w."""
    w = w.reshape(-1, *(1,) * (y.ndim - 1))
    return np.asarray(y[j] * (1 - w) + y[j + 1] * w)


def blocks_of(X: Floats, pieces: list[tuple[str, Ints]], ids: list[Ints] | None = None) -> tuple[Block, ...]:
    """Blocks of (type, conn) pieces, numbered one after the other, each its own part."""
    out, start = [], 0
    for k, (type_, conn) in enumerate(pieces):
        index = np.arange(start, start + len(conn))
        label = index + 1 if ids is None else np.asarray(ids[k])
        out.append(Block(type_, np.asarray(conn, dtype=np.int64), np.full(len(conn), k), index, label))
        start += len(conn)
    return tuple(out)


def from_mesh(mesh: Any, times: Floats, u: Floats, p: Floats | None = None, source: str = "", *,
              c: Floats | None = None, solutes: tuple[str, ...] = ()) -> Field:
    """A field on a :class:`febkit.model.Mesh` with nodal arrays in the order of its nodes."""
    solid = [b for b in mesh.blocks if _is_volume(b.type)]
    blocks = blocks_of(mesh.X, [(b.type, b.conn) for b in solid], [b.ids for b in solid])
    return Field(np.asarray(mesh.X, float), blocks, np.asarray(times, float), np.asarray(u, float),
                 None if p is None else np.asarray(p, float), source, node_ids=np.asarray(mesh.node_ids),
                 c=None if c is None else np.asarray(c, float), solutes=tuple(solutes))


def from_dataset(ds: xr.Dataset) -> Field:
    """The field of a result opened by :func:`febkit.results.open`.

    Raises InputError where the result holds no displacement, or no element that fills space.
    """
    if DISPLACEMENT not in ds:
        raise InputError('the result holds no "displacement": add <var type="displacement"/> to its plotfile')
    blocks = solid_blocks(ds)
    if not blocks:
        raise InputError("the result holds no solid elements")
    name = next((v for v in PRESSURE if v in ds and "node" in ds[v].dims), None)
    p = None if name is None else np.asarray(ds[name].values, dtype=float).reshape(ds.sizes["time"], -1)
    source = str(ds.attrs.get("source", ds.encoding.get("source", "")))
    ids = np.asarray(ds["node_id"].values) if "node_id" in ds.coords else None
    X, c, names = np.asarray(ds["X"].values, float), *_concentrations(ds)
    return Field(X, blocks, np.asarray(ds["time"].values, float), np.asarray(ds[DISPLACEMENT].values, float), p,
                 source, ds.attrs.get("unit_system"), ids, c, names, _potential(ds, X, blocks) if names else None)


def _concentrations(ds: xr.Dataset) -> tuple[Floats | None, tuple[str, ...]]:
    """Effective concentrations (t, n, s) of a result, and the names of its solutes."""
    if CONCENTRATION not in ds or "solute" not in ds[CONCENTRATION].dims:
        return None, ()
    c = ds[CONCENTRATION].transpose("time", "node", "solute")
    return np.asarray(c.values, dtype=float), tuple(str(s) for s in ds["solute"].values)


def _potential(ds: xr.Dataset, X: Floats, blocks: tuple[Block, ...]) -> Floats | None:
    """The electric potential at nodes (t, n): the mean of the elements around each, weighed by reference volume."""
    if POTENTIAL not in ds:
        return None
    values = ds[POTENTIAL]
    if "node" in values.dims:
        return np.asarray(values.transpose("time", "node").values, dtype=float)
    psi = np.asarray(values.transpose("time", "element").values, dtype=float)
    from febkit.solver import elements

    total, weight = np.zeros((len(psi), len(X))), np.zeros(len(X))
    for b in blocks:
        e = elements.get(b.type)
        jacobian = np.einsum("eni,gnj->egij", X[b.conn], e.dN)
        volume = np.abs(np.linalg.det(jacobian)) @ e.weights
        for a in range(b.conn.shape[1]):
            np.add.at(weight, b.conn[:, a], volume)
            np.add.at(total.T, b.conn[:, a], (psi[:, b.index] * volume).T)
    return np.asarray(total / np.where(weight > 0, weight, 1.0))


def solid_blocks(ds: xr.Dataset) -> tuple[Block, ...]:
    """The solid elements of a result, a block for each type."""
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
