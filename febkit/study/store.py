"""Where results are kept: one folder for each step, under its address, there completely or not at all."""

from __future__ import annotations

import json
import os
import shutil
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any


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
        record, start = dict(about), time.perf_counter()
        try:
            yield folder, record
            record["seconds"] = round(time.perf_counter() - start, 3)
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

    def sweep(self) -> None:
        """Remove what interrupted steps left behind. For the start of a run, when nothing is at work."""
        shutil.rmtree(self.root / "making", ignore_errors=True)
