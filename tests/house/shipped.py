"""The kernels that models call, for the libraries that come with the wheel: adds them to solver/shipped.txt.

    python tests/house/shipped.py [--seconds 10] MODEL.feb ...

A model is run until it ends or has called nothing new for so many seconds. Lines whose kernel is gone are dropped.
"""

from __future__ import annotations

import argparse
import gc
import inspect
import os
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import febkit
from febkit.solver import build
from febkit.solver.jit import Kernel

TABLE = Path(__file__).parents[2] / "solver" / "shipped.txt"


def lines() -> set[str]:
    """Lines of the table."""
    return set(TABLE.read_text().splitlines())


def stands(line: str) -> bool:
    """Is there a kernel of that name, with as many arguments?"""
    module, name, types = line.split(" ", 2)
    try:
        return len(inspect.signature(build.kernel(f"{module} {name}").function).parameters) == len(types.split())
    except (AttributeError, ModuleNotFoundError):
        return False


def called() -> set[str]:
    """Lines for all kernels that this process has called so far."""
    kernels = [k for k in gc.get_objects() if type(k) is Kernel]
    return {f"{k.__module__.removeprefix('febkit.solver.')} {k.__name__} {t}" for k in kernels for t in k.found}


def record(model: str, plotfile: str, seconds: float) -> None:
    """Run a model and print what it calls."""
    solving = threading.Thread(target=febkit.solve, args=(model, plotfile), daemon=True)
    solving.start()
    seen, last = called(), time.monotonic()
    while solving.is_alive() and time.monotonic() < last + seconds:
        solving.join(0.2)
        if called() - seen:
            seen, last = called(), time.monotonic()
    print(*called(), sep="\n", flush=True)
    os._exit(0)


def calls(model: str | Path, seconds: float = 10.0) -> set[str]:
    """What a model calls, in a process of its own."""
    with tempfile.TemporaryDirectory() as folder:
        args = [sys.executable, __file__, "--seconds", str(seconds), "--record", f"{folder}/plot.xplt", str(model)]
        said = subprocess.run(args, stdout=subprocess.PIPE, text=True, check=True).stdout
    return set(said.splitlines()) - {""}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("models", nargs="+", metavar="MODEL.feb")
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--record", metavar="PLOTFILE", help="print what the one model calls")
    asked = parser.parse_args()
    if asked.record:
        record(asked.models[0], asked.record, asked.seconds)
    found = lines()
    for model in asked.models:
        new = calls(model, asked.seconds) - found
        print(f"{model}: {len(new)} new", flush=True)
        found |= new
    TABLE.write_text("".join(f"{line}\n" for line in sorted(found) if stands(line)))


if __name__ == "__main__":
    main()
