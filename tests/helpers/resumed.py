"""Runs that are killed at random moments and gone on with, beside the same runs unbroken."""

from __future__ import annotations

import random
import re
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from febkit.checkpoint import read

DATA = Path(__file__).parents[1] / "output" / "data"
GENERATIONS = "".join(
    f'<generation id="{k}"><start_time>{t}</start_time>'
    f'<solid type="neo-Hookean"><E>{E}</E><v>0.3</v></solid></generation>'
    for k, (t, E) in enumerate([(0.0, 1.0), (0.2, 0.5), (0.55, 2.0)], 1)
)
# model, what of it is replaced, options of the run
KINDS: dict[str, tuple[str, tuple[tuple[str, str], ...], tuple[str, ...]]] = {
    "bonds that form as it is strained": ("bonds", (), ()),
    "kept factorisation": ("biphasic", (), ("--factor", "reuse", "--linear", "pardiso")),
    "contact": ("sliding", (), ()),
    "rigid bodies": ("rigid", (), ()),
    "generations": ("dynamic", (
        (r'type="neo-Hookean">.*?</material>', f'type="multigeneration">{GENERATIONS}</material>'),
    ), ()),
}  # fmt: skip
OUTPUT = (
    '<Output><plotfile type="febio"><var type="displacement"/><var type="stress"/><var type="contact pressure"/>'
    '</plotfile><logfile><node_data data="ux;uz" file="nodes.txt"/></logfile></Output>'
)


def deck(kind: str, steps: int) -> tuple[str, tuple[str, ...]]:
    """The model of a kind in so many steps, which writes a data file as well, and the options of its run."""
    name, edits, options = KINDS[kind]
    text = (DATA / f"{name}.feb").read_text()
    control = f"<time_steps>{steps}</time_steps><step_size>{1 / steps!r}</step_size>"
    for old, new in ((r"<time_steps>.*?</step_size>", control), (r"<Output/>", OUTPUT), *edits):
        assert re.search(old, text, re.S), (kind, old)
        text = re.sub(old, new, text, count=1, flags=re.S)
    return text, options


def kill_and_go_on(
    folder: Path, kind: str, steps: int, kills: int, rng: random.Random, start: Callable[..., Any], every: int = 3
) -> int:
    """Solve the model once unbroken, and once killed so often and gone on with each time; hold that both are one.

    ``start("run", ...)`` starts the command in ``folder``. Kills come at random moments after the first checkpoint.
    Returns the kills that came before the end.
    """
    text, options = deck(kind, steps)
    plan = [*options, "-t", "1", "-silent", "--checkpoint", f"every={every}steps,keep"]
    for name in ("whole", "broken"):
        (folder / name).mkdir()
        (folder / name / "m.feb").write_text(text)
    began = time.monotonic()
    _ended(start("run", "whole/m.feb", *plan))
    seconds, kept, within = time.monotonic() - began, folder / "broken" / "m.checkpoint", 0
    for k in range(kills):
        job = start("run", "broken/m.feb", *plan, *(["--resume"] if k else []))
        while not kept.exists() and job.poll() is None:
            time.sleep(0.002)
        time.sleep(rng.random() * seconds / (kills + 1))
        within += job.poll() is None
        job.kill()
        job.communicate()
    _ended(start("run", "broken/m.feb", *plan, "--resume"))
    for name in ("m.xplt", "nodes.txt"):
        a, b = ((folder / d / name).read_bytes() for d in ("whole", "broken"))
        assert a == b, f"{kind}: {name} is another one after {kills} kills"
    whole, broken = (read(folder / d / "m.checkpoint").run for d in ("whole", "broken"))
    assert differing(whole, broken) == [], kind
    return within


def _ended(job: Any) -> None:
    out, err = job.communicate()
    assert job.poll() == 0, f"{out}{err}"


def differing(a: Any, b: Any, where: str = "run") -> list[str]:
    """Places where two checkpoints are not the same, bit for bit."""
    if isinstance(a, np.ndarray):
        return [] if isinstance(b, np.ndarray) and a.tobytes() == b.tobytes() and a.shape == b.shape else [where]
    if isinstance(a, dict):
        return [p for k in {**a, **b} for p in differing(a.get(k), b.get(k), f"{where}.{k}")]
    if isinstance(a, (list, tuple)) and isinstance(b, (list, tuple)) and len(a) == len(b):
        return [p for k, (x, y) in enumerate(zip(a, b)) for p in differing(x, y, f"{where}[{k}]")]
    return [] if a == b or (a != a and b != b) else [where]
