"""A kernel compiled for given argument types into an object: a plain C function without Python in it.

``int32_t name(const int64_t *slots, int64_t *result)``. ``slots`` holds, argument after argument, a number (a double as
its bits) or an array's address, extents and strides in bytes. The number that the kernel returns goes to ``result``;
its kind (``NOTHING`` ... of :mod:`.calls`) is what the function returns, -1 where there was no memory. numba compiles
the kernel ahead of time; around it goes what reads the slots into numba's records. Arrays made inside a kernel are
counted by numba's runtime, whose entries are given here on malloc and free, as the object must stand alone.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from llvmlite import ir  # type: ignore[import-untyped]
from numba.core import cgutils, compiler, types
from numba.core.codegen import AOTCPUCodegen
from numba.core.compiler_lock import global_compiler_lock
from numba.core.registry import cpu_target
from numba.np.arrayobj import populate_array
from numba.np.numpy_support import from_dtype

from .calls import BOOL, FLOAT, INT, NOTHING

I8, I32, I64, F64 = ir.IntType(8), ir.IntType(32), ir.IntType(64), ir.DoubleType()
POINTER, VOID = I8.as_pointer(), ir.VoidType()
MEMINFO = 64  # bytes kept before the data of an array for numba's record of it (48 in numba 0.60 to 0.68)
RESULTS = {types.none: NOTHING, types.float64: FLOAT, types.int64: INT, types.boolean: BOOL}
OPTIONS = {
    "nopython": True, "nogil": True, "error_model": "numpy", "no_cpython_wrapper": True, "no_cfunc_wrapper": True,
}  # fmt: skip
ELSEWHERE = ("numba_", "NRT_", "Py", "_Py")  # symbols that only a process with numba has


def numba_type(word: str) -> Any:
    """numba's type of an argument that :func:`.calls.describe` calls ``word``."""
    scalar = {"int": types.int64, "float": types.float64, "bool": types.boolean}.get(word)
    if scalar is not None:
        return scalar
    dtype, rest = word.split(".")
    array: Any = types.Array
    return array(from_dtype(np.dtype(dtype)), int(rest[:-2]), rest[-2], readonly=rest[-1] == "r")


@global_compiler_lock
def compiled(
    fn: Callable[..., Any], options: dict[str, Any], described: str, name: str, levels: Sequence[str]
) -> list[bytes]:
    """Object code of ``fn`` for the described arguments, its entry called ``name``, for each level of processors.

    Raises whatever numba raises, and TypeError where the kernel returns more than one number.
    """
    args = tuple(numba_type(w) for w in described.split())
    flags = compiler.Flags()
    cpu_target.options.parse_as_flags(flags, {**OPTIONS, **options})
    flags.nrt = flags.no_compile = True
    context = cpu_target.target_context.with_aot_codegen(name, cpu_name=levels[0])
    made = compiler.compile_extra(cpu_target.typing_context, context, fn, args, None, flags, {})
    module = made.library.create_ir_module(f"febkit.{name}")
    _entry(module, made, args, name)
    made.library.add_ir_module(module)
    return [_object(made.library, name, level) for level in levels]


def _object(made: Any, name: str, level: str) -> bytes:
    """Object code of a library that numba has not optimised yet."""
    library = AOTCPUCodegen(name, level).create_library(name)
    library.add_llvm_module(made._final_module.clone())
    for callee in (*made._linking_libraries, _runtime(library.codegen)):  # last: of it, what the others need is linked
        library.add_linking_library(callee)
    for f in library.get_defined_functions():
        if f.name != name:
            f.linkage = "linkonce_odr"  # dropped where it is a part of the entry
    library.finalize()
    for f in library._final_module.functions:
        if f.is_declaration and f.name.startswith(ELSEWHERE):
            raise TypeError(f"it needs {f.name}, which only numba has")
    for f in _defined(library):
        if f.name != name:
            f.linkage = "internal"  # the entry alone is seen from outside
    return bytes(library.emit_native_object())


def _defined(library: Any) -> list[Any]:
    """Functions and global data of a numba library that are defined in it."""
    module = library._final_module
    return [v for v in (*module.functions, *module.global_variables) if not v.is_declaration]


