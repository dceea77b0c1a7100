"""What calls machine code: the types of arguments, and :class:`Calls`, the code of one kernel.

Machine code is plain C (:mod:`.compile`). Where the extension ``_call`` was built it is called from there, in a
fraction of a microsecond and an array's 10 ns; else (a source install without a C compiler) by ctypes, in about a
microsecond an array.
"""

from __future__ import annotations

import ctypes
import os
import platform
import struct
import sys
from functools import lru_cache
from typing import Any

import numpy as np

DTYPES = {np.dtype(c): c for c in ("f8", "f4", "i8", "i4", "?")}
SCALARS: dict[type, str] = {
    int: "int", np.int64: "int", float: "float", np.float64: "float", bool: "bool", np.bool_: "bool",
}  # fmt: skip
_NUMBERS = {"int": "q", "float": "d", "bool": "q"}  # how struct writes them
NOTHING, FLOAT, INT, BOOL = range(4)  # what a kernel may return; -1: there was no memory


def describe(args: tuple[Any, ...]) -> str | None:
    """The types of arguments as text ("int float f8.3Cw"), or None where one is for numba alone.

    Arrays: dtype, number of dimensions, order in memory (C, F, A for any), w where they may be written.
    """
    words = []
    for a in args:
        if type(a) is np.ndarray:
            f = a.flags
            kind = DTYPES.get(a.dtype)
            if kind is None or not f.aligned:
                return None
            order = "C" if f.c_contiguous else "F" if f.f_contiguous else "A"
            words.append(f"{kind}.{a.ndim}{order}{'w' if f.writeable else 'r'}")
        else:
            word = SCALARS.get(type(a))
            if word is None:
                return None
            words.append(word)
    return " ".join(words)


def takes(types: str, described: str) -> bool:
    """Does machine code for ``types`` take arguments that are described so?

    Code for any order takes each; code that only reads takes what may be written.
    """
    ours, theirs = types.split(), described.split()
    return len(ours) == len(theirs) and all(
        a == b or (len(a) == 6 and a[:4] == b[:4] and a[4] in ("A", b[4]) and a[5] in ("r", b[5]))
        for a, b in zip(ours, theirs)
    )


class _Calls:
    """As the extension's Calls, by ctypes."""

    def __init__(self) -> None:
        self._codes: dict[str, Any] = {}

    def add(self, address: int, types: str) -> None:
        """Machine code for arguments of these types."""
        self._codes[types] = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_char_p, ctypes.c_char_p)(address)

    def __call__(self, *args: Any) -> Any:
        described = describe(args)
        if described is None:
            return self.missed(*args)
        if described not in self._codes:
            serves = [code for types, code in tuple(self._codes.items()) if takes(types, described)]
            if not serves:
                return self.missed(*args)
            self._codes[described] = serves[0]
        form, slots = "=", []
        for a, word in zip(args, described.split()):
            if word in _NUMBERS:
                form += _NUMBERS[word]
                slots.append(float(a) if word == "float" else int(a))
            else:
                form += f"{1 + 2 * a.ndim}q"
                slots += [a.ctypes.data, *a.shape, *a.strides]
        result = ctypes.create_string_buffer(8)
        kind = self._codes[described](struct.pack(form, *slots), result)
        if kind < 0:
            raise MemoryError
        (value,) = struct.unpack("=d" if kind == FLOAT else "=q", result)
        return None if kind == NOTHING else bool(value) if kind == BOOL else value

    def missed(self, *args: Any) -> Any:
        """Called for arguments that no machine code here takes."""
        raise NotImplementedError


def _extension() -> Any:
    if os.environ.get("FEBKIT_NATIVE") == "0":
        return None
    try:
        from . import _call
    except ImportError:  # not built: there was no C compiler, or the folder is one of sources
        return None
    return _call


_built = _extension()
Calls: Any = _built.Calls if _built else _Calls


@lru_cache(maxsize=1)
def level() -> str:
    """The processors that machine code made here is for, by LLVM's name: the best level that this one has."""
    asked = os.environ.get("FEBKIT_LEVEL")
    if asked:
        return asked
    if platform.machine().lower() not in ("x86_64", "amd64"):
        return "apple-m1" if sys.platform == "darwin" else "generic"
    number = _built.level() if _built else _llvms_level()
    return f"x86-64-v{number}" if number > 1 else "x86-64"


def _llvms_level() -> int:
    import llvmlite.binding as llvm  # type: ignore[import-untyped]

    has = llvm.get_host_cpu_features()
    needs = ("popcnt", "ssse3", "sse4.2"), ("avx2", "bmi", "bmi2", "fma"), (
        "avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl",
    )  # fmt: skip
    number = 1
    for features in needs:
        if not all(has.get(f) for f in features):
            break
        number += 1
    return number
