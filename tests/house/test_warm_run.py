"""A small model solved with kernels on disk pays for Python, numpy and LLVM's loader, and for nothing else."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from febkit.solver import jit
from helpers.files import load

BENCHMARK = Path(__file__).parents[1] / "benchmarks" / "startup.py"
PROGRAM = """
import sys
from febkit.cli.main import cli
cli.main(["run", {model!r}, *{options!r}], standalone_mode=False)
print(*sorted(m for m in sys.modules if "." not in m), *sorted({watched} & set(sys.modules)))
print("libmkl" in open("/proc/self/maps").read())
"""
# what once crept in: the third row by way of a function of the standard library or of numpy
UNWANTED = {
    "numba", "scipy", "xarray", "rich", "lxml", "meshio", "netCDF4", "pandas", "matplotlib", "asyncio",
    "multiprocessing",
    "urllib.request", "email", "ssl", "numpy.ma", "numpy.polynomial", "numpy.random", "numpy.testing",
    "concurrent.futures",
    "febkit.solver.contact", "febkit.solver.multiphasic", "febkit.solver.rigid.joints",
}  # fmt: skip


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("one") / "one.feb"
    text = load(BENCHMARK).MODEL
    path.write_text(text.replace('<var type="stress"/>', '<var type="stress"/><var type="element center of mass"/>'))
    return path


@pytest.mark.skipif(not jit.PLAIN, reason="kernels run as Python here")
@pytest.mark.parametrize("options", [["-silent"], []], ids=["silent", "piped"])
def test_a_warm_run_imports_nothing_heavy(model: Path, options: list[str]) -> None:
    program = PROGRAM.format(model=str(model), watched=UNWANTED, options=options)
    environment = {k: v for k, v in os.environ.items() if k not in ("NUMBA_DISABLE_JIT", "FEBKIT_NATIVE")}
    for _ in range(2):  # the first may compile
        done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, env=environment)
        assert done.returncode == 0, done.stderr
    imported, mkl = done.stdout.splitlines()[-2:]
    assert UNWANTED & set(imported.split()) == set()
    assert mkl == "False"
    assert model.with_suffix(".xplt").stat().st_size > 0


def test_the_same_result_without_the_extension(model: Path) -> None:
    """Kernels called by ctypes give the same plotfile."""
    plots = []
    for extension in ("", "0"):
        plot = model.with_name(f"plot{extension}.xplt")
        args = [sys.executable, "-m", "febkit.cli.main", "run", str(model), "-p", str(plot), "-silent"]
        subprocess.run(args, check=True, env={**os.environ, "FEBKIT_NATIVE": extension})
        plots.append(plot.read_bytes())
    assert plots[0] == plots[1]
