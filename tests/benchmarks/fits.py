"""Fits of synthetic experiments: the truth from data without noise, and how often 95 % intervals hold it.

    python tests/benchmarks/fits.py [name ...] [--fits 100] [--first 1000]

Noise is normal, of 1 % of the greatest value, draws are those of the seeds from ``--first`` on. Noisy fits start from
the truth; what they run in common, at their start, is run once. Rates are followed by the standard deviation that a
rate of 95 % has in so many fits. Seconds are of this process's time on its processor.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

import febkit
from febkit.fitting.experiment import Measured
from febkit.fitting.parameters import Parameter, Spec
from helpers.specimens import SPECIMENS, Specimen

NOISE = 0.01


def truth(s: Specimen, names: Sequence[str]) -> np.ndarray:
    return np.array([s.truth[n] for n in names])


def from_the_truth(s: Specimen) -> dict[Any, Spec]:
    out: dict[Any, Spec] = {}
    for key, spec in s.bounds.items():
        true = s.truth[key if isinstance(key, str) else key[0]]
        p = spec if isinstance(spec, Parameter) else Parameter(*map(float, spec))
        out[key] = replace(p, start=true)
    return out


def remember() -> None:
    """A run that was made once is not made again."""
    known: dict[Any, Any] = {}
    real = Measured.predict

    def predict(self: Measured, settings: Any, ends: Sequence[float] | None = None, beside: bool = False) -> Any:
        key = (tuple(settings.items()), None if ends is None else tuple(ends), beside)
        if key not in known:
            known[key] = real(self, settings, ends, beside)
        return known[key]

    Measured.predict = predict  # type: ignore[method-assign]


def exact(name: str, s: Specimen) -> None:
    data = s.measured()
    began = time.process_time()
    f = febkit.fit(s.model(), s.bounds, data, s.observe)
    off = np.abs(np.array(list(f.values.values())) / truth(s, f.names) - 1.0)
    spent = time.process_time() - began
    print(f"{name}: without noise off by {off.max():.1e}; {f.runs} runs, {spent:.2f} s", flush=True)


def noisy(name: str, s: Specimen, fits: int, first: int) -> None:
    data, start = s.measured(), from_the_truth(s)
    held: dict[str, int] = {}
    began, without = time.process_time(), 0
    for seed in range(first, first + fits):
        made = data.copy()
        drawn = np.random.default_rng(seed).normal(size=data[:, 1:].shape)
        made[:, 1:] += NOISE * np.abs(data[:, 1:]).max(axis=0) * drawn
        f = febkit.fit(s.model(), start, made, s.observe, tolerance=1e-4)
        without += any(np.isnan(low) for low, _ in f.intervals.values())
        for n, (low, high) in f.intervals.items():
            held[n] = held.get(n, 0) + bool(low <= s.truth[n] <= high)
    said = ", ".join(f"{n} {100 * k / fits:.1f}" for n, k in held.items())
    spent = (time.process_time() - began) / fits
    within = 100 * (0.95 * 0.05 / fits) ** 0.5
    print(f"{name}: of {fits} noisy fits intervals hold {said} % (+- {within:.1f}); {without} have none; "
          f"{spent:.2f} s each", flush=True)  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", default=list(SPECIMENS))
    parser.add_argument("--fits", type=int, default=100)
    parser.add_argument("--first", type=int, default=1000)
    given = parser.parse_args()
    for name in given.names:
        exact(name, SPECIMENS[name])
    remember()
    for name in given.names:
        noisy(name, SPECIMENS[name], given.fits, given.first)


if __name__ == "__main__":
    main()
