"""What derivatives by five parameters cost: processor time of a run with them over that of one without, in pairs.

    python tests/benchmarks/sensitivity.py [--pairs 3] [--models ../shared/oracle/bench/models/tissue15_B.feb]

The plug of 432 elements in examples, states kept at eight times, and each further model with the states that it keeps.
"""

from __future__ import annotations

import argparse
import time
import warnings
from pathlib import Path
from typing import Any

import numpy as np

import febkit

PLUG = Path(__file__).parents[2] / "examples" / "unconfined_compression.feb"
KEPT = ["displacement", "effective fluid pressure", "reaction forces"]


def seconds(m: febkit.Model, **options: Any) -> float:
    start = time.process_time()
    result = m.solve(variables=KEPT, threads=1, warn=lambda _: None, **options)
    assert result.converged, result.reason
    assert "displacement" in result.dataset
    if "sensitivity" in options:
        assert set(result.sensitivity["method"].values) == {"direct"}
    return time.process_time() - start


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pairs", type=int, default=3)
    parser.add_argument("--models", type=Path, nargs="*", default=[])
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    for path in [PLUG, *given.models]:
        m = febkit.read(path)
        name = next(iter(m.materials))
        paths = [f"{name}.solid.E", f"{name}.solid.v", f"{name}.permeability.perm", "fem.bc[3].value",
                 "fem.load_controller[0].points[1].x"]  # fmt: skip
        at: dict[str, Any] = {"at": [1, 5, 10, 50, 100, 200, 500, 1000]} if path == PLUG else {}
        seconds(m, **at)
        ratios = [seconds(m, sensitivity=paths, **at) / seconds(m, **at) for _ in range(given.pairs)]
        print(f"{path.stem}: {np.median(ratios):.2f} ({min(ratios):.2f} to {max(ratios):.2f})", flush=True)


if __name__ == "__main__":
    main()
