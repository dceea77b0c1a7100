"""Driving data from anywhere: the series of a tissue, or an experiment's F(t), p(t) and c(t), as NetCDF or CSV.

A CSV file has a head and one row per time (and point). Columns: ``time`` (or ``t``); ``F11`` ... ``F33`` or
``Fxx`` ... ``Fzz``; and, where wanted, ``point``, ``ux uy uz``, second derivatives ``G111`` or ``Gxxx`` (of
x_i by X_J, X_K: either order of J, K), third ones ``G3xxxx``, ``p``, ``px py pz``, ``Hxx``, ``H3xxx``; effective
concentrations by solute, ``c[Na]``, their derivatives ``c[Na]x``, ``c[Na]xy``, ``c[Na]xyz``.
Components of F that are left out are those of the identity, others 0.
"""

from __future__ import annotations

import csv
import re
from itertools import permutations
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from febkit.model import InputError, Where

from .taylor import SERIES

if TYPE_CHECKING:
    import xarray as xr

Floats = NDArray[np.float64]

# name -> (tensor's rank, rank of its symmetric tail, dims after point, time and, for concentrations, solute)
TENSORS: dict[str, tuple[int, int, tuple[str, ...]]] = {
    "u": (1, 0, ("i",)), "F": (2, 0, ("i", "J")), "G": (3, 2, ("i", "J", "K")),
    "G3": (4, 3, ("i", "J", "K", "L")),
    "p": (0, 0, ()), "grad_p": (1, 0, ("J",)), "H": (2, 2, ("J", "K")), "H3": (3, 3, ("J", "K", "L")),
    "c": (0, 0, ()), "grad_c": (1, 0, ("J",)), "H_c": (2, 2, ("J", "K")), "H3_c": (3, 3, ("J", "K", "L")),
}
_SOLUTE = re.compile(r"^c\[([^\]]+)\]_?([xyzXYZ123]*)$")
_COLUMN = re.compile(r"^(u|F|G3_?|G|H3_?|H|grad_?p_?|p)_?([xyzXYZ123]*)$")


def read_driving(path: str | PathLike[str]) -> xr.Dataset:
    """Driving data in a NetCDF (.nc) or CSV file. Raises InputError that names the file, line and column."""
    p = Path(path)
    if not p.is_file():
        raise InputError(f"{p}: there is no such file")
    ds = _netcdf(p) if p.suffix.lower() in (".nc", ".nc4", ".h5", ".cdf") else _csv(p)
    return checked(ds, str(p))


def checked(ds: xr.Dataset, name: str = "driving data") -> xr.Dataset:
    """Driving data with dims in order, a ``point`` dimension, increasing finite times and finite values."""
    if "F" not in ds or "time" not in ds.dims:
        raise InputError(f"{name}: driving data need F over time; there is {', '.join(map(str, ds)) or None}")
    if "point" not in ds.dims:
        ds = ds.expand_dims("point")
    t = np.asarray(ds["time"].values, dtype=float)
    if not np.isfinite(t).all() or (np.diff(t) <= 0).any():
        raise InputError(f"{name}: times must be finite and increase")
    for v, (_, _, axes) in TENSORS.items():
        if v not in ds:
            continue
        dims = ("point", "time", *(("solute",) if v in SERIES["c"] else ()), *axes)
        if set(ds[v].dims) != set(dims) or any(ds.sizes[a] != 3 for a in axes):
            raise InputError(f"{name}: {v} must have dimensions {', '.join(dims)}, "
                             f"not {', '.join(map(str, ds[v].dims))}")
        ds[v] = ds[v].transpose(*dims)
        if not np.isfinite(ds[v].values).all():
            raise InputError(f"{name}: {v} holds values that are not numbers")
    return ds


def _netcdf(path: Path) -> xr.Dataset:
    from febkit.results import netcdf

    with netcdf.opened(path) as ds:
        return ds.load()


def _csv(path: Path) -> xr.Dataset:
    import xarray as xr

    head, table = _table(path)
    targets = [_target(name, path) for name in head]
    when = [k for k, t in enumerate(targets) if t == "time"]
    if len(when) != 1:
        raise InputError("one column must be called time", Where(str(path), 1))
    points = next((table[:, k] for k, t in enumerate(targets) if t == "point"), np.zeros(len(table)))
    names = list(dict.fromkeys(points.tolist()))
    groups = [table[points == n] for n in names]
    times = groups[0][:, when[0]]
    for n, g in zip(names, groups):
        if len(g) != len(times) or not np.array_equal(g[:, when[0]], times):
            raise InputError(f"point {n:g} has other times than the first", Where(str(path)))
    fields: dict[str, Any] = {}
    solutes = list(dict.fromkeys(t[2] for t in targets if not isinstance(t, str) and t[2]))
    for k, target in enumerate(targets):
        if isinstance(target, str):
            continue
        name, index, solute = target
        rank, tail, axes = TENSORS[name]
        own = ("solute",) if solute else ()
        if name not in fields:
            start = np.zeros((len(names), len(times), *(len(solutes) for _ in own), *(3,) * rank))
            fields[name] = (("point", "time", *own, *axes), start + np.eye(3) if name == "F" else start)
        of = (solutes.index(solute),) if solute else ()
        for same in set(permutations(index[rank - tail:])):
            where = (slice(None), slice(None), *of, *index[:rank - tail], *same)
            fields[name][1][where] = np.stack([g[:, k] for g in groups])
    if "F" not in fields:
        raise InputError("there is no column of F (Fxx ... Fzz, or F11 ... F33)", Where(str(path), 1))
    coords: dict[str, Any] = {"time": times, "point": [int(n) if n == int(n) else n for n in names]}
    return xr.Dataset(fields, coords | ({"solute": solutes} if solutes else {}),
                      {"source": str(path), "recovery": "given"})


