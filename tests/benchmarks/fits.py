"""Fits of synthetic experiments: truth from data without noise, and how often 95 % intervals hold it.

    python tests/benchmarks/fits.py [name ...] [--fits 100]
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

import febkit  # noqa: E402
from helpers.specimens import SPECIMENS, Specimen  # noqa: E402

NOISE = 0.01  # standard deviation over the greatest value


def truth(s: Specimen, names: list[str]) -> np.ndarray:
    return np.array([s.truth[n] for n in names])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", default=list(SPECIMENS))
    parser.add_argument("--fits", type=int, default=100)
    given = parser.parse_args()
    for name in given.names:
        s = SPECIMENS[name]
        data = s.measured()
        began = time.process_time()
        exact = febkit.fit(s.model(), s.bounds, data, s.observe)
        spent = time.process_time() - began
        off = np.abs(np.array(list(exact.values.values())) / truth(s, exact.names) - 1.0)
        print(f"{name}: without noise off by {off.max():.1e}, {exact.runs} runs, {spent:.2f} s of processor time", flush=True)
        held, runs, left = np.zeros(len(off)), 0, 0
        began = time.process_time()
        for seed in range(given.fits):
            noisy = data.copy()
            noise = np.random.default_rng(seed).normal(size=data[:, 1:].shape)
            noisy[:, 1:] += NOISE * np.abs(data[:, 1:]).max(axis=0) * noise
            f = febkit.fit(s.model(), s.bounds, noisy, s.observe, tolerance=1e-4)
            low, high = np.array(list(f.intervals.values())).T
            left += not np.isfinite(low).all()
            held += (low <= truth(s, f.names)) & (truth(s, f.names) <= high)
            runs += f.runs
        said = ", ".join(f"{n} {int(h)}" for n, h in zip(exact.names, held))
        print(f"  of {given.fits} noisy fits the interval holds {said}; {left} without; {runs / given.fits:.1f} runs and "
              f"{(time.process_time() - began) / given.fits:.2f} s of processor time a fit", flush=True)  # fmt: skip


if __name__ == "__main__":
    main()
