"""Data that <logfile> asks for, after every step, in FEBio's text layout."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from febkit.files import Mark, Output
from febkit.model import LogEntry, Model
from febkit.record import record
from febkit.solver.newton import Counts
from febkit.solver.result import Result
from febkit.solver.run import Listener, Run

from . import records
from .plot import View
from .plotfile import plot_mesh


@record
class _Record:
    """What is written of an entry: a column for each datum, at these rows, by these labels."""

    entry: LogEntry
    data: str
    columns: list[records.Column]
    ids: NDArray
    rows: NDArray
    output: Output

    def text(self, step: int, time: float) -> str:
        """The record at one state."""
        e, spec = self.entry, self.entry.spec
        table = np.column_stack([c() for c in self.columns])[self.rows]
        head = f"*Step  = {step}\n*Time  = {time:.9g}\n*Data  = {e.name or self.data}\n"
        if spec is not None and spec.attrs.get("comments") == "off":
            head = ""
        form = spec.attrs.get("format") if spec is not None else None
        if form:
            return head + "".join(_formatted(form, int(i), k, row) for k, (i, row) in enumerate(zip(self.ids, table)))
        d = e.delim or " "
        return head + "".join(f"{i}{d}{d.join(f'{v:.12g}' for v in row)}\n" for i, row in zip(self.ids, table))


def _formatted(form: str, item: int, row: int, values: NDArray) -> str:
    """A row by FEBio's format: %i the item, %l the line, %g the next value, %t a tab, %n a new line."""
    out, rest = [], list(values)
    head, *pieces = form.split("%")
    for piece in pieces:
        code, tail = piece[:1], piece[1:]
        if code == "g":
            out.append(f"{rest.pop(0):g}" if rest else "")
        elif code in "iltn" and code:
            out.append({"i": str(item), "l": str(row + 1), "t": "\t", "n": "\n"}[code])
        else:
            tail = piece
        out.append(tail)
    return head + "".join(out) + "\n"


class LogDataListener(Listener):
    """Writes each record of <logfile> to its file of ``paths`` (:mod:`febkit.model.data_files`).

    An earlier file stays until the first solved step is written, as an earlier plotfile does. Data that febkit does not
    compute are named by ``warn`` and left out; so is a record of which nothing is left.
    """

    what = "data"

    def __init__(
        self, model: Model, paths: Sequence[Path], warn: Callable[[str], object], marks: Sequence[Mark | None] = ()
    ) -> None:
        self.model, self.paths, self.warn, self._marks = model, paths, warn, list(marks)
        self._open: list[_Record] = []
        self.view: View | None = None

    def remeshed(self, run: Run) -> None:
        """Records go on about the items that they began with, as in FEBio."""
        self.model = run.problem.origin
        self.view = view = View(run, self.model, plot_mesh(self.model))
        for k, r in enumerate(self._open):
            kind = records.load(r.entry.kind)
            assert kind is not None
            ids, rows = kind.rows(view, replace(r.entry, set=None, items=()))
            at = {int(i): int(row) for i, row in zip(ids, rows)}
            columns = [kind.column(view, x, r.entry) for x in r.data.split(";")]
            self._open[k] = replace(r, columns=columns, rows=np.array([at[int(i)] for i in r.ids], np.int64))

    def start(self, run: Run) -> None:
        self.view = View(run, self.model, plot_mesh(self.model))
        for entry, path in zip(self.model.output.log, self.paths, strict=True):
            kind = records.load(entry.kind)
            if kind is None:
                self.warn(f"<{entry.kind}> of <logfile> is not written by febkit")
                continue
            names = [x.strip() for x in entry.data.split(";")]
            found = {x: kind.column(self.view, x, entry) for x in names}
            good = [x for x in names if found[x] is not None]
            strange = ";".join(x for x in found if found[x] is None)
            if strange:
                left = "it is left out" if good else "the record is left out"
                self.warn(f'{entry.kind} "{strange}" is not computed by febkit; {left}')
            if good:
                ids, rows = kind.rows(self.view, entry)
                mark = self._marks.pop(0) if self._marks else None
                output = Output(path, entry.where, mark)
                self._open.append(_Record(entry, ";".join(good), [found[x] for x in good], ids, rows, output))
        if run.resumed is None:
            self._write(run)

    def marks(self) -> list[Mark | None]:
        """How far each file stands."""
        return [r.output.mark() for r in self._open]

    def converged(self, run: Run, counts: Counts) -> None:
        self._write(run)

    def _write(self, run: Run) -> None:
        assert self.view is not None
        self.view.renew()
        for r in self._open:
            r.output.write(r.text(run.totals.steps, run.state.time).encode())
            if run.totals.steps or not r.output.replaces:
                r.output.place()

    def end(self, run: Run, result: Result) -> None:
        for r in self._open:
            if result.converged or not r.output.replaces:
                r.output.close()
            else:
                r.output.discard()

    def __exit__(self, *_: object) -> None:
        for r in self._open:
            r.output.discard()
