"""Checkpoints on disk: a run between two time steps, beside its plotfile.

A line that names the format, a line of JSON, the arrays one after another, and the SHA-256 of all that. An array stands
in the JSON as {"": its number}. Nothing in a checkpoint is code.
"""

from __future__ import annotations

import json
import os
import re
from hashlib import sha256
from math import prod
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from febkit._version import __version__
from febkit.files import Mark, written
from febkit.model import InputError, Model
from febkit.record import record
from febkit.sampling.content import address

if TYPE_CHECKING:
    from febkit.solver.options import Options
    from febkit.solver.result import Result
    from febkit.solver.run import Run

FORMAT = 4
_MAGIC, _DIGEST = b"febkit checkpoint ", 32
_UNITS = {"s": 1.0, "min": 60.0, "h": 3600.0}
_ASKED = re.compile(r"(?:every=)?(\d+(?:\.\d+)?)\s*(s|min|h|steps?)")


@record
class Every:
    """How often a checkpoint is written: after so many seconds of wall time or time steps; ``keep``: at the end too."""

    seconds: float = 0.0
    steps: int = 0
    keep: bool = False

    @classmethod
    def of(cls, text: str) -> Every:
        """From "every=10min", "30s", "2h", "every=5steps", each with ",keep". Raises ValueError."""
        asked, *rest = (part.strip() for part in text.split(","))
        found = _ASKED.fullmatch(asked)
        if not found or rest not in ([], ["keep"]) or not float(found[1]) > 0:
            raise ValueError(f'a checkpoint "{text}" cannot be had: give every=10min, every=30s, every=2h or '
                             'every=5steps, with ",keep" to have it kept after the end')  # fmt: skip
        if found[2] in _UNITS:
            return cls(seconds=float(found[1]) * _UNITS[found[2]], keep=bool(rest))
        return cls(steps=max(round(float(found[1])), 1), keep=bool(rest))


@record
class Checkpoint:
    """``head``: what it is of, how often it is written, how far each file stands (:meth:`febkit.files.Output.mark`);
    ``run``: :func:`febkit.solver.checkpoint.taken`."""

    path: Path
    head: dict[str, Any]
    run: dict[str, Any]


def beside(plotfile: str | PathLike[str]) -> Path:
    """Where the checkpoint of a run lies."""
    return Path(plotfile).with_suffix(".checkpoint")


def write(path: Path, head: dict[str, Any], run: dict[str, Any]) -> None:
    """Write a checkpoint over an earlier one, whole or not at all, through to the disk."""
    arrays: list[np.ndarray] = []
    text = json.dumps({"head": head, "run": _plain(run, arrays), "arrays": [(a.dtype.str, a.shape) for a in arrays]})
    digest = sha256()
    parts: list[Any] = [_MAGIC + f"{FORMAT}\n{text}\n".encode(), *(a.reshape(-1).view(np.uint8) for a in arrays)]
    with written(path) as temp, open(temp, "wb") as f:
        for part in parts:
            f.write(part)
            digest.update(part)
        f.write(digest.digest())
        f.flush()
        os.fsync(f.fileno())


def _plain(value: Any, arrays: list[np.ndarray]) -> Any:
    if isinstance(value, np.ndarray):
        arrays.append(np.ascontiguousarray(value))
        return {"": len(arrays) - 1}
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, dict):
        return {k: _plain(v, arrays) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(v, arrays) for v in value]
    return value


def read(path: Path) -> Checkpoint:
    """Raises InputError, in a sentence, for what is no checkpoint, damaged, or of another version."""
    try:
        data = path.read_bytes()
    except FileNotFoundError:
        raise InputError(f"{path}: there is no checkpoint to go on from; run with --checkpoint every=10min to have "
                         "them written, without --resume to start anew") from None  # fmt: skip
    first, second = data.find(b"\n"), data.find(b"\n", data.find(b"\n") + 1)
    line = data[: max(first, 0)]
    number = line.removeprefix(_MAGIC)
    if not line.startswith(_MAGIC) or not number.isdigit():
        raise InputError(f"{path}: this is no checkpoint of febkit")
    if int(number) != FORMAT:
        raise InputError(f"{path}: this checkpoint has format {int(number)}, this febkit reads {FORMAT}: go on with "
                         "the febkit that wrote it, or start anew without --resume")  # fmt: skip
    if sha256(memoryview(data)[:-_DIGEST]).digest() != data[-_DIGEST:]:
        raise InputError(f"{path}: the checkpoint is damaged (its checksum is another): start anew without --resume")
    said = json.loads(data[first:second])
    if said["head"]["febkit"] != __version__:
        raise InputError(f"{path}: this checkpoint is of febkit {said['head']['febkit']}, this is {__version__}: go on "
                         "with that one, or start anew without --resume")  # fmt: skip
    return Checkpoint(path, said["head"], _filled(said["run"], _arrays(said["arrays"], data, second + 1)))


