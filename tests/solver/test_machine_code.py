"""Machine code of kernels: same answers, called with what it is for alone, and numba where it cannot serve."""

from __future__ import annotations

import struct
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from febkit.solver import cache as store
from febkit.solver import calls, jit
from febkit.solver.calls import Calls, describe, takes
from febkit.solver.jit import Kernel
from febkit.solver.kernels import pattern, solid

pytestmark = pytest.mark.skipif(not jit.PLAIN, reason="kernels run as Python here")
MISSED = object()


def _sum_rows(a, out, scale, shift, twice):
    n = a.shape[0]
    scratch = np.empty(n)
    for i in range(n):
        scratch[i] = 0.0
        for j in range(a.shape[1]):
            scratch[i] += a[i, j]
    for i in range(n):
        out[i] = scratch[i] * scale + shift
        if twice:
            out[i] *= 2.0
    return n


def _mean(a):
    return a.sum() / a.size


def _pair(a):
    return a[0], a[1]


@pytest.fixture()
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("FEBKIT_CACHE", str(tmp_path))
    monkeypatch.delenv("FEBKIT_NATIVE", raising=False)
    return tmp_path


def _calls(kind: type, kernel: Kernel) -> Calls:
    """The kernel's machine code alone, called by the extension or by ctypes."""
    code = type("Code", (kind,), {"missed": lambda *_: MISSED})()
    for types in kernel.found:
        code.add(*kernel._made(types))
    return code


BOTH = pytest.mark.parametrize("kind", {Calls, calls._Calls}, ids=lambda c: c.__module__)


def _objects(cache: Path) -> list[Path]:
    return sorted(cache.rglob("*.o"))


def test_same_answer_as_the_function(cache: Path) -> None:
    kernel, a = Kernel(_sum_rows, {}), np.random.default_rng(0).normal(size=(7, 5))
    for scale, shift, twice in ((2.0, 3, True), (np.float64(0.5), np.int64(-4), np.bool_(False))):
        got, expected = np.zeros(7), np.zeros(7)
        assert kernel(a, got, scale, shift, twice) == _sum_rows(a, expected, scale, shift, twice)
        np.testing.assert_allclose(got, expected, rtol=1e-15)
    assert len(_objects(cache)) == 1  # numpy's scalars are served by the code for Python's
    assert "compiled" not in vars(kernel)  # numba's dispatcher was not needed


@pytest.mark.parametrize("view", [
    lambda a: a[::2], lambda a: a.T, lambda a: a[:, 1:3], lambda a: np.asfortranarray(a), lambda a: a[:1],
    lambda a: a.astype("f4"), lambda a: a.astype("i4"),
])  # fmt: skip
def test_arrays_of_any_shape_in_memory(cache: Path, view) -> None:
    kernel, a = Kernel(_mean, {}), np.random.default_rng(1).normal(size=(6, 4)) * 9
    for x in (a, view(a), a):
        assert kernel(x) == pytest.approx(float(np.mean(x)), rel=1e-6)


@BOTH
def test_read_only_arrays_have_code_of_their_own(cache: Path, kind: type) -> None:
    kernel, a = Kernel(_mean, {}), np.ones((3, 3))
    a.flags.writeable = False
    assert kernel(a) == 1.0
    assert describe((a,)) == "f8.2Cr"
    code = _calls(kind, kernel)
    assert code(np.ones((3, 3))) == 1.0  # code that only reads takes what may be written
    assert code(np.ones(3)) is MISSED


def test_what_code_for_given_types_takes() -> None:
    assert takes("int f8.2Aw f8.1Cr", "int f8.2Cw f8.1Cw")
    for types in ("f8.2Cw f8.1Cw", "int f8.2Fw f8.1Cw", "int f8.2Aw f8.1Aw x", "float f8.2Cw f8.1Cr",
                  "int i8.2Cw f8.1Cr", "int f8.1Cw f8.1Cr"):  # fmt: skip
        assert not takes(types, "int f8.2Cw f8.1Cr"), types


@BOTH
def test_code_looks_at_its_arguments(kind: type) -> None:
    X, conn = np.zeros((4, 3)), np.array([[0, 1, 2, 3]], np.int32)
    args = (0, 1, X, conn, np.zeros((1, 4, 3)), np.zeros((1, 1, 3, 3)), np.zeros((1, 1, 3, 3)), np.zeros((1, 1)))
    kernel = Kernel(solid.kinematics.function, {})
    kernel(*args)
    code = _calls(kind, kernel)
    assert code(*args) == -1 and len(kernel.found) == 1
    for k, other in ((0, 0.0), (0, True), (0, None), (2, X[:, ::2]), (2, X[0]), (2, X.astype("f4")), (2, [1.0]),
                     (3, conn.astype("i8")), (3, conn.astype(">i4")), (7, np.zeros((1, 1)).view(np.matrix))):
        changed = list(args)
        changed[k] = other
        assert code(*changed) is MISSED
    assert code(*args[:-1]) is MISSED and code() is MISSED
    with pytest.raises((OverflowError, struct.error)):
        code(2**70, *args[1:])
    with pytest.raises(TypeError):
        code(*args, more=1)


