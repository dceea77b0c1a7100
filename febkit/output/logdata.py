"""Data that <logfile> asks for: nodal and element values after every step, in FEBio's text layout."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

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


def _nodal(run: Run) -> dict[str, Callable[[], Floats]]:
    """FEBio's names of nodal log data."""
    s = run.state
    out: dict[str, Callable[[], Floats]] = {}
    for k, axis in enumerate("xyz"):
        out[axis] = lambda k=k: s.x[:, k]  # type: ignore[misc]
        out[f"u{axis}"] = lambda k=k: s.u[:, k]  # type: ignore[misc]
        out[f"v{axis}"] = lambda k=k: s.velocity[:, k]  # type: ignore[misc]
        out[f"a{axis}"] = lambda k=k: s.acceleration[:, k]  # type: ignore[misc]
        out[f"R{axis}"] = lambda k=k: s.reaction[:, k]  # type: ignore[misc]
    if s.p is not None:
        out["p"] = lambda: s.of("fluid pressure").ravel()
    return out


def _elements(run: Run) -> dict[str, Callable[[], Floats]]:
    """FEBio's names of element log data: means over integration points."""
    groups = run.groups

    def each(f: Callable[[fields.Group], Floats | None], k: int) -> Callable[[], Floats]:  # type: ignore[name-defined]
        def values() -> Floats:
            parts = [f(g) for g in groups]
            return np.concatenate([
                np.full(g.m, np.nan) if v is None else v.reshape(g.m, -1)[:, k] for g, v in zip(groups, parts)
            ])

        return values

    out: dict[str, Callable[[], Floats]] = {"J": each(fields.domain("relative volume"), 0)}
    for axis, k in VOIGT.items():
        out[f"s{axis}"] = each(fields.domain("stress"), k)
        out[f"E{axis}"] = each(fields.domain("Lagrange strain"), k)
    for i in range(3):
        out[f"s{i + 1}"] = each(_principal(fields.domain("stress")), i)
        out[f"E{i + 1}"] = each(_principal(fields.domain("Lagrange strain")), i)
        for j in range(3):
            out[f"F{'xyz'[i]}{'xyz'[j]}"] = each(fields.domain("deformation gradient"), 3 * i + j)
    for k, axis in enumerate("xyz"):
        out[f"w{axis}"] = each(fields.domain("fluid flux"), k)
        out[axis] = each(lambda g: run.state.x[g.conn].mean(axis=1), k)
    out["p"] = each(fields.domain("fluid pressure"), 0)
    out["sed"] = each(fields.domain("strain energy density"), 0)
    return out


def _principal(field: Callable[[fields.Group], Floats | None]) -> Callable[[fields.Group], Floats | None]:  # type: ignore[name-defined]
    """Eigenvalues, largest first, of a field of symmetric tensors."""

    def values(g: fields.Group) -> Floats | None:  # type: ignore[name-defined]
        v = field(g)
        if v is None:
            return None
        T = v[:, [0, 3, 5, 3, 1, 4, 5, 4, 2]].reshape(-1, 3, 3)
        return np.asarray(np.linalg.eigvalsh(T)[:, ::-1], dtype=float)

    return values


SOURCES = {"node_data": _nodal, "element_data": _elements}


class LogDataListener(Listener):
    """Writes each <node_data> and <element_data> to its file of ``paths`` (:mod:`febkit.model.data_files`).

    An earlier file stays until the first solved step is written, as an earlier plotfile does.
    """

    def __init__(self, model: Model, paths: Sequence[Path], warn: Callable[[str], object]) -> None:
        self.model, self.paths, self.warn = model, paths, warn
        self._open: list[tuple[LogEntry, Output]] = []

    def start(self, run: Run) -> None:
        for entry, path in zip(self.model.output.log, self.paths, strict=True):
            make = SOURCES.get(entry.kind)
            if make is None:
                self.warn(f"<{entry.kind}> of <logfile> is not written by febkit")
                continue
            known = make(run)
            strange = [x for x in entry.data.split(";") if x.strip() not in known]
            if strange:
                self.warn(f'{entry.kind} "{";".join(strange)}" is not computed by febkit; the record is left out')
                continue
            self._open.append((entry, Output(path, entry.where)))
        self._write(run)

    def converged(self, run: Run, counts: Counts) -> None:
        self._write(run)

    def _write(self, run: Run) -> None:
        for entry, output in self._open:
            values = SOURCES[entry.kind](run)
            columns = [values[x.strip()]() for x in entry.data.split(";")]
            ids, rows = self._rows(run, entry)
            head = f"*Step  = {run.totals.steps}\n*Time  = {run.state.time:.9g}\n*Data  = {entry.name or entry.data}\n"
            table = np.column_stack(columns)[rows]
            d = entry.delim or " "
            body = "".join(f"{i}{d}{d.join(f'{v:.9g}' for v in row)}\n" for i, row in zip(ids, table))
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
        for _entry, output in self._open:
            if result.converged or not output.replaces:
                output.close()
            else:
                output.discard()

    def __exit__(self, *_: object) -> None:
        for _entry, output in self._open:
            output.discard()
