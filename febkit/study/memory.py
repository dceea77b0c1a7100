"""What a solve takes, told from the size of its model, and what follows for the workers on this machine."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from .config import Resources
from .step import Step
from .store import Store
from .work import MODEL, size

# MB of a process that solves a model of n unknowns by a factorisation: BASE + EACH n + FACTOR n^(4/3), the exponent
# that nested dissection has in three dimensions; a fit to measured solves (docs/depths.md)
BASE, EACH, FACTOR = 115.0, 3.7e-3, 1.2e-4
ROOM = 2.0  # a worker may hold so many times what is estimated: a factor that is not symmetric is twice as large
LEAST = 0.8  # GB of a worker
LARGE = 20_000  # unknowns from which on a second thread is worth more than a second solve
FEW = 4  # steps for each processor that need no cluster where none of them solves


def solve_memory(unknowns: int) -> float:
    """GB that a solve takes, estimated."""
    return (BASE + EACH * unknowns + FACTOR * math.pow(unknowns, 4 / 3)) / 1e3


@dataclass(frozen=True, slots=True)
class Stage:
    """Steps that are done at once, and workers for them; ``serial``: in this process, no cluster would be worth it."""

    steps: dict[str, Step]
    resources: Resources
    unknowns: int = 0
    serial: bool = False

    @property
    def said(self) -> str:
        r, n = self.resources, sum(s.kind == "solve" for s in self.steps.values())
        if self.serial or not n or not self.unknowns:  # nothing was planned by the models
            return ""
        size = f"{self.unknowns:,} unknowns (about {solve_memory(self.unknowns):.2g} GB each)"
        return f"solves: {n} of up to {size}; workers: {r.workers}, of {r.memory:.2g} GB and {r.threads} thread(s)"


def stages(needed: Mapping[str, Step], store: Store, r: Resources) -> Iterable[Stage]:
    """Steps with workers for them; the second stage is planned by the models that the first has made.

    What the user says of threads, memory and workers is kept; where he says the memory, all steps are one stage.
    """
    if r.memory:
        yield Stage(dict(needed), replace(r, threads=r.threads or 1))
        return
    ranks = _ranks(needed)
    first = {k: s for k, s in needed.items() if not ranks[k]}
    if first:
        alone = len(first) <= FEW * cores()
        yield Stage(first, _planned(r, 0, len(first)), serial=alone)
    rest = {k: s for k, s in needed.items() if ranks[k]}
    while rest:
        rank = min(ranks[k] for k in rest)
        now = {k: s for k, s in rest.items() if ranks[k] == rank}
        most = max((unknowns(store, s) for s in rest.values() if s.kind == "solve"), default=0)
        if most < LARGE and cores() * solve_memory(most) < free_memory():
            now = rest  # small enough to be at work side by side
        here = max((unknowns(store, s) for s in now.values() if s.kind == "solve"), default=0)
        solves = sum(s.kind == "solve" for s in now.values())
        yield Stage(now, _planned(r, here, solves or len(now)), here)
        rest = {k: s for k, s in rest.items() if k not in now}


def _ranks(needed: Mapping[str, Step]) -> dict[str, int]:
    """How many solves follow each other up to each step."""
    out: dict[str, int] = {}

    def rank(s: Step) -> int:
        if s.key not in out:
            out[s.key] = (s.kind == "solve") + max((rank(i) for i in s.inputs.values()), default=0)
        return out[s.key]

    for s in needed.values():
        rank(s)
    return out


def _planned(r: Resources, unknowns: int, most: int) -> Resources:
    """At ``most`` so many workers as fit the machine, memory for such a model each, threads of what is left."""
    need = max(LEAST, ROOM * solve_memory(unknowns))
    fit = r.workers or max(1, min(cores() // (r.threads or 1), int(free_memory() / need), most))
    threads = r.threads or (max(1, cores() // fit) if unknowns >= LARGE or fit == 1 else 1)
    return replace(r, workers=fit, threads=threads, memory=float(f"{need:.3g}"))


def unknowns(store: Store, step: Step) -> int:
    """Unknowns of the model that a step solves; 0 where it is not there."""
    ahead: Step | None = step
    while ahead is not None:
        record = store.record(ahead.key)
        if "unknowns" in record:
            return int(record["unknowns"])
        if ahead.kind in ("build", "adopt"):
            return _counted(store, ahead, record)
        ahead = ahead.inputs.get("model") or ahead.inputs.get("cell")
    return 0


def _counted(store: Store, step: Step, record: Mapping[str, Any]) -> int:
    """Of a model that an earlier febkit put into the store."""
    from febkit import feb

    if "nodes" in record:
        return 4 * int(record["nodes"])
    path = store.path(step.key) / MODEL
    return size(feb.read(path)) if path.is_file() else 0


def cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def free_memory() -> float:
    """GB that are free now."""
    import psutil  # type: ignore[import-untyped]

    return float(psutil.virtual_memory().available) / 1e9


Tell = Callable[[str], None]