def _table(path: Path) -> tuple[list[str], Floats]:
    """Head and numbers of a CSV file; comma, semicolon, tab or blanks between; lines with # are comments."""
    text = path.read_text(encoding="utf-8-sig", errors="replace").splitlines()
    lines = [(n, s) for n, s in enumerate(text, 1) if s.strip() and not s.lstrip().startswith("#")]
    if len(lines) < 2:
        raise InputError("a CSV file needs a head and at least one row of numbers", Where(str(path)))
    mark = next((c for c in (",", ";", "\t") if c in lines[0][1]), None)
    body = [s for _, s in lines]
    rows = [s.split() for s in body] if mark is None else list(csv.reader(body, delimiter=mark))
    head = [h.strip() for h in rows[0]]
    out = np.zeros((len(rows) - 1, len(head)))
    for k, row in enumerate(rows[1:]):
        line = lines[k + 1][0]
        if len(row) != len(head):
            raise InputError(f"{len(row)} values for {len(head)} columns", Where(str(path), line))
        for c, v in enumerate(row):
            try:
                out[k, c] = float(v)
            except ValueError:
                raise InputError(f"column {head[c]}: {v!r} is not a number", Where(str(path), line)) from None
    return head, out


def _target(name: str, path: Path) -> str | tuple[str, tuple[int, ...], str]:
    """What a column holds: "time", "point", or a tensor's name, component and solute ("" where it is of none)."""
    low = name.strip().lower()
    if low in ("t", "time", "time (s)", "time [s]"):
        return "time"
    if low == "point":
        return "point"
    if m := _SOLUTE.match(name.strip()):
        index = _axes(m[2])
        if len(index) <= 3:
            return SERIES["c"][len(index)], index, m[1].strip()
    m = _COLUMN.match(name.strip().replace("[", "").replace("]", "").replace(",", ""))
    if m:
        base = m[1].replace("_", "")
        index = _axes(m[2])
        base = {"gradp": "grad_p", "p": "grad_p" if index else "p"}.get(base, base)
        if TENSORS[base][0] == len(index):
            return base, index, ""
    raise InputError(f'column "{name}" is not known: use time, point, ux, Fxx, Gxxx, G3xxxx, p, px, Hxx, '
                     "H3xxx, c[solute], c[solute]x ... (digits 1 2 3 may stand for x y z)", Where(str(path), 1))


def _axes(letters: str) -> tuple[int, ...]:
    return tuple("xyz123".index(c) % 3 for c in letters.lower())


def _split(line: str) -> list[str]:
    """Fields between commas, semicolons or tabs; blanks separate where there are none of these."""
    mark = next((c for c in ",;\t" if c in line), None)
    return [c.strip() for c in line.strip().split(mark)]


def read_points(path: str | PathLike[str]) -> tuple[Floats, list[str]]:
    """Points of a CSV file: columns x, y, z (with or without a head) and, where there is one, name."""
    p = Path(path)
    if not p.is_file():
        raise InputError(f"{p}: there is no such file")
    rows = [(n, _split(s)) for n, s in enumerate(p.read_text(encoding="utf-8-sig", errors="replace").splitlines(), 1)
            if s.strip() and not s.lstrip().startswith("#")]
    head = ["x", "y", "z"]
    if rows and {"x", "y", "z"} <= {c.lower() for c in rows[0][1]}:
        head = [c.lower() for c in rows.pop(0)[1]]
    if not rows:
        raise InputError("there are no points in the file", Where(str(p)))
    points: list[list[float]] = []
    names: list[str] = []
    column = next((head.index(n) for n in ("name", "id", "point", "label") if n in head), None)
    for line, row in rows:
        try:
            points.append([float(row[head.index(a)]) for a in "xyz"])
            names.append(row[column] if column is not None else str(len(names)))
        except (ValueError, IndexError):
            raise InputError(f"{','.join(row)[:60]!r} is no point x,y,z", Where(str(p), line)) from None
    return np.array(points), names
