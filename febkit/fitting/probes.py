"""What FEBio's optimisation follows of a run, in double precision: data of its logs, positions of nodes, parameters.

| written | what |
|---|---|
| ``fem.time`` | time |
| ``fem.rigidbody('platen').Fz``, ``.position.x``, ``.euler.z`` | of the rigid body of a material |
| ``fem.mesh.node[10].position.z``, ``fem.mesh.node.fromId(22).position.z``, ``.p`` | position or unknown of a node |
| ``fem.node_data('ux', 7)``, ``fem.element_data('sx', 1)`` | log data at a node or element |
| ``fem.surface_data('volume', 'face')``, ``fem.domain_data(avg('sx'), 'part')`` | log data of a surface or domain |
| any other path | a parameter of the model |
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from febkit.model import InputError, LogEntry, Model, Where
from febkit.output import records
from febkit.output.plot import View
from febkit.output.plotfile import plot_mesh
from febkit.solver.newton import Counts
from febkit.solver.run import Listener, Run

Floats = NDArray[np.float64]
Read = Callable[[], float]
_DATA = re.compile(r"fem\.(node|element|surface|domain)_data\(\s*(.+?)\s*,\s*'?([^,']+?)'?\s*\)")
_NODE = re.compile(r"fem\.mesh\.node(?:\[(\d+)\]|\.fromId[(\[](\d+)[)\]])\.(.+)")
_BODY = re.compile(r"fem\.rigidbody(?:\('([^']*)'\)|\[(\d+)\])\.(.+)")
_OF_BODIES = {f"position.{a}": a for a in "xyz"} | {f"{v}{a}": f"{v}{a}" for v in "FM" for a in "xyz"} | {
    f"euler.{a}": f"Euler{a.upper()}" for a in "xyz"}  # fmt: skip
_DOFS = {a: f"u{a}" for a in "xyz"} | {f"position.{a}": a for a in "xyz"}


@dataclass(frozen=True, slots=True)
class Probe:
    """``bind(view)`` gives what reads its value in the present state of a run."""

    text: str
    bind: Callable[[View], Read]


def datum(kind: str, name: str, where: Where, *, items: Sequence[int] = (), set: str | None = None,
          of: Callable[[Floats], Any] = np.sum) -> Probe:  # fmt: skip
    """A datum of a kind of log record at items (all of ``set``), their sum or what ``of`` makes of them."""
    entry = LogEntry(kind, name, set=set, items=tuple(items), where=where)

    def bind(view: View) -> Read:
        record = records.load(kind)
        column = record.column(view, name, entry)
        if column is None:
            raise InputError(f'{kind} "{name}" is not computed by febkit; docs/variables.md lists what is', where)
        _, rows = record.rows(view, entry)
        return lambda: float(of(column()[rows]))

    return Probe(name, bind)


def probe(text: str, where: Where) -> Probe:
    """The probe of a name. Raises InputError where it is no name of FEBio's."""
    text = text.strip()
    made = _of_data(text, where) or _of_node(text, where) or _of_body(text, where)
    if made is not None:
        return replace(made, text=text)
    if text == "fem.time":
        return Probe(text, lambda view: lambda: float(view.state.time))
    if text.startswith(("fem.mesh.", "fem.rigidbody")) or "_data(" in text:
        raise InputError(f"{text!r} is not understood: see docs/optimise.md for what can be followed", where)
    return _parameter(text, where)


def _of_data(text: str, where: Where) -> Probe | None:
    m = _DATA.fullmatch(text)
    if m is None:
        return None
    kind, name, item = f"{m[1]}_data", m[2].strip(), m[3]
    if m[1] in ("node", "element"):
        if not item.isdigit():
            raise InputError(f"{text}: {item!r} is no id of a {m[1]}", where)
        return datum(kind, name.strip("'"), where, items=[int(item)])
    return datum(kind, name if "(" in name else name.strip("'"), where, set=item)


def _of_node(text: str, where: Where) -> Probe | None:
    m = _NODE.fullmatch(text)
    if m is None:
        return None
    name = _DOFS.get(m[3], m[3])
    if m[2] is not None:
        return datum("node_data", name, where, items=[int(m[2])])

    def bind(view: View) -> Read:
        ids = view.model.mesh.node_ids
        if int(m[1]) >= len(ids):
            raise InputError(f"{text}: there are {len(ids)} nodes, counted from 0", where)
        return datum("node_data", name, where, items=[int(ids[int(m[1])])]).bind(view)

    return Probe(text, bind)


def _of_body(text: str, where: Where) -> Probe | None:
    m = _BODY.fullmatch(text)
    if m is None:
        return None
    if m[3] not in _OF_BODIES:
        raise InputError(f"{text}: of a rigid body {', '.join(_OF_BODIES)} can be followed", where)

    def bind(view: View) -> Read:
        rigid = {str(b.name): k for k, b in enumerate(view.model.materials, 1) if b.type == "rigid body"}
        name = m[1] if m[1] is not None else dict(enumerate(rigid)).get(int(m[2]))
        if name not in rigid:
            raise InputError(f"{text}: there is no such rigid body; there are {', '.join(rigid) or 'none'}", where)
        return datum("rigid_body_data", _OF_BODIES[m[3]], where, items=[rigid[name]]).bind(view)

    return Probe(text, bind)


def _parameter(text: str, where: Where) -> Probe:
    """A parameter of the model, as it is in a run."""

    def bind(view: View) -> Read:
        value = parameter(view.model, text, where)
        return lambda: value

    return Probe(text, bind)


def parameter(model: Model, path: str, where: Where) -> float:
    """The number at a path. Raises InputError, of the line that names it, where there is none."""
    from febkit.modelling import Model as Editable

    try:
        value = Editable.of(model)[path]
    except InputError as e:
        raise InputError(e.message, where) from None
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(f"{path} is {value!r}, which is no number", where)
    return float(value)


class Follow(Listener):
    """Reads probes at the start and after every step: ``rows`` (state, probe)."""

    def __init__(self, model: Model, probes: Sequence[Probe]) -> None:
        self.model, self.probes = model, probes
        self.rows: list[list[float]] = []

    def start(self, run: Run) -> None:
        self._bind(run)
        self._note()

    def remeshed(self, run: Run) -> None:
        self.model = run.problem.origin
        self._bind(run)

    def _bind(self, run: Run) -> None:
        self._view = View(run, self.model, plot_mesh(self.model))
        self._read = [p.bind(self._view) for p in self.probes]

    def converged(self, run: Run, counts: Counts) -> None:
        self._view.renew()
        self._note()

    def _note(self) -> None:
        self.rows.append([read() for read in self._read])
