"""Compares two plotfiles: norms of the difference per variable and state, streaming, equal bytes skipped."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from febkit.model import InputError, Where

from .fields import Field, Places
from .xplt.reader import PlotFile


@dataclass(frozen=True, slots=True)
class StateDifference:
    """Of one variable at one time. Norms are Euclidean over all values both files have."""

    time: float
    norm: float  # |a - b|
    largest: float  # max |a - b|
    item: int  # id of the node or element of the largest difference; 0 where it has none
    size_a: float  # |a|
    size_b: float  # |b|
    lonely: int  # values that only one file has


@dataclass(slots=True)
class VariableDifference:
    """``scale`` is the largest |a| or |b| over all states; a state agrees where
    |a - b| <= atol sqrt(n) + rtol scale, n its number of values, and both define the same values."""

    name: str
    section: str
    states: list[StateDifference] = field(default_factory=list)
    values: int = 0

    @property
    def scale(self) -> float:
        return max((max(s.size_a, s.size_b) for s in self.states), default=0.0)

    def relative(self, s: StateDifference) -> float:
        return 0.0 if s.norm == 0 else float(s.norm / self.scale) if self.scale else float("inf")

    @property
    def worst(self) -> StateDifference | None:
        return max(self.states, key=lambda s: (s.lonely > 0, s.norm), default=None)

    def bad(self, rtol: float, atol: float) -> list[StateDifference]:
        limit = atol * self.values**0.5 + rtol * self.scale
        return [s for s in self.states if s.lonely or not s.norm <= limit]


@dataclass(slots=True)
class PlotDifference:
    """All variables both files have, and what only one has."""

    a: str
    b: str
    variables: list[VariableDifference]
    notes: list[str]  # differences of mesh, states and variables in words

    def agrees(self, rtol: float, atol: float) -> bool:
        return not self.notes and not any(v.bad(rtol, atol) for v in self.variables)


def difference(
    a: str | os.PathLike[str],
    b: str | os.PathLike[str],
    *,
    variables: Sequence[str] = (),
    time_tolerance: float = 1e-6,
) -> PlotDifference:
    """Compare the states that both files have (times within ``time_tolerance`` of the last time)."""
    with PlotFile(a) as fa, PlotFile(b) as fb:
        notes: list[str] = []
        pairs = _states(fa, fb, time_tolerance, notes)
        names = _variables(fa, fb, variables, notes)
        out = [VariableDifference(fa.variables[i].name, fa.variables[i].section) for i, _ in names]
        meshes: dict[tuple[int, int], _Match] = {}
        for s, t in pairs:
            key = max(fa.states[s].mesh, 0), max(fb.states[t].mesh, 0)
            if key not in meshes:
                meshes[key] = _Match(fa, fb, *key, notes)
            for v, (i, j) in zip(out, names):
                found = meshes[key].compare(i, j, s, t)
                if found is not None:
                    v.values = max(v.values, found[1])
                    v.states.append(found[0])
        return PlotDifference(os.fspath(a), os.fspath(b), out, notes)


def _states(fa: PlotFile, fb: PlotFile, tolerance: float, notes: list[str]) -> list[tuple[int, int]]:
    """States of equal time, in order; states of one file only are noted."""
    ta, tb = fa.times, fb.times
    near = tolerance * max(float(np.abs(ta).max(initial=0)), float(np.abs(tb).max(initial=0)))
    pairs, i, j = [], 0, 0
    lonely: dict[str, list[float]] = {"first": [], "second": []}
    while i < len(ta) or j < len(tb):
        if i < len(ta) and j < len(tb) and abs(float(ta[i]) - float(tb[j])) <= near:
            pairs.append((i, j))
            i, j = i + 1, j + 1
        elif j >= len(tb) or (i < len(ta) and ta[i] < tb[j]):
            lonely["first"].append(float(ta[i]))
            i += 1
        else:
            lonely["second"].append(float(tb[j]))
            j += 1
    for which, times in lonely.items():
        if times:
            some = ", ".join(f"{t:g}" for t in times[:5]) + (", ..." if len(times) > 5 else "")
            notes.append(f"{len(times)} states only in the {which} file: t = {some}")
    return pairs


def _variables(
    fa: PlotFile, fb: PlotFile, wanted: Sequence[str], notes: list[str]
) -> list[tuple[int, int]]:
    """Indices of the variables that both files have, in the same storage."""
    def keys(f: PlotFile) -> dict[tuple[str, str, int], int]:
        out: dict[tuple[str, str, int], int] = {}
        for i, v in enumerate(f.variables):
            if v.section != "material" and (not wanted or _asked(v.name, wanted)):
                n = sum(k[:2] == (v.name, v.section) for k in out)
                out[v.name, v.section, n] = i
        return out

    a, b = keys(fa), keys(fb)
    for name in wanted:
        if not any(_asked(k[0], [name]) for k in (*a, *b)):
            raise InputError(f"neither file has a variable {name!r}", Where(str(fa.container.path)))
    for mine, other, which in ((a, b, "first"), (b, a, "second")):
        only = [k[0] for k in mine if k not in other]
        if only:
            notes.append(f"variables only in the {which} file: {', '.join(only)}")
    both = [(a[k], b[k]) for k in a if k in b]
    same = []
    for i, j in both:
        v, w = fa.variables[i], fb.variables[j]
        if (v.type, v.format, v.values) == (w.type, w.format, w.values):
            same.append((i, j))
        else:
            notes.append(f"{v.name}: stored as {v.type} by {v.format} and as {w.type} by {w.format}")
    return same


def _asked(name: str, wanted: Sequence[str]) -> bool:
    return any(name.replace("_", " ").lower() == w.replace("_", " ").lower() for w in wanted)


class _Match:
    """How the items of two meshes belong together: by place, or by id where the order differs."""

    def __init__(self, fa: PlotFile, fb: PlotFile, ma: int, mb: int, notes: list[str]) -> None:
        self.fa, self.fb = fa, fb
        self.pa = Places(fa.outline(ma), partial(fa.mesh, ma))
        self.pb = Places(fb.outline(mb), partial(fb.mesh, mb))
        a, b = fa.mesh(ma), fb.mesh(mb)
        self.node_ids = np.asarray(a.node_ids)
        self.element_ids = a.element_ids()
        self.nodes = _order(self.node_ids, np.asarray(b.node_ids), "nodes", notes)
        self.elements = _order(self.element_ids, b.element_ids(), "elements", notes)
        self.alike = self.nodes is None and self.elements is None
        if self.nodes is None and not np.array_equal(a.X, b.X):
            gap = float(np.abs(np.asarray(a.X, float) - b.X).max())
            notes.append(f"reference coordinates differ by up to {gap:g}")
        if self.alike and not np.array_equal(a.connectivity(), b.connectivity()):
            notes.append("elements of equal id join different nodes")

    def compare(self, i: int, j: int, s: int, t: int) -> tuple[StateDifference, int] | None:
        """One variable at one time; None where the meshes do not fit."""
        time = self.fa.time(s)
        if self.alike and self._equal(i, j, s, t):
            size, n = _size(self.fa, i, s)
            return StateDifference(time, 0.0, 0.0, 0, size, size, 0), n
        a = Field(self.fa, np.array([s]), i, self.fa.variables[i], self.pa)
        b = Field(self.fb, np.array([t]), j, self.fb.variables[j], self.pb)
        x, y = a.frame(0), b.frame(0)
        order, ids = self._axis(a)
        if order is not None:
            x, y = x[order[0]], y[order[1]]
            ids = ids[order[0]]
        if x.shape != y.shape:
            return None
        return _norms(time, x, y, ids), x.size

    def _axis(self, f: Field) -> tuple[tuple[np.ndarray, np.ndarray] | None, np.ndarray]:
        """Order and ids along the first axis."""
        v = f.variable
        if v.section == "node" or (v.section == "domain" and v.format == "node"):
            return self.nodes, self.node_ids
        if v.section == "domain" and v.format in ("item", "mult"):
            return self.elements, self.element_ids
        return None, np.empty(0, int)

    def _equal(self, i: int, j: int, s: int, t: int) -> bool:
        """Whether the stored bytes are the same."""
        a, b = list(self.fa.regions(i, s)), list(self.fb.regions(j, t))
        return [r for r, _ in a] == [r for r, _ in b] and all(
            np.array_equal(x.view("u4"), y.view("u4")) for (_, x), (_, y) in zip(a, b)
        )


def _order(
    a: np.ndarray, b: np.ndarray, what: str, notes: list[str]
) -> tuple[np.ndarray, np.ndarray] | None:
    """Rows of the ids that both have; None where both lists are the same."""
    if np.array_equal(a, b):
        return None
    common, i, j = np.intersect1d(a, b, return_indices=True)
    if len(common) < max(len(a), len(b)):
        notes.append(f"{len(a)} and {len(b)} {what}, {len(common)} of them by the same id")
    return i, j


def _size(f: PlotFile, i: int, s: int) -> tuple[float, int]:
    total, n = 0.0, 0
    for _, values in f.regions(i, s):
        known = np.nan_to_num(values)
        total += float(np.dot(known, known))
        n += values.size
    return total**0.5, n


def _norms(time: float, x: np.ndarray, y: np.ndarray, ids: np.ndarray) -> StateDifference:
    x, y = np.asarray(x, np.float64), np.asarray(y, np.float64)
    lonely = int((np.isnan(x) != np.isnan(y)).sum())
    with np.errstate(invalid="ignore"):
        d = np.abs(x - y)
    d[np.isnan(d)] = 0
    at = int(d.argmax()) if d.size else 0
    row = at // max(d.size // len(ids), 1) if len(ids) and d.size else 0
    item = int(ids[row]) if len(ids) and d.size and d.flat[at] > 0 else 0
    norm = [float(np.sqrt(np.nansum(v * v))) for v in (d, x, y)]
    return StateDifference(time, norm[0], float(d.max(initial=0)), item, norm[1], norm[2], lonely)


def lines(d: PlotDifference, rtol: float, atol: float, every: bool = False) -> Iterator[str]:
    """The comparison in words: a line per variable, or per variable and state where ``every``."""
    yield from d.notes
    width = max((len(v.name) for v in d.variables), default=8)
    yield f"{'variable':<{width}}  {'time':>10}  {'|a-b|/max|a|':>12}  {'max |a-b|':>11}  {'at':>8}"
    for v in d.variables:
        bad = v.bad(rtol, atol)
        shown = v.states if every else [v.worst] if v.worst else []
        for s in shown:
            mark = "" if s not in bad else "  differs"
            only = f"  {s.lonely} values in one file only" if s.lonely else ""
            at = str(s.item) if s.item else "-"
            head = f"{v.name:<{width}}  {s.time:>10g}  {v.relative(s):>12.3e}  {s.largest:>11.3e}  {at:>8}"
            yield head + mark + only
        if not every and len(bad) > 1:
            yield f"{'':<{width}}  {len(bad)} of {len(v.states)} states differ"
