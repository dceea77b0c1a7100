"""Records of <logfile>: items in rows, data in columns. One file for each kind of record.

Each file has ``rows(view, entry)``, the labels of the items that a record is about, with their places among all items;
and ``column(view, name, entry)``, which gives what evaluates a datum over all items (item,), or None where febkit has
none of this name. The places of what a record asks for are chosen by the listener (:mod:`febkit.output.logdata`).
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from febkit.model import InputError

if TYPE_CHECKING:
    from febkit.model import LogEntry

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Column = Callable[[], Floats]

KINDS = {
    "node_data": "nodes", "element_data": "elements", "face_data": "faces", "surface_data": "surfaces",
    "domain_data": "domains", "rigid_body_data": "bodies", "rigid_connector_data": "connectors", "model_data": "model",
}  # fmt: skip


def load(kind: str) -> Any:
    """The file of a kind of record; None where febkit has none."""
    return import_module(f".{KINDS[kind]}", __name__) if kind in KINDS else None


def places(entry: LogEntry, ids: Ints, chosen: Ints | None) -> tuple[Ints, Ints]:
    """Labels ``chosen`` (else those that the record lists, else all) and their places among ``ids``."""
    if chosen is None:
        chosen = np.array(entry.items, np.int64) if entry.items else ids
    row = {int(i): k for k, i in enumerate(ids)}
    missing = [int(i) for i in chosen if int(i) not in row]
    if missing:
        raise InputError(f"<{entry.kind}> names {missing[0]}, which does not exist", entry.where)
    return chosen, np.array([row[int(i)] for i in chosen], dtype=np.int64)
