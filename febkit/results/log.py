"""Reads the log of a run, FEBio's or febkit's: steps, convergence, messages, data records, summary."""

from __future__ import annotations

import math
import os
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from febkit.model import InputError, Where

from . import records
from .records import Record

if TYPE_CHECKING:
    import pandas as pd

# no pattern may give back what it took, or a long line takes for ever
_LONGEST = 400  # characters of a line that says something about the run
_NUMBER = r"([-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d+)?|[-+]?nan|[-+]?inf)"
_BEGIN = re.compile(rf"===== beginning time step (\d+)\s*:\s*{_NUMBER}")
_CONVERGED = re.compile(rf"------- converged at time\s*:\s*{_NUMBER}")
_FAILED = re.compile(r"------- failed to converge")
_STATUS = re.compile(rf"Nonlinear solution status: time=\s*{_NUMBER}")
_COUNT = re.compile(rf"^\s*(stiffness updates|right hand side evaluations|stiffness matrix reformations"
                    rf"|step from line search)\s*=\s*{_NUMBER}")
_NORM = re.compile(r"[A-Za-z][\w ()]*")
_FLOAT = re.compile(_NUMBER)
_SUMMARY = re.compile(r"^\s*([A-Za-z][\w \t,()/.-]*+):\s*([-+\d.eE:]+)\s*(?:\(([^)]*)\)|\w+)?\s*$")
_BOX = re.compile(r"^\s*\*+\s*$")
_KIND = re.compile(r"^\s*\*\s*(WARNING|ERROR|FATAL ERROR)\s*\*?\s*$")
_RECORD = re.compile(r"^Data Record #(\d+)")


@dataclass(frozen=True, slots=True)
class Message:
    """A warning or an error of the run."""

    kind: str  # "WARNING" or "ERROR"
    text: str
    line: int


@dataclass(slots=True)
class Log:
    """What a log says.

    ``steps``: one row per attempted time step (step, time, converged, iterations, reformations).
    ``iterations``: one row per equilibrium iteration (step, time, iteration, counts, and for each norm
    ``<norm>``, ``<norm>_initial``, ``<norm>_required``).
    """

    steps: pd.DataFrame
    iterations: pd.DataFrame
    messages: list[Message]
    records: list[Record]
    summary: dict[str, float]
    normal: bool | None  # None: the run goes on, or its log was cut

    @property
    def errors(self) -> list[Message]:
        return [m for m in self.messages if m.kind == "ERROR"]

    @property
    def warnings(self) -> list[Message]:
        return [m for m in self.messages if m.kind == "WARNING"]


@dataclass(slots=True)
class _Reading:
    steps: list[dict[str, Any]] = field(default_factory=list)
    iterations: list[dict[str, Any]] = field(default_factory=list)
    messages: list[Message] = field(default_factory=list)
    records: list[Record] = field(default_factory=list)
    summary: dict[str, float] = field(default_factory=dict)
    normal: bool | None = None
    ending: bool = False

    def line(self, text: str) -> None:
        if len(text) > _LONGEST:
            return
        if found := _BEGIN.search(text):
            self.steps.append({"step": int(found[1]), "time": float(found[2]), "converged": False,
                               "iterations": 0, "reformations": 0})
        elif found := _STATUS.search(text):
            self._iteration(float(found[1]))
        elif self.iterations and (found := _COUNT.match(text)):
            self._count(found[1], float(found[2]))
        elif self.iterations and not self.ending and (norm := _norm(text)):
            name, values = norm
            row = self.iterations[-1]
            row[f"{name}_initial"], row[name], row[f"{name}_required"] = values
        elif self.steps and (found := _CONVERGED.search(text)):
            self.steps[-1] |= {"converged": True, "time": float(found[1])}
        elif "N O R M A L   T E R M I N A T I O N" in text or "E R R O R   T E R M I N A T I O N" in text:
            self.normal = "N O R M A L" in text
        elif re.search(r"I T E R A T I O N\s+(S U M M A R Y|I N F O R M A T I O N)", text):
            self.ending = True
        elif self.ending and (found := _SUMMARY.match(text)):
            self._total(found[1].strip(" \t."), found[2], found[3] or "")

    def _total(self, name: str, value: str, aside: str) -> None:
        """A line of the summary; times as h:m:s, or as (seconds sec) where the log says so."""
        seconds = re.match(rf"\s*{_NUMBER} sec", aside)
        try:
            parts = [float(p) for p in (seconds[1] if seconds else value).split(":")]
        except ValueError:
            return
        if len(parts) > 3:
            return
        self.summary[name] = sum(p * 60**k for k, p in enumerate(reversed(parts)))

    def _iteration(self, time: float) -> None:
        if not self.steps:
            return
        step = self.steps[-1]
        step["iterations"] += 1
        self.iterations.append({"step": step["step"], "time": time, "iteration": step["iterations"]})

    def _count(self, name: str, value: float) -> None:
        key = {"stiffness updates": "updates", "right hand side evaluations": "residuals",
               "stiffness matrix reformations": "reformations", "step from line search": "line_search"}[name]
        self.iterations[-1][key] = value
        if key == "reformations" and math.isfinite(value):
            self.steps[-1]["reformations"] = int(value)


def _norm(text: str) -> tuple[str, list[float]] | None:
    """Name of a norm and its initial, current and required value: "  fluid pressure  1.0  2.0  3.0"."""
    name, *numbers = text.rsplit(None, 3) or [""]
    name = name.strip()
    if not text[:1].isspace() or len(numbers) < 3 or not all(map(_FLOAT.fullmatch, numbers)):
        return None
    return (name.replace(" ", "_"), [float(x) for x in numbers]) if _NORM.fullmatch(name) else None


def read_log(path: str | os.PathLike[str]) -> Log:
    """Read a log; one that is still being written reads as far as it goes."""
    import pandas as pd

    try:
        text = Path(path).read_text(encoding="utf-8", errors="replace")
    except OSError as e:
        raise InputError(f"cannot read the log: {e.strerror}", Where(str(path))) from None
    reading = _Reading()
    lines = text.splitlines()
    i = 0
    while i < len(lines):
        if _RECORD.match(lines[i]):
            record, i = records.in_log(lines, i)
            reading.records.append(record)
            continue
        message, after = _message(lines, i)
        if message is not None:
            reading.messages.append(message)
            i = after
            continue
        reading.line(lines[i])
        i += 1
    return Log(
        pd.DataFrame(reading.steps, columns=["step", "time", "converged", "iterations", "reformations"]),
        pd.DataFrame(reading.iterations),
        reading.messages,
        reading.records,
        reading.summary,
        reading.normal,
    )


def _message(lines: list[str], i: int) -> tuple[Message | None, int]:
    """A box of stars, or "*  WARNING" and the starred lines after it."""
    start = i
    if _BOX.match(lines[i]):
        i += 1
    found = _KIND.match(lines[i]) if i < len(lines) else None
    if found is None:
        return None, start
    body: list[str] = []
    for j in range(i + 1, len(lines)):
        line = lines[j].strip()
        if not line.startswith("*") or (_BOX.match(line) and body):
            break
        if _KIND.match(lines[j]):
            break
        body.append(line.strip("* ").strip())
    text = " ".join(b for b in body if b)
    end = i + 1 + len(body)
    return Message(found[1].split()[-1], text, start + 1), end + _closing(lines, end)


def _closing(lines: list[str], i: int) -> int:
    return int(i < len(lines) and _BOX.match(lines[i]) is not None)