@BOTH
def test_references_are_counted(cache: Path, kind: type) -> None:
    kernel, a, out = Kernel(_sum_rows, {}), np.ones((3, 2)), np.zeros(3)
    kernel(a, out, 1.0, 0, False)
    code = _calls(kind, kernel)
    before = [sys.getrefcount(x) for x in (a, out, MISSED, code)]
    for _ in range(1000):
        code(a, out, 1.0, 0, False)
        code(a, out, 1, 0, False)
    after = [sys.getrefcount(x) for x in (a, out, MISSED, code)]
    assert max(abs(m - n) for m, n in zip(after, before)) < 100, "a reference a call would be a thousand"


def test_a_second_process_needs_no_numba(cache: Path) -> None:
    program = (
        "import sys, numpy as np\n"
        "from febkit.solver.kernels.tensors import inner\n"
        "print(inner(np.ones(6), np.arange(6.0)), 'numba' in sys.modules)"
    )
    said = [
        subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout.split()
        for _ in range(2)
    ]
    assert said == [["27.0", "True"], ["27.0", "False"]]


def test_damaged_files_are_made_again(cache: Path) -> None:
    Kernel(_mean, {})(np.ones(3))
    (path,) = _objects(cache)
    whole = path.read_bytes()
    for damaged in (b"", whole[:40], whole[:-1], whole[:200] + bytes([whole[200] ^ 1]) + whole[201:]):
        path.write_bytes(damaged)
        assert store.read(path) is None
        assert Kernel(_mean, {})(np.full(3, 2.0)) == 2.0
        assert store.read(path) is not None


def test_code_that_needs_what_is_not_here_is_left_to_numba(cache: Path) -> None:
    args = np.ones((2, 3)), np.zeros(2), 1.0, 0, False
    Kernel(_sum_rows, {})(*args)
    (path,) = _objects(cache)
    code = store.read(path)
    store.write(path, code.replace(b"malloc", b"nobody"))
    again = Kernel(_sum_rows, {})
    assert again(*args) == 2
    assert list(again.found.values()) == [False]


def test_results_that_are_no_number_are_left_to_numba(cache: Path) -> None:
    kernel = Kernel(_pair, {})
    assert kernel(np.array([1.0, 2.0])) == (1.0, 2.0)
    assert list(kernel.found.values()) == [False]


def test_arguments_that_numba_knows_alone(cache: Path) -> None:
    kernel = Kernel(_pair, {})
    assert kernel((3, 4)) == (3, 4)
    assert describe(((3, 4),)) is None and describe((np.int32(1),)) is None and describe((None,)) is None


@pytest.mark.parametrize("n", [0, 1, 2, 3, 10, 100, 1000])
def test_sort_in_place(n: int) -> None:
    a = np.random.default_rng(n).integers(-50, 50, n).astype(np.int32)
    b = np.append(a, np.int32(7))
    pattern._sort(b, n)
    np.testing.assert_array_equal(b, np.append(np.sort(a), 7))


def test_kernels_of_one_name_that_enclose_different_numbers(cache: Path) -> None:
    def scaled(factor, inner):
        def scale(a):
            return inner(a) * factor

        return Kernel(scale, {})

    mean = Kernel(_mean, {})
    assert [scaled(f, mean)(np.ones(3)) for f in (2.0, 3.0, 2.0)] == [2.0, 3.0, 2.0]
    assert len(_objects(cache)) == 2


def test_kernels_that_enclose_what_has_no_name_are_left_to_numba(cache: Path) -> None:
    table = (1.0, 2.0)

    def first(a):
        return a[0] * table[1]

    kernel = Kernel(first, {})
    assert kernel(np.array([4.0])) == 8.0
    assert list(kernel.found.values()) == [False]


def test_eigenvectors_have_code_of_their_own(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whole-array copies send a kernel through numba's dispatcher, and a solve through numba's import."""
    from febkit.solver.kernels.ordered_spectra import ordered_spectra

    monkeypatch.setenv("FEBKIT_NATIVE", "1")
    A, w, V = np.diag([3.0, 1.0, 2.0])[None].copy(), np.empty((1, 3)), np.empty((1, 3, 3))
    Kernel(ordered_spectra.function, {})(A, w, V)
    assert w.tolist() == [[1.0, 2.0, 3.0]]
