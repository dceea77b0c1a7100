"""Where results are kept: one folder for each step, under its address, there completely or not at all."""

from __future__ import annotations

import json
import os
import re
import shutil
import socket
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from febkit.files import lock
from febkit.model import InputError

_MADE = re.compile(r"[0-9a-f]{32}-\w{6,10}")  # a step's address, and what tempfile adds


@dataclass(frozen=True, slots=True)
class Store:
    """Folders ``<root>/store/<key>``; a step works in a folder of its own that is moved into place when done.

    Two workers that do the same step do no harm: the first to finish stays.
    """

    root: Path

    def path(self, key: str) -> Path:
        return self.root / "store" / key[:2] / key

    def begun(self, key: str) -> Path:
        """Where a solve that takes several sittings lies until it is done."""
        return self.root / "begun" / key

    def has(self, key: str) -> bool:
        return bool(self.record(key))

    def record(self, key: str) -> dict[str, Any]:
        """What is known about a finished step: kind, label, seconds, ...; nothing where it is not there, or damaged."""
        return _read(self.path(key) / "step.json")

    @contextmanager
    def making(self, key: str, about: dict[str, Any]) -> Iterator[tuple[Path, dict[str, Any]]]:
        """A fresh folder for a step, and its record; kept only where the block ends without an error."""
        base = self.root / "making"
        base.mkdir(parents=True, exist_ok=True)
        folder = Path(tempfile.mkdtemp(prefix=f"{key}-", dir=base))
        record, start, cpu = dict(about), time.perf_counter(), time.process_time()
        try:
            yield folder, record
            record["seconds"] = round(record.get("earlier_seconds", 0.0) + time.perf_counter() - start, 3)
            record["processor_seconds"] = round(time.process_time() - cpu, 3)  # all threads of this process
            record["finished"] = time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime())
            (folder / "step.json").write_text(json.dumps(record, indent=1, sort_keys=True))
            self._move(folder, key)
        finally:
            shutil.rmtree(folder, ignore_errors=True)

    def _move(self, folder: Path, key: str) -> None:
        target = self.path(key)
        target.parent.mkdir(parents=True, exist_ok=True)
        try:
            os.rename(folder, target)
        except OSError:
            if not self.has(key):  # not a race that another worker won: what is there has lost its record
                shutil.rmtree(target, ignore_errors=True)
                os.rename(folder, target)
        (self.root / "failed" / f"{key}.json").unlink(missing_ok=True)

    def fail(self, key: str, about: dict[str, Any], message: str) -> None:
        """Remember why a step failed; it is tried again in the next run."""
        folder = self.root / "failed"
        folder.mkdir(parents=True, exist_ok=True)
        (folder / f"{key}.json").write_text(json.dumps({**about, "message": message}, indent=1))

    def failure(self, key: str) -> str | None:
        found = _read(self.root / "failed" / f"{key}.json")
        return str(found.get("message", "it is not known why")) if found else None

    def drop(self, key: str) -> None:
        """Forget a result; it is made again if anything asks for it."""
        (self.path(key) / "step.json").unlink(missing_ok=True)
        shutil.rmtree(self.path(key), ignore_errors=True)

    @contextmanager
    def alone(self) -> Iterator[None]:
        """One run at a time; what an interrupted one left behind is removed first.

        Raises InputError where another run is at work here. The lock goes with the process that has it, whatever
        is written in its file.
        """
        self.root.mkdir(parents=True, exist_ok=True)
        path = self.root / "running"
        with open(path, "a+", encoding="utf-8", errors="replace") as running:
            if not lock(running.fileno()):
                running.seek(0)
                who = " ".join(running.read(200).split())
                raise InputError(
                    f"another run is at work in {self.root}{f' (host and process {who})' if who else ''}; wait for it"
                )
            running.truncate(0)
            running.write(f"{socket.gethostname()} {os.getpid()}")
            running.flush()
            self._clear()
            try:
                yield
            finally:
                running.truncate(0)

    def _clear(self) -> None:
        """Remove the folders in which steps were being made, and nothing else that may lie there."""
        base = self.root / "making"
        if base.is_symlink() or not base.is_dir():
            return
        for folder in base.iterdir():
            if _MADE.fullmatch(folder.name) and not folder.is_symlink():
                shutil.rmtree(folder, ignore_errors=True)


def _read(path: Path) -> dict[str, Any]:
    """A record, or nothing where it is not there or not whole."""
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return data if isinstance(data, dict) else {}
