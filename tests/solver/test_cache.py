"""Machine code on disk: whole or made again, taken from its owner alone, and shared by processes."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from febkit.solver import cache, compilation, jit
from febkit.solver.jit import Kernel
from helpers import damage


def _mean(a):
    return a.sum() / a.size


@pytest.fixture()
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("FEBKIT_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(cache, "_said", set())
    return tmp_path / "cache"


def _kept(folder: Path) -> list[Path]:
    return sorted(folder.rglob("*.o"))


@pytest.mark.parametrize("way", damage.WAYS.values(), ids=damage.WAYS)
def test_a_damaged_file_is_made_again(folder: Path, way: Callable[[bytes], bytes]) -> None:
    assert Kernel(_mean, {})(np.ones(3)) == 1.0
    (path,) = _kept(folder)
    path.write_bytes(way(path.read_bytes()))
    before = compilation.count()
    assert Kernel(_mean, {})(np.full(3, 2.0)) == 2.0
    assert compilation.count() == before + 1
    assert cache.read(path) is not None  # mended
    assert Kernel(_mean, {})(np.full(3, 3.0)) == 3.0
    assert compilation.count() == before + 1  # and used


def test_a_whole_file_under_another_name_is_not_taken(folder: Path) -> None:
    cache.write(folder / "one.o", b"machine code")
    (folder / "two.o").write_bytes((folder / "one.o").read_bytes())
    assert cache.read(folder / "one.o") == b"machine code"
    assert cache.read(folder / "two.o") is None


@pytest.mark.skipif(sys.platform == "win32", reason="Windows keeps a user's folders for that user")
@pytest.mark.parametrize("whose", ["others can write to it", "it belongs to another user"])
def test_code_in_a_folder_of_somebody_else_is_not_run(
    folder: Path, monkeypatch: pytest.MonkeyPatch, whose: str
) -> None:
    """A sound file, put there by whoever can write there, would do what its author wants."""
    Kernel(_mean, {})(np.ones(3))
    (path,) = _kept(folder)
    if whose.startswith("others"):
        path.parent.chmod(0o777)
    else:
        monkeypatch.setattr(os, "geteuid", lambda: path.stat().st_uid + 1)
    before = compilation.count()
    with pytest.warns(RuntimeWarning, match=whose) as said:
        for _ in range(3):
            assert Kernel(_mean, {})(np.full(3, 2.0)) == 2.0
    assert len(said) == 1 and compilation.count() == before + 3


@pytest.mark.skipif(sys.platform == "win32", reason="Windows keeps a user's folders for that user")
def test_a_file_that_others_can_write_is_made_again(folder: Path) -> None:
    cache.write(folder / "k.o", b"code")
    (folder / "k.o").chmod(0o666)
    assert cache.read(folder / "k.o") is None
    cache.write(folder / "k.o", b"code")
    assert cache.read(folder / "k.o") == b"code" and (folder / "k.o").stat().st_mode & 0o777 == 0o600


def test_without_a_home(monkeypatch: pytest.MonkeyPatch) -> None:
    def nobody() -> Path:
        raise RuntimeError("Could not determine home directory.")

    for name in ("FEBKIT_CACHE", "XDG_CACHE_HOME", "LOCALAPPDATA"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(Path, "home", nobody)
    monkeypatch.setattr(cache, "_said", set())
    with pytest.warns(RuntimeWarning, match="no home"):
        assert Kernel(_mean, {})(np.ones(4)) == 1.0


def test_processes_that_start_at_once_compile_once(tmp_path: Path) -> None:
    program = (
        "import numpy as np\n"
        "from febkit.solver import compilation\n"
        "from febkit.solver.kernels.tensors import inner\n"
        "print(inner(np.ones(6), np.arange(6.0)), compilation.count())"
    )
    env = {**os.environ, "FEBKIT_CACHE": str(tmp_path), "FEBKIT_NATIVE": ""}
    many = [
        subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True, env=env) for _ in range(4)
    ]
    said = [p.communicate(timeout=120)[0].split() for p in many]
    assert [s[0] for s in said] == ["27.0"] * 4
    if jit.PLAIN:
        assert sum(int(s[1]) for s in said) == 1
    assert [p for p in tmp_path.rglob("*") if p.suffix not in ("", ".o")] == []


def test_what_a_killed_process_left_behind_stops_nobody(folder: Path) -> None:
    (folder / "k.lock").parent.mkdir(parents=True)
    (folder / "k.lock").touch()
    with cache.turn(folder / "k.o"):
        cache.write(folder / "k.o", b"code")
    assert cache.read(folder / "k.o") == b"code"
    assert [p.name for p in folder.iterdir()] == ["k.o"]


def test_the_clock_stands_still_while_kernels_are_compiled() -> None:
    import time

    start, made = compilation.now(), compilation.count()
    with compilation.compiling(_mean), compilation.compiling(_mean):
        time.sleep(0.2)
        assert compilation.now() - start < 0.1
    time.sleep(0.02)
    assert 0.02 <= compilation.now() - start < 0.15
    assert compilation.count() == made + 1  # the second on behalf of the first
