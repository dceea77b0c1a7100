"""Many damaged copies of many models through reading, checking and lowering.

    python tests/benchmarks/mutants.py 20000 FOLDER... --seed 1 --keep FAULTS

Prints how they end; writes those that end in anything but a sentence or a problem to solve into ``--keep``.
"""

from __future__ import annotations

import argparse
import sys
import time
import warnings
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
from helpers.mutants import run


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("count", type=int)
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--largest", type=int, default=60_000, help="bytes of an original")
    parser.add_argument("--keep", type=Path)
    args = parser.parse_args()
    warnings.simplefilter("ignore")
    paths = sorted(p for f in args.folders for p in f.rglob("*.feb") if p.stat().st_size <= args.largest)
    start = time.perf_counter()
    report = run([p.read_bytes() for p in paths], args.count, args.seed)
    print(f"{args.count} mutants of {len(paths)} models in {time.perf_counter() - start:.0f} s, "
          f"the slowest {report.slowest:.2f} s: {dict(report.ends)}")
    for what, n in Counter(w for w, _ in report.faults).most_common():
        print(f"{n:6d}  {what}")
    if args.keep is not None:
        args.keep.mkdir(parents=True, exist_ok=True)
        for k, (what, data) in enumerate(report.faults):
            (args.keep / f"{k}.feb").write_bytes(data + f"\n<!-- {what.replace('--', '')} -->\n".encode())
    return 1 if report.faults else 0


if __name__ == "__main__":
    sys.exit(main())
