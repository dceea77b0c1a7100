"""Machine code of kernels on disk, loaded without numba.

A kernel compiled for one list of argument types is one object file behind a METH_FASTCALL function,
``PyObject *kernel(PyObject *self, PyObject *const *args, Py_ssize_t n)``, made in :mod:`.compile`. It looks at its
arguments, hands back ``self`` (here :data:`MISS`) where they are of other types, and lets go of the GIL while it
works. Linking an object takes 0.2 ms, importing numba half a second; a call costs less than through numba.

The function reads CPython's and numpy's objects where they keep their numbers. Those places are compared with
what Python itself says before anything is loaded (:func:`available`); where that or anything else is off,
kernels run through numba.
"""

from __future__ import annotations

import ctypes
import hashlib
import os
import struct
import sys
import sysconfig
from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np

MISS = object()  # what a loaded kernel returns for arguments of other types
FASTCALL = 0x80  # METH_FASTCALL
DATA, NDIM, SHAPE, STRIDES, DTYPE, FLAGS = 16, 24, 32, 40, 56, 64  # bytes into an array object
TYPE, VALUE = 8, 16  # bytes into any object; into a float and numpy's scalars
ALIGNED, WRITEABLE, CONTIGUOUS = 0x100, 0x400, {"C": 1, "F": 2, "A": 0}
DTYPES = {np.dtype(c): c for c in ("f8", "f4", "i8", "i4", "?")}
SCALARS: dict[type, str] = {
    int: "int", np.int64: "int", float: "float", np.float64: "float", bool: "bool", np.bool_: "bool",
}  # fmt: skip

# addresses that objects refer to by name: types, singletons and array types of the running interpreter
_NAMED: dict[str, object] = {
    "ndarray": np.ndarray, "int": int, "int64": np.int64, "float": float, "float64": np.float64, "bool": bool,
    "bool_": np.bool_, "true": True, "none": None, **{f"dtype_{np.dtype(c).name}": d for d, c in DTYPES.items()},
}  # fmt: skip


def symbol(name: str) -> str:
    """The name under which an object finds an address of the interpreter."""
    return f"febkit_{name}"


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


@lru_cache(maxsize=1)
def available() -> bool:
    """May machine code be loaded here? CPython on 64-bit Linux whose objects are laid out as expected."""
    if os.environ.get("FEBKIT_NATIVE") == "0" or os.environ.get("NUMBA_DISABLE_JIT", "0") != "0":
        return False
    ordinary = sys.platform == "linux" and sys.implementation.name == "cpython" and sys.byteorder == "little"
    free_threads = bool(sysconfig.get_config_var("Py_GIL_DISABLED"))
    return ordinary and not free_threads and struct.calcsize("P") == 8 and _layout_holds()


def _layout_holds() -> bool:
    """Do arrays, floats and numpy's scalars keep their numbers where machine code reads them?"""
    if object.__basicsize__ != 16:
        return False
    a = np.zeros((3, 5, 7))[:, 1:4, ::2]
    at = id(a)
    numbers = 1.5 * len(a), np.float64(2.5), np.bool_(True)  # kept alive while their memory is looked at
    word, small = ctypes.c_int64.from_address, ctypes.c_int32.from_address
    shape, strides = (ctypes.c_int64 * 3).from_address(word(at + SHAPE).value), word(at + STRIDES).value
    flags = small(at + FLAGS).value
    return (
        word(at + TYPE).value == id(np.ndarray)
        and word(at + DATA).value == a.__array_interface__["data"][0]
        and small(at + NDIM).value == 3
        and tuple(shape) == a.shape
        and tuple((ctypes.c_int64 * 3).from_address(strides)) == a.strides
        and word(at + DTYPE).value == id(np.dtype("f8"))
        and flags & (ALIGNED | WRITEABLE | CONTIGUOUS["C"]) == ALIGNED | WRITEABLE
        and ctypes.c_double.from_address(id(numbers[0]) + VALUE).value == 4.5
        and ctypes.c_double.from_address(id(numbers[1]) + VALUE).value == 2.5
        and ctypes.c_uint8.from_address(id(numbers[2]) + VALUE).value == 1
    )


class _Definition(ctypes.Structure):
    """CPython's PyMethodDef."""

    _fields_ = [("name", ctypes.c_char_p), ("code", ctypes.c_void_p), ("flags", ctypes.c_int), ("doc", ctypes.c_char_p)]


class Linker:
    """Links objects into this process; LLVM does the work."""

    def __init__(self) -> None:
        import llvmlite.binding as llvm  # type: ignore[import-untyped]

        llvm.initialize_native_target()
        llvm.initialize_native_asmprinter()
        for name, value in _NAMED.items():
            llvm.add_symbol(symbol(name), id(value))
        self._llvm = llvm
        machine = llvm.Target.from_default_triple().create_target_machine()
        self._engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), machine)
        self._function = ctypes.pythonapi.PyCFunction_NewEx
        self._function.restype = ctypes.py_object
        self._function.argtypes = [ctypes.c_void_p, ctypes.py_object, ctypes.c_void_p]
        self._kept: list[_Definition] = []
    def link(self, code: bytes, name: str, undefined: list[str]) -> Callable[..., Any]:
        """The function ``name`` of an object. Raises LookupError where a symbol it needs is not in this process."""
        missing = [s for s in undefined if not self._llvm.address_of_symbol(s)]
        if missing:
            raise LookupError(f"not in this process: {', '.join(missing)}")
        self._engine.add_object_file(self._llvm.ObjectFileRef.from_data(code))
        self._engine.finalize_object()
        address = self._engine.get_function_address(name)
        if not address:
            raise LookupError(f"the object has no {name}")
        d = _Definition(name.encode(), address, FASTCALL, None)
        self._kept.append(d)
        return self._function(ctypes.addressof(d), MISS, None)


@lru_cache(maxsize=1)
def linker() -> Linker:
    return Linker()


@lru_cache(maxsize=1)
def processor() -> str:
    """What machine code made here is for."""
    import llvmlite.binding as llvm

    try:
        features = llvm.get_host_cpu_features().flatten()
    except RuntimeError:  # LLVM cannot tell on every architecture
        features = ""
    return f"{llvm.get_process_triple()} {llvm.get_host_cpu_name()} {features}"


def name_of(kernel: str, source: str, types: str) -> str:
    """The name of a kernel's file: a hash of sources, argument types, processor and numba's settings behind its own."""
    settings = sorted(f"{k}={v}" for k, v in os.environ.items() if k.startswith("NUMBA_") and k != "NUMBA_CACHE_DIR")
    text = "\n".join([source, types, processor(), *settings])
    return f"{kernel}_{hashlib.sha256(text.encode()).hexdigest()[:24]}"


def pack(code: bytes, undefined: list[str]) -> bytes:
    """An object and the symbols it needs, as one string of bytes."""
    names = "\n".join(undefined).encode()
    return struct.pack("<I", len(names)) + names + code


def unpack(stored: bytes) -> tuple[bytes, list[str]]:
    """The object and the symbols it needs."""
    (n,) = struct.unpack_from("<I", stored)
    return stored[4 + n :], stored[4 : 4 + n].decode().split()
