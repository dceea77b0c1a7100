"""Carry out a plan: here one step after the other, or on a Dask cluster, what is independent at once."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Generator, Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from febkit.model import InputError

from .config import Resources
from .memory import Tell, cores, free_memory, stages
from .plan import Work
from .step import Step
from .store import Store

# done steps, all steps, the step just finished and how
Progress = Callable[[int, int, "Outcome"], None]


@dataclass(frozen=True, slots=True)
class Outcome:
    """How a step ended: "done", "failed" (``message`` says why) or "skipped" (an input is missing)."""

    key: str
    label: str
    state: str
    message: str = ""
    seconds: float = 0.0


@dataclass(slots=True)
class Summary:
    """What a run did."""

    done: list[Outcome] = field(default_factory=list)
    failed: list[Outcome] = field(default_factory=list)
    skipped: list[Outcome] = field(default_factory=list)
    reused: int = 0

    def add(self, o: Outcome) -> None:
        {"done": self.done, "failed": self.failed, "skipped": self.skipped}[o.state].append(o)

    @property
    def complete(self) -> bool:
        return not self.failed and not self.skipped


def carry_out(
    plan: Work, scheduler: str = "local", progress: Progress | None = None, tell: Tell | None = None
) -> Summary:
    """Do what the store does not hold yet; a second run after an interruption carries on.

    scheduler  "local" (Dask workers on this machine), "serial" (this process), or the address of a Dask
               scheduler such as "tcp://host:8786" whose workers see the study's folder
    tell       is told what workers are planned
    """
    store = Store(plan.folder.resolve())
    with store.alone():
        needed = plan.needed(store)
        summary = Summary(reused=len(plan.steps()) - len(needed))
        r = plan.resources
        if scheduler == "serial":
            outcomes = _serial(store, needed, r)
        elif scheduler == "local":
            outcomes = _local(store, needed, r, tell or (lambda _: None))
        else:
            outcomes = _dask(store, needed, r, scheduler)
        with closing(outcomes):  # workers go at once where this is interrupted
            for outcome in outcomes:
                summary.add(outcome)
                if progress is not None:
                    count = len(summary.done) + len(summary.failed) + len(summary.skipped)
                    progress(count, len(needed), outcome)
    return summary


def do(root: str, spec: dict[str, Any], *waited_for: object) -> Outcome:
    """One step, wherever it runs. Expected failures are outcomes, not exceptions."""
    from . import work

    store, key = Store(Path(root)), spec["key"]
    about = {k: spec[k] for k in ("kind", "label", "params", "inputs")}
    if store.has(key):
        for k in spec["drop"]:
            store.drop(k)
        return Outcome(key, spec["label"], "done", "found in the store")
    if spec.get("dropped_by") and store.has(spec["dropped_by"]):  # asked for again, as its worker died afterwards
        return Outcome(key, spec["label"], "done", "no longer needed")
    if not all(store.has(k) for k in spec["inputs"].values()):
        return Outcome(key, spec["label"], "skipped", "a step it rests on has not been done")
    inputs = {n: store.path(k) for n, k in spec["inputs"].items()}
    try:
        with store.making(key, about) as (folder, record):
            every = spec.get("checkpoint", "")
            try_ = work.Try(spec.get("limit", 0.0), spec.get("retry", False), every, store.begun(key))
            work.KINDS[spec["kind"]](work.Job(folder, spec["params"], inputs, record, spec["files"], try_))
    except (InputError, work.SolveFailed) as e:
        store.fail(key, about, str(e))
        return Outcome(key, spec["label"], "failed", str(e))
    for k in spec["drop"]:
        store.drop(k)
    again = f"at the second try, {record['retried']}; before: {record['before']}" if "retried" in record else ""
    return Outcome(key, spec["label"], "done", again, record["seconds"])


def _spec(step: Step, r: Resources) -> dict[str, Any]:
    return step.spec() | {"limit": r.limit, "retry": r.retry, "checkpoint": r.checkpoint}


def _serial(store: Store, needed: dict[str, Step], r: Resources) -> Generator[Outcome, None, None]:
    for step in needed.values():
        yield do(str(store.root), _spec(step, r))


def _local(store: Store, needed: dict[str, Step], r: Resources, tell: Tell) -> Generator[Outcome, None, None]:
    """On workers of this machine, planned stage by stage."""
    for stage in stages(needed, store, r):
        if stage.said:
            tell(stage.said)
        if stage.serial:
            yield from _serial(store, stage.steps, r)
        else:
            yield from _dask(store, stage.steps, stage.resources, "local")


def _dask(store: Store, needed: dict[str, Step], r: Resources, scheduler: str) -> Generator[Outcome, None, None]:
    if not needed:
        return
    try:
        from distributed import Client, as_completed
    except ImportError:
        raise InputError(
            'the "local" scheduler and tcp:// addresses need Dask: pip install "febkit[dask]", '
            "or use --scheduler serial"
        ) from None
    with _client(Client, r, len(needed), scheduler) as client:
        _check_sight(client, store)
        futures: dict[str, Any] = {}
        root = str(store.root)
        by = {k: s.key for s in needed.values() for k in s.spec()["drop"]}
        for key, step in needed.items():
            spec = _spec(step, r) | {"dropped_by": by.get(key, "")}
            first = [futures[i.key] for i in step.inputs.values() if i.key in futures]
            name = f"{step.kind}-{key}"
            futures[key] = client.submit(_at_worker, root, spec, *first, key=name, pure=False, retries=2)
        label = {futures[k].key: s for k, s in needed.items()}
        ended = as_completed(list(futures.values()))
        futures.clear()  # what nobody holds any more is not done again where a worker dies that had its outcome
        lost: set[str] = set()
        for future in ended:
            step, error = label[future.key], future.exception()
            outcome = future.result() if error is None else None
            del future
            if outcome is not None:
                yield outcome
                continue
            rests = any(i.key in lost for i in step.inputs.values())
            lost.add(step.key)
            if rests:
                yield Outcome(step.key, step.label, "skipped", "a step it rests on has not been done")
                continue
            message = f"{type(error).__name__}: {error}"
            store.fail(step.key, {"kind": step.kind, "label": step.label}, message)
            yield Outcome(step.key, step.label, "failed", message)


def _at_worker(root: str, spec: dict[str, Any], *waited_for: object) -> Outcome:
    """:func:`do`, of which nothing becomes a client of the cluster itself, as xarray's locks of files would."""
    import dask

    with dask.config.set(scheduler="synchronous"):
        return do(root, spec, *waited_for)


