"""A run that starts from a state of another result: displacements, fluid pressures and concentrations of the nodes.

Plotfiles hold no more than that, in single precision: histories, multipliers of contacts and velocities begin anew.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from febkit.model import InputError, Model
from febkit.results.xplt.reader import PlotFile
from febkit.solver.fields import DISPLACEMENT, PRESSURE, Field
from febkit.solver.problem import Initial, Problem
from febkit.solver.values import Map

NAMES = {DISPLACEMENT.name: "displacement", PRESSURE.name: "effective fluid pressure"}
SOLUTE = "effective solute concentration"
NEAR = 1e-5  # of its time, by which a state may be off: times are of single precision


def start(problem: Problem, model: Model, text: str) -> None:
    """Give the problem initial values from "other.xplt" or "other.xplt@TIME". Raises InputError."""
    path, time = place(text)
    if problem.bodies or problem.layout.turns:
        raise InputError(f"{path}: plotfiles hold no rotations of rigid bodies, beams and shells: a model with these "
                         "starts at rest; febkit run --resume goes on from a checkpoint")  # fmt: skip
    with PlotFile(path) as f:
        state = _state(f, path, time)
        rows = _rows(model.mesh.node_ids, f.node_ids(max(f.states[state].mesh, 0)), path)
        for field in problem.layout.fields:
            values = _values(f, state, field, path)[rows]
            nodes = np.arange(len(rows))
            for k, column in enumerate(problem.layout.columns(field.name)):
                problem.common.initial.append(Initial(int(column), nodes, Map(values[:, k].astype(float))))


def place(text: str) -> tuple[str, str]:
    """The file and the time, if any, of "other.xplt@TIME"."""
    path, at, time = text.rpartition("@")
    return (path, time) if at and not Path(text).exists() else (text, "")


def _state(f: PlotFile, path: str, time: str) -> int:
    if not f.states:
        raise InputError(f"{path}: this plotfile has no states to start from")
    if not time:
        return len(f.states) - 1
    try:
        t = float(time)
    except ValueError:
        raise InputError(f"{path}@{time}: give the time of a state behind the @") from None
    best = int(np.argmin(np.abs(f.times - t)))
    if not abs(f.times[best] - t) <= NEAR * max(abs(t), float(np.abs(f.times).max())):
        raise InputError(f"{path}: there is no state at time {t:g}; the nearest is at {f.times[best]:g}")
    return best


def _rows(ids: NDArray[np.int64], there: NDArray[np.int64], path: str) -> NDArray[np.int64]:
    """Row of each node in the other result."""
    order = np.argsort(there)
    at = order[np.minimum(np.searchsorted(there, ids, sorter=order), len(there) - 1)]
    missing = np.flatnonzero(there[at] != ids)
    if len(missing):
        raise InputError(f"{path}: {len(missing)} nodes of the model are not in this result, the first is "
                         f"{ids[missing[0]]}")  # fmt: skip
    return np.asarray(at)


def _values(f: PlotFile, state: int, field: Field, path: str) -> NDArray[np.float32]:
    """(node, component); zero at nodes of parts without the field."""
    solute = int(field.components[0][1:]) - 1 if field.option == "ctol" else -1
    name = SOLUTE if solute >= 0 else NAMES.get(field.name, field.name)
    k = next((k for k, v in enumerate(f.variables) if v.name == name), -1)
    data = list(f.regions(k, state)) if k >= 0 else []
    if not data:
        raise InputError(f'{path}: this result holds no "{name}" to start from: have <plotfile> ask for it')
    mesh = f.mesh(max(f.states[state].mesh, 0))
    width = f.variables[k].values
    out = np.zeros((len(mesh.node_ids), width), np.float32)
    for region, values in data:
        out[mesh.domains[region - 1].nodes() if region else slice(None)] = values.reshape(-1, width)
    return out if solute < 0 else out[:, solute : solute + 1]
