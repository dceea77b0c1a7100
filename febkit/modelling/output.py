"""What a model has written: plot variables and records of the log."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from febkit.feb.features import table
from febkit.model import InputError, LogEntry, PlotVariable

from .sets import missing, node_reference

if TYPE_CHECKING:
    from .model import Model


class Outputs:
    """``m.output.plot = ["displacement", "stress"]``, ``m.output.add("fluid flux")``, ``m.output.log(...)``."""

    def __init__(self, model: Model) -> None:
        self._model = model

    @property
    def plot(self) -> list[str]:
        """Plot variables by FEBio's names."""
        return [v.type for v in self._model.record.output.plot]

    @plot.setter
    def plot(self, names: Iterable[str]) -> None:
        held = {v.type: v for v in self._model.record.output.plot}
        new = tuple(held.get(n) or PlotVariable(known(n)) for n in names)
        self._model._put(output=replace(self._model.record.output, plot=new))

    def add(self, *names: str) -> None:
        """More plot variables."""
        self.plot = [*self.plot, *(n for n in names if n not in self.plot)]

    def log(self, kind: str, data: str, where: Any = None, file: str | None = None) -> None:
        """A record of the log: ``log("node_data", "x;y;z", "top")``, ``log("rigid_body_data", "Fz", where=1)``."""
        ref = None if where is None or kind != "node_data" else node_reference(self._model, where)
        ids = [where] if isinstance(where, int) else where
        items = () if ref is not None or where is None else tuple(int(i) for i in ids)
        entry = LogEntry(kind, data, file, set=ref, items=items)
        out = self._model.record.output
        self._model._put(output=replace(out, log=(*out.log, entry)))

    def __repr__(self) -> str:
        log = [f"{e.kind} {e.data}" for e in self._model.record.output.log]
        return f"plot: {', '.join(self.plot) or 'nothing'}" + (f"\nlog: {'; '.join(log)}" if log else "")


def known(name: str) -> str:
    if name.partition("[")[0].partition("=")[0] not in table()["plot"]:
        raise InputError(missing("plot variable", name, sorted(table()["plot"])))
    return name