@contextmanager
def _client(make: Any, r: Resources, steps: int, scheduler: str) -> Iterator[Any]:
    """A client of the cluster asked for; a local cluster is made to fit the machine."""
    if scheduler != "local":
        try:
            client = make(scheduler, timeout="10s")
        except (OSError, ValueError) as e:
            raise InputError(f"cannot reach a Dask scheduler at {scheduler!r}: {e}") from None
        with client:
            yield client
        return
    import dask
    from distributed import LocalCluster

    workers = min(fitting_workers(r), max(steps, 1))
    env = {
        k: str(r.threads)
        for k in ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "FEBKIT_THREADS")
    } | {"OPENBLAS_NUM_THREADS": "1"}  # as febkit run has it
    with dask.config.set(
        {"distributed.nanny.pre-spawn-environ": env, "distributed.worker.memory.terminate": 0.98}
    ):
        with _held_interrupts():
            cluster = LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                processes=True,
                memory_limit=f"{r.memory}GB",
                dashboard_address=":0",
                silence_logs=50,
            )
        with cluster, make(cluster) as client:
            yield client


@contextmanager
def _held_interrupts() -> Iterator[None]:
    """Ctrl-C waits, and never reaches the threads and processes that begin in here: this one ends them."""
    from multiprocessing import resource_tracker

    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    resource_tracker.ensure_running()  # which lifts the block of whoever starts it
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def fitting_workers(r: Resources) -> int:
    """Solves at a time: cores over threads each, and no more than memory has room for."""
    if r.workers:
        return r.workers
    by_cores = max(1, cores() // max(1, r.threads))
    return max(1, min(by_cores, int(free_memory() / r.memory)))


def _check_sight(client: Any, store: Store) -> None:
    """Workers on other machines must see the study's folder under the same path."""
    seen = client.run(os.path.isdir, str(store.root))
    blind = [w for w, ok in seen.items() if not ok]
    if blind:
        raise InputError(
            f"workers {', '.join(blind[:3])} do not see {store.root}: "
            "put the study on a file system that all of them share"
        )
