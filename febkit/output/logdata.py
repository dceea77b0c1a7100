"""Data that <logfile> asks for: nodal and element values after every step, in FEBio's text layout."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from febkit.files import Output
from febkit.model import InputError, LogEntry, Model
from febkit.solver.newton import Counts
from febkit.solver.result import Result
from febkit.solver.run import Listener, Run

from . import fields

Floats = NDArray[np.float64]
VOIGT = {"x": 0, "y": 1, "z": 2, "xy": 3, "yz": 4, "xz": 5}


Columns = dict[str, Callable[[], Floats]]  # name -> its values now
Kept = dict[object, Any]  # what columns of the same state share


def _nodal(run: Run, _: Kept) -> Columns:
    """FEBio's names of nodal log data."""
    s = run.state
    out: Columns = {}
    for k, axis in enumerate("xyz"):
        out[axis] = lambda k=k: s.x[:, k]  # type: ignore[misc]
        out[f"u{axis}"] = lambda k=k: s.u[:, k]  # type: ignore[misc]
        out[f"v{axis}"] = lambda k=k: s.velocity[:, k]  # type: ignore[misc]
        out[f"a{axis}"] = lambda k=k: s.acceleration[:, k]  # type: ignore[misc]
        out[f"R{axis}"] = lambda k=k: s.reaction[:, k]  # type: ignore[misc]
    if s.p is not None:
        out["p"] = lambda: s.of("fluid pressure").ravel()
    return out


def _elements(run: Run, kept: Kept) -> Columns:
    """FEBio's names of element log data: means over integration points."""

    def parts(name: str, change: Callable[[Floats], Floats] | None = None) -> list[Floats | None]:
        """A field of every group, or what ``change`` makes of it: evaluated once a state."""
        key = name, change
        if key not in kept:
            if change is None:
                kept[key] = [fields.domain(name)(g) for g in run.groups]
            else:
                kept[key] = [None if v is None else change(v) for v in parts(name)]
        return kept[key]  # type: ignore[no-any-return]

    def each(k: int, name: str, change: Callable[[Floats], Floats] | None = None) -> Callable[[], Floats]:
        def values() -> Floats:
            return np.concatenate([
                np.full(g.m, np.nan) if v is None else v.reshape(g.m, -1)[:, k]
                for g, v in zip(run.groups, parts(name, change))
            ])

        return values

    out: Columns = {"J": each(0, "relative volume")}
    for axis, k in VOIGT.items():
        out[f"s{axis}"] = each(k, "stress")
        out[f"E{axis}"] = each(k, "Lagrange strain")
    for i in range(3):
        out[f"s{i + 1}"] = each(i, "stress", _principal)
        out[f"E{i + 1}"] = each(i, "Lagrange strain", _principal)
        for j in range(3):
            out[f"F{'xyz'[i]}{'xyz'[j]}"] = each(3 * i + j, "deformation gradient")
    for k, axis in enumerate("xyz"):
        out[f"w{axis}"] = each(k, "fluid flux")
        out[axis] = lambda k=k: np.concatenate([run.state.x[g.conn].mean(axis=1)[:, k] for g in run.groups])  # type: ignore[misc]
    out["p"] = each(0, "fluid pressure")
    out["sed"] = each(0, "strain energy density")
    return out


def _principal(v: Floats) -> Floats:
    """Eigenvalues, largest first, of symmetric tensors."""
    T = v[:, [0, 3, 5, 3, 1, 4, 5, 4, 2]].reshape(-1, 3, 3)
    return np.asarray(np.linalg.eigvalsh(T)[:, ::-1], dtype=float)


@dataclass(frozen=True, slots=True, eq=False)
class _Record:
    """What is written of an entry: a column for each datum, at these rows, by these labels."""

    entry: LogEntry
    columns: list[Callable[[], Floats]]
    ids: NDArray
    rows: NDArray
    output: Output


SOURCES = {"node_data": _nodal, "element_data": _elements}


class LogDataListener(Listener):
    """Writes each <node_data> and <element_data> to its file of ``paths`` (:mod:`febkit.model.data_files`).

    An earlier file stays until the first solved step is written, as an earlier plotfile does.
    """

    def __init__(self, model: Model, paths: Sequence[Path], warn: Callable[[str], object]) -> None:
        self.model, self.paths, self.warn = model, paths, warn
        self._open: list[_Record] = []
        self._kept: Kept = {}

    def start(self, run: Run) -> None:
        for entry, path in zip(self.model.output.log, self.paths, strict=True):
            make = SOURCES.get(entry.kind)
            if make is None:
                self.warn(f"<{entry.kind}> of <logfile> is not written by febkit")
                continue
            known = make(run, self._kept)
            names = entry.data.split(";")
            strange = [x for x in names if x.strip() not in known]
            if strange:
                self.warn(f'{entry.kind} "{";".join(strange)}" is not computed by febkit; the record is left out')
                continue
            columns = [known[x.strip()] for x in names]
            self._open.append(_Record(entry, columns, *self._rows(run, entry), Output(path, entry.where)))
        self._write(run)

    def converged(self, run: Run, counts: Counts) -> None:
        self._write(run)

    def _write(self, run: Run) -> None:
        self._kept.clear()
        for r in self._open:
            entry, output = r.entry, r.output
            head = f"*Step  = {run.totals.steps}\n*Time  = {run.state.time:.9g}\n*Data  = {entry.name or entry.data}\n"
            table = np.column_stack([c() for c in r.columns])[r.rows]
            d = entry.delim or " "
            body = "".join(f"{i}{d}{d.join(f'{v:.9g}' for v in row)}\n" for i, row in zip(r.ids, table))
            output.write((head + body).encode())
            if run.totals.steps or not output.replaces:
                output.place()

    def _rows(self, run: Run, entry: LogEntry) -> tuple[NDArray, NDArray]:
        """Labels and rows of the items an entry names; all where it names none."""
        from febkit.model.sets import element_ids, node_indices

        if entry.kind == "node_data":
            ids = self.model.mesh.node_ids
            chosen = ids[node_indices(self.model.mesh, entry.set, entry.where)] if entry.set else None
        else:
            ids = np.concatenate([g.block.ids for g in run.groups])
            chosen = element_ids(self.model.mesh, entry.set, entry.where) if entry.set else None
        if chosen is None:
            chosen = np.array(entry.items) if entry.items else ids
        row = {int(i): k for k, i in enumerate(ids)}
        missing = [int(i) for i in chosen if int(i) not in row]
        if missing:
            raise InputError(f"<{entry.kind}> names {missing[0]}, which does not exist", entry.where)
        return chosen, np.array([row[int(i)] for i in chosen], dtype=int)

    def end(self, run: Run, result: Result) -> None:
        for r in self._open:
            if result.converged or not r.output.replaces:
                r.output.close()
            else:
                r.output.discard()

    def __exit__(self, *_: object) -> None:
        for r in self._open:
            r.output.discard()