def _entry(module: Any, made: Any, args: tuple[Any, ...], name: str) -> None:
    """The function that reads the slots, calls the kernel and stores its number."""
    context, d = made.target_context, made.fndesc
    fn = ir.Function(module, ir.FunctionType(I32, [I64.as_pointer(), I64.as_pointer()]), name)
    b = ir.IRBuilder(fn.append_basic_block())
    if d.restype not in RESULTS:
        raise TypeError(f"a kernel that returns {d.restype} is for numba alone")
    at, values = 0, []
    for t in args:
        words = [b.load(b.gep(fn.args[0], [ir.Constant(I64, at + k)])) for k in range(_size(t))]
        values.append(_array(context, b, t, words) if isinstance(t, types.Array) else _number(b, t, words[0]))
        at += len(words)
    status, out = context.call_conv.call_function(
        b, context.declare_function(module, d), d.restype, d.argtypes, values
    )
    with cgutils.if_unlikely(b, status.is_error):  # kernels raise nothing themselves
        b.ret(ir.Constant(I32, -1))
    if d.restype != types.none:
        word = b.bitcast(out, I64) if out.type == F64 else b.zext(out, I64) if out.type != I64 else out
        b.store(word, fn.args[1])
    b.ret(ir.Constant(I32, RESULTS[d.restype]))


def _size(t: Any) -> int:
    """Slots that an argument takes."""
    return 1 + 2 * t.ndim if isinstance(t, types.Array) else 1


def _number(b: Any, t: Any, word: Any) -> Any:
    if t == types.float64:
        return b.bitcast(word, F64)
    return b.icmp_signed("!=", word, ir.Constant(I64, 0)) if t == types.boolean else word


def _array(context: Any, b: Any, t: Any, words: list[Any]) -> Any:
    array = context.make_array(t)(context, b)
    populate_array(
        array, data=b.inttoptr(words[0], array.data.type),
        shape=cgutils.pack_array(b, words[1 : 1 + t.ndim], I64),
        strides=cgutils.pack_array(b, words[1 + t.ndim :], I64),
        itemsize=ir.Constant(I64, context.get_abi_sizeof(context.get_data_type(t.dtype))), meminfo=None, parent=None,
    )  # fmt: skip
    return array._getvalue()


def _runtime(codegen: Any) -> Any:
    """numba's runtime as far as kernels need it: make an array's memory, and give it back.

    Record before the data (numba/core/runtime/nrtdynmod.py): count, destructor, its argument, data, size.
    """
    library = codegen.create_library("febkit.runtime")
    module = library.create_ir_module("febkit.runtime")
    for safe in ("", "_safe"):
        _allocator(module, f"NRT_MemInfo_alloc{safe}", aligned=False)
        _allocator(module, f"NRT_MemInfo_alloc{safe}_aligned", aligned=True)
    for name, libc, type_ in (
        ("NRT_MemInfo_call_dtor", "free", ir.FunctionType(VOID, [POINTER])),
        ("NRT_Free", "free", ir.FunctionType(VOID, [POINTER])),
        ("NRT_Allocate", "malloc", ir.FunctionType(POINTER, [I64])),
    ):
        fn, b = _define(module, name, type_)
        out = b.call(cgutils.get_or_insert_function(module, type_, libc), fn.args)
        b.ret_void() if type_.return_type == VOID else b.ret(out)
    library.add_ir_module(module)
    return library


def _define(module: Any, name: str, type_: Any) -> tuple[Any, Any]:
    fn = cgutils.get_or_insert_function(module, type_, name)
    return fn, ir.IRBuilder(fn.append_basic_block())


def _allocator(module: Any, name: str, aligned: bool) -> None:
    """A function (size[, alignment]) that gives a record whose data lie behind it."""
    fn, b = _define(module, name, ir.FunctionType(POINTER, [I64, I32] if aligned else [I64]))
    size, align = fn.args[0], b.zext(fn.args[1], I64) if aligned else ir.Constant(I64, 16)
    malloc = cgutils.get_or_insert_function(module, ir.FunctionType(POINTER, [I64]), "malloc")
    record = b.call(malloc, [b.add(b.add(size, align), ir.Constant(I64, MEMINFO))])
    with cgutils.if_unlikely(b, cgutils.is_null(b, record)):
        b.ret(record)
    first = b.add(b.ptrtoint(record, I64), b.add(ir.Constant(I64, MEMINFO - 1), align))
    data, zero = b.and_(first, b.neg(align)), ir.Constant(I64, 0)
    for k, value in enumerate([ir.Constant(I64, 1), zero, zero, data, size, zero]):
        b.store(value, b.bitcast(b.gep(record, [ir.Constant(I64, 8 * k)]), I64.as_pointer()))
    b.ret(record)
