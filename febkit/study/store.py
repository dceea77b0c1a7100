"""Where results are kept: one folder for each step, under its address, there completely or not at all."""

from __future__ import annotations

import json
import os
import shutil
import socket
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from febkit.model import InputError


@dataclass(frozen=True, slots=True)
class Store:
    """Folders ``<root>/store/<key>``; a step works in a folder of its own that is moved into place when done.

    Two workers that do the same step do no harm: the first to finish stays.
    """

    root: Path

    def path(self, key: str) -> Path:
        return self.root / "store" / key[:2] / key

    def has(self, key: str) -> bool:
        return (self.path(key) / "step.json").is_file()

    def record(self, key: str) -> dict[str, Any]:
        """What is known about a finished step: kind, label, seconds, ..."""
        data: dict[str, Any] = json.loads((self.path(key) / "step.json").read_text())
        return data

    @contextmanager
    def making(self, key: str, about: dict[str, Any]) -> Iterator[tuple[Path, dict[str, Any]]]:
        """A fresh folder for a step, and its record; kept only where the block ends without an error."""
        base = self.root / "making"
        base.mkdir(parents=True, exist_ok=True)
        folder = Path(tempfile.mkdtemp(prefix=f"{key}-", dir=base))
        record, start, cpu = dict(about), time.perf_counter(), time.process_time()
        try:
            yield folder, record
            record["seconds"] = round(time.perf_counter() - start, 3)
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
            if not self.has(key):  # not a race that another worker won
                raise
        (self.root / "failed" / f"{key}.json").unlink(missing_ok=True)

    def fail(self, key: str, about: dict[str, Any], message: str) -> None:
        """Remember why a step failed; it is tried again in the next run."""
        folder = self.root / "failed"
        folder.mkdir(parents=True, exist_ok=True)
        (folder / f"{key}.json").write_text(json.dumps({**about, "message": message}, indent=1))

    def failure(self, key: str) -> str | None:
        path = self.root / "failed" / f"{key}.json"
        return str(json.loads(path.read_text())["message"]) if path.is_file() else None

    def drop(self, key: str) -> None:
        """Forget a result; it is made again if anything asks for it."""
        (self.path(key) / "step.json").unlink(missing_ok=True)
        shutil.rmtree(self.path(key), ignore_errors=True)

    @contextmanager
    def alone(self) -> Iterator[None]:
        """One run at a time; what an interrupted one left behind is removed first.

        Raises InputError where another run is at work here.
        """
        self.root.mkdir(parents=True, exist_ok=True)
        lock, mine = self.root / "running", f"{socket.gethostname()} {os.getpid()}"
        if lock.is_file() and _alive(*lock.read_text().split()):
            raise InputError(
                f"another run is at work in {self.root} (host and process {lock.read_text()}); "
                f"wait for it, or remove {lock} if it is gone"
            )
        lock.write_text(mine)
        shutil.rmtree(self.root / "making", ignore_errors=True)
        try:
            yield
        finally:
            lock.unlink(missing_ok=True)


def _alive(host: str, pid: str) -> bool:
    """True where the process may still run: on another host that cannot be told."""
    if host != socket.gethostname():
        return True
    try:
        os.kill(int(pid), 0)
    except ProcessLookupError:
        return False
    except OSError:
        return True
    return True
