"""Time of opening and decoding a large plotfile, beside febio-python where it is installed.

    python tests/benchmarks/plotfile.py [--gb 1.0] [--domains 12] [--folder DIR]
"""

from __future__ import annotations

import argparse
import os
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from febkit import results
from febkit.results.variables import VARIABLES
from febkit.results.xplt.reader import PlotFile
from febkit.results.xplt.records import PlotDomain, PlotMesh
from febkit.results.xplt.writer import PlotWriter

NAMES = ("displacement", "effective fluid pressure", "stress", "fluid flux")


def cube(n: int, domains: int) -> PlotMesh:
    """n^3 hexahedra in equal slabs."""
    g = np.arange(n + 1)
    X = np.stack(np.meshgrid(g, g, g, indexing="ij"), -1).reshape(-1, 3) / n
    i, j, k = (a.ravel() for a in np.meshgrid(*[np.arange(n)] * 3, indexing="ij"))
    corner = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    conn = np.stack([((i + a) * (n + 1) + j + b) * (n + 1) + k + c for a, b, c in corner], axis=1)
    cuts = np.linspace(0, len(conn), domains + 1).astype(int)
    parts = [PlotDomain("hex8", 1, f"part{d}", np.arange(a + 1, b + 1), conn[a:b])
             for d, (a, b) in enumerate(zip(cuts[:-1], cuts[1:]))]
    return PlotMesh(np.arange(1, len(X) + 1), X, parts, parts=[(1, "tissue")])


def make(path: Path, gb: float, domains: int, version: int = 0x35) -> None:
    """States of 148,877 hexahedra until the file has about ``gb`` GB."""
    mesh = cube(53, domains)
    rng = np.random.default_rng(0)
    n, e = len(mesh.node_ids), mesh.n_elements
    u, p, s, q = (rng.random(shape, np.float32) for shape in ((n, 3), n, (e, 6), (e, 3)))
    with PlotWriter(path, mesh, [VARIABLES[v] for v in NAMES], version=version) as w:
        t = 0
        while w.output.size < gb * 1e9:
            w.state(0.1 * t, dict(zip(NAMES, (u + t, p, s, q))))
            t += 1


def best(do: Callable[[], object], repeat: int = 7) -> tuple[float, float]:
    """(best, median) seconds; the work's result is dropped outside the clock."""
    times = []
    for _ in range(repeat):
        start = time.perf_counter()
        kept = do()
        times.append(time.perf_counter() - start)
        del kept
    return min(times), float(np.median(times))


def main() -> None:
    args = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    args.add_argument("--gb", type=float, default=1.0)
    args.add_argument("--domains", type=int, default=12)
    args.add_argument("--folder", type=Path, default=None)
    o = args.parse_args()
    with tempfile.TemporaryDirectory(dir=o.folder) as folder:
        path = Path(folder) / "large.xplt"
        start = time.perf_counter()
        make(path, o.gb, o.domains)
        size = path.stat().st_size / 1e9
        print(f"{size:.2f} GB, 148877 hex8 in {o.domains} parts, written in {time.perf_counter() - start:.1f} s\n")
        print(f"{'':<44} {'best':>12} {'median':>12}")
        ours(path)
        peer(Path(folder), o.domains)


def line(what: str, times: tuple[float, float], gigabytes: float = 0.0) -> None:
    said = [f"{gigabytes / t:9.2f} GB/s" if gigabytes else f"{1e3 * t:9.2f} ms" for t in times]
    print(f"{what:<44} {said[0]:>12} {said[1]:>12}")


def ours(path: Path) -> None:
    results.open(path).close()  # imports are not the file's cost
    line("febkit: index of blocks", best(lambda: PlotFile(path)))
    line("febkit: dataset", best(lambda: results.open(path)))
    ds = results.open(path)
    line("one variable at one time", best(lambda: ds["displacement"].isel(time=-1).values))
    line("one node over all times", best(lambda: ds["displacement"].isel(node=7).values))
    out = np.ones((ds.sizes["time"], ds.sizes["node"], 3), np.float32)
    f = ds["displacement"].variable._data.array  # type: ignore[attr-defined]
    field = f.array.frames if hasattr(f, "array") else f.frames

    def refill() -> None:
        for t, row in enumerate(out):
            field.fill(t, row)

    line("all displacements, into memory at hand", best(refill), out.nbytes / 1e9)
    for name in ("displacement", "stress", "fluid_flux", "effective_fluid_pressure"):
        nbytes = ds[name].nbytes / 1e9
        line(f"all of {name}", best(lambda name=name: ds[name].values, 5), nbytes)
    start = np.ones(out.shape, np.float32)
    line("(a copy of as much memory)", best(lambda: np.copyto(out, start)), out.nbytes / 1e9)
    ds.close()


def peer(folder: Path, domains: int) -> None:
    """The same content, a tenth of the size, version 0x34, which febio-python still accepts."""
    try:
        from febio_python.xplt import read_xplt
    except ImportError:
        print("febio-python is not installed")
        return
    path = folder / "small.xplt"
    make(path, 0.05, domains, 0x34)
    size = os.path.getsize(path) / 1e9
    line(f"febkit: every variable of {size:.2f} GB", best(lambda: results.open(path).load(), 3), size)
    try:
        line("febio-python: the same file", best(lambda: read_xplt(str(path)), 1), size)
    except Exception as e:
        print(f"febio-python fails on it: {type(e).__name__}: {e}")


if __name__ == "__main__":
    main()
