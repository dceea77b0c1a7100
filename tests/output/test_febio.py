"""Plot variables and log items against FEBio's: values of FEBio 4.11 for the models in data/.

A line of data/febio.txt has a model, the plotfile or a record, a variable or item, the region in the plotfile, how many
numbers there are, the largest, and their sum weighted by cos 0, cos 1, ..., at the end of the run.
"""

from __future__ import annotations

from collections import defaultdict
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

import febkit
from febkit.results.xplt.reader import PlotFile

DATA = Path(__file__).parent / "data"
TOLERANCE = 1e-5  # of the largest value; the runs differ by their convergence


class Known(NamedTuple):
    model: str
    record: str  # "plot", or the record's element and its surface
    name: str
    region: str
    count: int
    largest: float
    weighted: float


def read() -> dict[str, list[Known]]:
    out = defaultdict(list)
    for line in (DATA / "febio.txt").read_text().splitlines():
        model, record, name, region, *numbers = (x.strip() for x in line.split(" | "))
        out[model].append(Known(model, record, name, region, int(numbers[0]), float(numbers[1]), float(numbers[2])))
    return out


KNOWN = read()


def output(known: list[Known]) -> tuple[str, list[tuple[str, str]]]:
    """<Output> that asks for these, and its records: (record, item) of each file in turn."""
    variables = dict.fromkeys(k.name for k in known if k.record == "plot")
    items = [(k.record, k.name) for k in known if k.record != "plot"]
    plot = "".join(f'<var type="{v}"/>' for v in variables)
    log = ""
    for i, (record, item) in enumerate(items):
        kind, *surface = record.split()
        of = f' surface="{surface[0]}"' if surface else ""
        log += f'<{kind}{of} data="{item}" file="{i}.txt" delim=","/>'
    return f'<Output><plotfile type="febio">{plot}</plotfile><logfile>{log}</logfile></Output>', items


def last(path: Path) -> list[float]:
    """The values of the last state of a data file of one item."""
    rows = path.read_text().split("*Step")[-1].splitlines()
    return [float(r.split(",")[1]) for r in rows if r[:1].isdigit()]


@pytest.mark.parametrize("model", KNOWN)
def test_values_are_febios(model: str, tmp_path: Path) -> None:
    known = KNOWN[model]
    asked, items = output(known)
    text = (DATA / f"{model}.feb").read_text()
    assert "<Output/>" in text
    (tmp_path / "a.feb").write_text(text.replace("<Output/>", asked))
    result = febkit.solve(tmp_path / "a.feb", plotfile=tmp_path / "a.xplt", logfile=tmp_path / "a.log")
    assert result.converged, result.reason
    plot = PlotFile(tmp_path / "a.xplt")
    index = {v.name: k for k, v in enumerate(plot.variables)}
    wrong = []
    for k in known:
        if k.record == "plot":
            values = dict(plot.regions(index[k.name.split("=")[-1]], len(plot.states) - 1))[int(k.region)]
        else:
            values = last(tmp_path / f"{items.index((k.record, k.name))}.txt")
        v = np.asarray(values, float).ravel()
        error = abs(float(v @ np.cos(np.arange(len(v)))) - k.weighted) if len(v) == k.count else np.inf
        if not error <= TOLERANCE * k.largest * np.sqrt(k.count):
            wrong.append(f"{k.record} {k.name} {k.region}: {len(v)} values off by {error:g}, {k}")
    assert not wrong, "\n".join(wrong)