def _arrays(kinds: list[tuple[str, list[int]]], data: bytes, at: int) -> list[np.ndarray]:
    out = []
    for kind, shape in kinds:
        out.append(np.frombuffer(data, kind, prod(shape), at).reshape(shape).copy())
        at += out[-1].nbytes
    return out


def _filled(value: Any, arrays: list[np.ndarray]) -> Any:
    if isinstance(value, dict):
        return arrays[value[""]] if set(value) == {""} else {k: _filled(v, arrays) for k, v in value.items()}
    return [_filled(v, arrays) for v in value] if isinstance(value, list) else value


# ---- what a run does about them --------------------------------------------------------------------


@record
class Plan:
    """``path`` of its checkpoint; ``every``: how often one is written, None: never; ``saved``: the one it goes on from;
    ``exact``: of this very model."""

    path: Path
    head: dict[str, Any]
    every: Every | None = None
    saved: Checkpoint | None = None
    exact: bool = True

    @classmethod
    def of(
        cls, model: Model, plotfile: str | PathLike[str] | None, options: Options, every: str, resume: bool,
        changed: bool,
    ) -> Plan:  # fmt: skip
        """Raises ValueError for what means nothing, InputError where the run cannot go on."""
        if changed and not resume:
            raise ValueError("changed means something where a run goes on (resume) alone")
        if plotfile is None:
            raise ValueError("a checkpoint lies beside the plotfile: give that a name")
        asked, path = Every.of(every) if every else None, beside(plotfile)
        saved = read(path) if resume else None
        every = every or (saved.head["every"] if saved is not None else "")
        kept = {n: getattr(options, n) for n in ("linear", "factor", "accuracy", "tolerance", "quasi", "stabilise")}
        head = {"febkit": __version__, "model": address(model), "mesh": _mesh(model), "options": kept, "every": every}
        exact = saved is None or _is_of(saved, head, changed)
        return cls(path, head, asked or Every.of(every), saved, exact)

    def marks(self, what: str) -> list[Mark | None]:
        """How far files of a kind stand."""
        found = [] if self.saved is None else self.saved.head["files"].get(what, [])
        return [None if m is None else (m[0], m[1]) for m in found]

    def solve(self, run: Run) -> Result:
        """Have a run go on, and remember what later ones need. Raises InputError where it cannot."""
        from febkit.solver.checkpoint import Resumed, Unfit, refusal

        run.remembers = self.every is not None
        why = refusal(run.problem) if self.every is not None else ""
        if why:
            raise InputError(f"{self.path}: {why}: leave out --checkpoint")
        if self.saved is not None:
            run.resumed = resumed = Resumed(self.saved.run, self.exact)
            why = resumed.mismatch(run)
            if why:
                raise InputError(f"{self.path}: the checkpoint does not fit the model: {why}")
        try:
            return run.solve()
        except Unfit as e:
            raise InputError(f"{self.path}: {e}: start anew without --resume") from None


def _mesh(model: Model) -> str:
    return address([model.mesh.node_ids, model.mesh.X, *([b.type, b.ids, b.conn] for b in model.mesh.blocks)])


def _is_of(saved: Checkpoint, now: dict[str, Any], changed: bool) -> bool:
    """Whether the model is the checkpoint's. Raises InputError where the run cannot go on with it."""
    for name, value in saved.head["options"].items():
        if now["options"][name] != value:
            raise InputError(f"{saved.path}: the run was solved with {name} = {value}, this one asks for "
                             f"{now['options'][name]}: give the same, or start anew without --resume")  # fmt: skip
    if saved.head["model"] == now["model"]:
        return True
    if not changed:
        raise InputError(f"{saved.path}: this checkpoint is of another model, or the model was edited since: --changed "
                         "goes on with other loads or later steps; without --resume the run starts anew")  # fmt: skip
    if saved.head["mesh"] != now["mesh"]:
        raise InputError(f"{saved.path}: the mesh is not the one of this checkpoint: start anew without --resume")
    return False
