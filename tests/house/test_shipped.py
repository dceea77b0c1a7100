"""The machine code that comes with the wheel: what it is to hold, and when it is used."""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from febkit.solver import jit, library
from febkit.solver.calls import describe, level, takes
from febkit.solver.compile import compiled
from febkit.solver.jit import Kernel
from febkit.solver.kernels.tensors import inner
from helpers.files import load

shipped = load(Path(__file__).with_name("shipped.py"))
EXAMPLE = Path(__file__).parents[2] / "examples" / "unconfined_compression.feb"
pytestmark = pytest.mark.skipif(not jit.PLAIN, reason="kernels run as Python here")


def test_each_line_names_a_kernel_and_its_arguments() -> None:
    """Where a kernel was renamed or has other arguments: python tests/house/shipped.py MODEL.feb."""
    assert [line for line in shipped.lines() if not shipped.stands(line)] == []


def test_the_readmes_example_calls_nothing_else() -> None:
    """Where it does, its first run compiles: python tests/house/shipped.py examples/unconfined_compression.feb."""
    called = shipped.calls(EXAMPLE, seconds=600.0)  # it ends by itself
    assert len(called) > 10
    assert {c for c in called if not any(_serves(line, c) for line in shipped.lines())} == set()


def _serves(line: str, call: str) -> bool:
    (*of, types), (*wanted, own) = line.split(" ", 2), call.split(" ", 2)
    return of == wanted and takes(types, own)


@pytest.fixture()
def built(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A library as the wheel's build makes it, of one kernel."""
    if not (compiler := shutil.which("cc")):
        pytest.skip("there is no C compiler to link with")
    types = describe(ARGUMENTS)
    (code,) = compiled(inner.function, inner.options, types, inner.symbol(types), [level()])
    path = tmp_path / f"{level()}{library.SUFFIX}"
    (tmp_path / "inner.o").write_bytes(code)
    subprocess.run([compiler, "-shared", "-o", path, tmp_path / "inner.o", "-lm"], check=True)
    path.with_suffix(".sha256").write_text(hashlib.sha256(path.read_bytes()).hexdigest())
    monkeypatch.setattr(library, "FOLDER", tmp_path)
    monkeypatch.setattr(library, "table", lambda: {"kernels.tensors inner": [types]})
    monkeypatch.delenv("FEBKIT_NATIVE", raising=False)
    for name in [k for k in os.environ if k.startswith("NUMBA_")]:
        monkeypatch.delenv(name)
    library._library.cache_clear()
    yield path
    library._library.cache_clear()


ARGUMENTS = np.ones(6), np.arange(6.0)


def _compiles() -> bool:
    """Is anything compiled or taken from the cache for a first call?"""
    kernel = Kernel(inner.function, {"fastmath": False})
    made = []
    kernel._made = lambda types: made.append(types) or Kernel._made(kernel, types)
    assert kernel(*ARGUMENTS) == 27.0
    return bool(made)


def test_code_of_the_wheel_is_called(built: Path) -> None:
    assert not _compiles()


def test_a_damaged_library_is_not_loaded(built: Path) -> None:
    whole = built.read_bytes()
    built.write_bytes(whole[:-1] + bytes([whole[-1] ^ 1]))
    assert _compiles()


def test_code_of_other_sources_is_not_called(built: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(jit, "source_hash", lambda path: "of an edited file")
    assert _compiles()


def test_a_processor_takes_the_best_level_that_it_has(built: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    if level() not in library.LEVELS[1:]:
        pytest.skip("it has but one")
    below = library.LEVELS[library.LEVELS.index(level()) - 1]
    monkeypatch.setattr(library, "level", lambda: below)
    assert _compiles()  # what is there is for a better one
    built.rename(built.with_stem(below)), built.with_suffix(".sha256").rename(built.with_name(f"{below}.sha256"))
    monkeypatch.setattr(library, "level", level)
    library._library.cache_clear()
    assert not _compiles()


def test_names_of_machine_code_are_the_same_in_every_process() -> None:
    """Options may be sets, whose order changes from process to process: code that was shipped would not be found."""
    program = (
        "from febkit.solver.kernels.biphasic import internal_force as k; "
        "assert any(isinstance(v, set) and len(v) > 2 for v in k.options.values()); print(k.symbol('int'))"
    )
    names = {
        subprocess.run([sys.executable, "-c", program], env={**os.environ, "PYTHONHASHSEED": str(seed)},
                       capture_output=True, text=True, check=True).stdout
        for seed in (1, 2, 3)
    }  # fmt: skip
    assert len(names) == 1
