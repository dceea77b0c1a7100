"""LS-DYNA state databases (.plt) as FEBio 1 wrote them, as the same dataset as a plotfile's.

A header of 64 words, coordinates, 1-based connectivity (tetrahedra and wedges as degenerate hexahedra), then
one record per state: time, globals, nodal values, values of solids, beams and shells. Either byte order;
further states may lie in files of the same name with 01, 02, ... at its end.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from xarray.core import indexing

from febkit.model import InputError, Where
from febkit.model.elements import ELEMENTS

from .dataset import FrameArray, flags, name_units, short_times
from .xplt.source import Source

if TYPE_CHECKING:
    from collections.abc import Hashable

_WORDS = {"ndim": 15, "nodes": 16, "icode": 17, "globals": 18, "T": 19, "U": 20, "V": 21, "A": 22,
          "solids": 23, "nv3d": 27, "beams": 28, "nv1d": 30, "shells": 31, "nv2d": 33}
_END = -999999.0  # the time of a record that says there are no more
_LIMIT = 1 << 31


@dataclass(frozen=True, slots=True, eq=False)
class Database:
    """Header, mesh words and the records of all states."""

    title: str
    head: Mapping[str, int]
    X: np.ndarray
    solids: np.ndarray  # (solid, 9): nodes and material, 1-based
    beams: np.ndarray  # (beam, 6)
    shells: np.ndarray  # (shell, 5)
    records: list[Records]  # of each file of the family


def read(path: str | os.PathLike[str]) -> Database:
    """Index a database; states stay in the files."""
    where = Where(str(path))
    source = Source(path, where)
    words, order = _header(source, where)
    head = {k: int(words[i]) for k, i in _WORDS.items()}
    bad = [k for k, v in head.items() if not 0 <= v < _LIMIT] + [k for k in "TUVA" if head[k] > 1]
    if bad:
        raise InputError(f"not a database of FEBio 1: {bad[0]} is {head[bad[0]]}", where)
    sizes = (3 * head["nodes"], 9 * head["solids"], 6 * head["beams"], 5 * head["shells"])
    if 4 * (64 + sum(sizes)) > len(source):
        raise InputError("the database ends within its mesh", where)
    ends = np.cumsum([64, *sizes])
    words = np.frombuffer(source[0 : 4 * int(ends[-1])], order + "i4")
    X, solids, beams, shells = (words[a:b] for a, b in pairwise(ends))
    n = 1 + head["globals"] + head["nodes"] * (head["T"] + 3 * (head["U"] + head["V"] + head["A"]))
    n += sum(head[a] * head[b] for a, b in (("solids", "nv3d"), ("beams", "nv1d"), ("shells", "nv2d")))
    title = words[:10].tobytes().split(b"\0")[0].decode("latin-1").strip()
    return Database(
        title,
        head,
        X.view(order + "f4").reshape(-1, 3).astype(np.float32),
        solids.reshape(-1, 9).astype(np.int64),
        beams.reshape(-1, 6).astype(np.int64),
        shells.reshape(-1, 5).astype(np.int64),
        _records(Path(path), source, 4 * int(ends[-1]), n, order),
    )


def _header(source: Source, where: Where) -> tuple[np.ndarray, str]:
    """The first 64 words and the byte order."""
    if len(source) >= 256:
        raw = source[0:256]
        for order in "<>":
            words = np.frombuffer(raw, order + "i4")
            if words[_WORDS["ndim"]] in (3, 4) and words[_WORDS["icode"]] in (1, 6):
                return words, order
    raise InputError("not an LS-DYNA state database: its header names no known code", where)


@dataclass(frozen=True, slots=True)
class Records:
    """(state, words) of one file, read when asked for."""

    source: Source
    start: int  # byte
    words: int  # of each
    count: int
    order: str

    def first(self) -> np.ndarray:
        """The first word of each: its time."""
        raw = self.source.rows(self.start, 4 * self.words, self.count, 4)
        return raw.view(self.order + "f4").reshape(-1)

    def __getitem__(self, t: int) -> np.ndarray:
        self.source.look()
        at = self.start + 4 * self.words * t
        return np.frombuffer(self.source[at : at + 4 * self.words], self.order + "f4")


def _records(path: Path, source: Source, start: int, n: int, order: str) -> list[Records]:
    out: list[Records] = []
    while True:
        here = Records(source, start, n, max(len(source) - start, 0) // (4 * n), order)
        last = np.flatnonzero(here.first() == _END)
        out.append(replace(here, count=int(last[0])) if len(last) else here)
        source.remember(start + 4 * n * out[-1].count)
        follow = path.with_name(f"{path.name}{len(out):02d}")
        if len(last) or not follow.is_file():
            return out
        source, start = Source(follow, Where(str(follow))), 0


Part = tuple[Any, int, int, int, Any]  # rows of the array, first word, rows, words a row, which of them


class Slot:
    """One quantity of each record, as frames."""

    def __init__(self, db: Database, shape: tuple[int, ...], parts: list[Part]) -> None:
        self.db, self.shape, self.parts = db, shape, parts
        self.dtype: Any = np.float32

    def fill(self, t: int, out: np.ndarray) -> None:
        record = _record(self.db, t)
        out.fill(np.nan)
        for place, at, rows, width, pick in self.parts:
            out[place] = record[at : at + rows * width].reshape(rows, width)[:, pick]
        if self.shape == self.db.X.shape and self.parts[0][4] == _POSITION:
            out -= self.db.X

    def frame(self, t: int) -> np.ndarray:
        out = np.empty(self.shape, np.float32)
        self.fill(t, out)
        return out


_POSITION = slice(None, 3)  # the database holds positions: displacements are what they differ from X


def _record(db: Database, t: int) -> np.ndarray:
    for rows in db.records:
        if t < rows.count:
            return rows[t]
        t -= rows.count
    raise IndexError(t)


def open_plt(path: str | os.PathLike[str], slots: Mapping[str, str] | None = None) -> xr.Dataset:
    """The database as a dataset.

    FEBio 1's poroelastic runs kept, by default, the fluid flux in the slot of accelerations and the fluid
    pressure in that of temperatures; the file does not say so: ``slots={"acceleration": "fluid_flux",
    "temperature": "fluid_pressure"}`` renames them.
    """
    db = read(path)
    coords, attrs = _mesh(db, Where(str(path)))
    times = np.concatenate([r.first() for r in db.records]) if db.records else np.empty(0)
    coords["time"] = xr.Variable(("time",), short_times(times))
    data: dict[Hashable, xr.Variable] = {}
    for name, (dims, slot, kind) in _slots(db).items():
        lazy = indexing.LazilyIndexedArray(FrameArray(slot, len(times)))
        key = (slots or {}).get(name, name)
        section, fmt = ("node", "node") if dims[0] == "node" else ("domain", "item")
        data[key] = xr.Variable(
            ("time", *dims), lazy,
            {"febio_name": key.replace("_", " "), "febio_section": section, "febio_type": kind,
             "febio_format": fmt},
        )
    ds = xr.Dataset(data, coords, attrs)
    ds.encoding["source"] = str(path)
    name_units(ds, None)  # the format has no place for a system
    return ds


def _slots(db: Database) -> dict[str, tuple[tuple[str, ...], Slot, str]]:
    h, n = db.head, db.head["nodes"]
    out: dict[str, tuple[tuple[str, ...], Slot, str]] = {}
    at = 1 + h["globals"]
    for flag, name, pick in (("U", "displacement", _POSITION), ("V", "velocity", slice(0, 3)),
                             ("A", "acceleration", slice(0, 3))):
        if h[flag]:
            slot = Slot(db, (n, 3), [(slice(None), at, n, 3, pick)])
            out[name] = (("node", "xyz"), slot, "vec3f")
            at += 3 * n
    if h["T"]:
        out["temperature"] = (("node",), Slot(db, (n,), [(slice(None), at, n, 1, 0)]), "float")
        at += n
    a, b, c = h["solids"], h["beams"], h["shells"]
    e = a + b + c
    solid, beam, shell = slice(0, a), slice(a, a + b), slice(a + b, e)
    at8, at2, at4 = at, at + a * h["nv3d"], at + a * h["nv3d"] + b * h["nv1d"]
    stress: list[Any] = []
    plastic: list[Any] = []
    if a and h["nv3d"] >= 6:
        stress.append((solid, at8, a, h["nv3d"], slice(0, 6)))
        plastic += [(solid, at8, a, h["nv3d"], 6)] if h["nv3d"] >= 7 else []
    if b and h["nv1d"] >= 1:
        stress.append(((beam, 0), at2, b, h["nv1d"], 0))
    if c and h["nv2d"] >= 7:
        stress.append((shell, at4, c, h["nv2d"], slice(0, 6)))
        plastic.append((shell, at4, c, h["nv2d"], 6))
    if stress:
        out["stress"] = (("element", "voigt"), Slot(db, (e, 6), stress), "mat3fs")
    if plastic:
        out["plastic_strain"] = (("element",), Slot(db, (e,), plastic), "float")
    if c and h["nv2d"] >= 32:
        thick = Slot(db, (e,), [(shell, at4, c, h["nv2d"], 29)])
        out["shell_thickness"] = (("element",), thick, "float")
    if c and h["nv2d"] == 44:
        for name, first in (("shell_strain_inner", 32), ("shell_strain_outer", 38)):
            part = [(shell, at4, c, 44, slice(first, first + 6))]
            out[name] = (("element", "voigt"), Slot(db, (e, 6), part), "mat3fs")
    return out


_TYPES = ("hex8", "tet4", "penta6", "quad4", "line2", "tri3")
_WIDTHS = tuple(ELEMENTS[n].nodes for n in _TYPES)


def _mesh(db: Database, where: Where) -> tuple[dict[Hashable, Any], dict[str, Any]]:
    conn, kind, material = _elements(db)
    n = db.head["nodes"]
    if conn.size and (conn.max() >= n or (conn[:, :2] < 0).any() or material.min() < 0):
        raise InputError("the database names a node or a material that does not exist", where)
    used = np.unique(kind)
    parts = [f"material{i}" for i in range(1, int(material.max(initial=-1)) + 2)]
    code = np.searchsorted(used, kind).astype(np.int32)
    width = max((_WIDTHS[k] for k in used), default=0)
    coords: dict[Hashable, Any] = {
        "xyz": xr.Variable(("xyz",), ["x", "y", "z"]),
        "voigt": xr.Variable(("voigt",), ["xx", "yy", "zz", "xy", "yz", "xz"]),
        "node": xr.Variable(("node",), np.arange(1, n + 1, dtype=np.int32)),
        "element": xr.Variable(("element",), np.arange(1, len(conn) + 1, dtype=np.int32)),
        "node_id": xr.Variable(("node",), np.arange(1, n + 1, dtype=np.int32)),
        "X": xr.Variable(("node", "xyz"), db.X, {"long_name": "reference coordinates"}),
        "element_id": xr.Variable(("element",), np.arange(1, len(conn) + 1, dtype=np.int32)),
        "part": xr.Variable(("element",), material.astype(np.int32), flags(parts)),
        "element_type": xr.Variable(("element",), code, flags([_TYPES[k] for k in used])),
        "connectivity": xr.Variable(("element", "local"), conn[:, :width].astype(np.int32)),
    }
    attrs = {"parts": parts, "element_types": [_TYPES[k] for k in used], "title": db.title}
    return coords, {k: v for k, v in attrs.items() if v}


def _elements(db: Database) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Connectivity (0-based, padded with -1), type codes and materials of solids, beams, shells."""
    s = db.solids[:, :8]
    tet = (s[:, 4:8] == s[:, 4:5]).all(axis=1)
    wedge = ~tet & (s[:, 7] == s[:, 6])
    quad = ~tet & ~wedge & (s[:, :4] == s[:, 4:8]).all(axis=1)
    solids = s.copy()
    solids[tet] = np.column_stack([s[tet][:, [0, 1, 2, 4]], np.zeros((tet.sum(), 4), int)])
    solids[wedge] = np.column_stack([s[wedge][:, [4, 1, 0, 6, 2, 3]], np.zeros((wedge.sum(), 2), int)])
    solids[quad] = np.column_stack([s[quad][:, :4], np.zeros((quad.sum(), 4), int)])
    beams = np.zeros((len(db.beams), 8), int)
    beams[:, :2] = db.beams[:, :2]
    shells = np.zeros((len(db.shells), 8), int)
    shells[:, :4] = db.shells[:, :4]
    tri = db.shells[:, 2] == db.shells[:, 3]
    shells[tri, 3] = 0
    kind = np.concatenate([np.select([tet, wedge, quad], [1, 2, 3], 0), np.full(len(beams), 4),
                           np.where(tri, 5, 3)]).astype(int)
    material = np.concatenate([db.solids[:, 8], db.beams[:, 5], db.shells[:, 4]]) - 1
    return np.concatenate([solids, beams, shells]) - 1, kind, np.asarray(material)
