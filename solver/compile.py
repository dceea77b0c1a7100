"""Compile a kernel for given argument types into an object that :mod:`.native` loads without numba.

numba compiles the kernel; around it goes a function with CPython's calling convention that looks at its
arguments, reads arrays into numba's records and calls. Arrays made inside a kernel are counted by numba's
runtime, whose two entries are given here on malloc and free, as the object must stand alone.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from llvmlite import ir  # type: ignore[import-untyped]
from numba.core import cgutils, compiler, types
from numba.core.compiler_lock import global_compiler_lock
from numba.core.dispatcher import _FunctionCompiler  # type: ignore[attr-defined]
from numba.core.registry import cpu_target
from numba.np.arrayobj import populate_array
from numba.np.numpy_support import from_dtype

from . import native

I8, I32, I64, F64 = ir.IntType(8), ir.IntType(32), ir.IntType(64), ir.DoubleType()
OBJECT, VOID = I8.as_pointer(), ir.VoidType()
MEMINFO = 64  # bytes kept before the data of an array for numba's record of it (48 in numba 0.60 to 0.68)


class _Compiler(_FunctionCompiler):  # type: ignore[misc]
    """numba's compiler without wrappers of its own, stopping where ours is added."""

    def _customize_flags(self, flags: Any) -> Any:
        flags.no_cpython_wrapper = flags.no_cfunc_wrapper = flags.no_compile = True
        return flags


def numba_type(word: str) -> Any:
    """numba's type of an argument that :func:`.native.describe` calls ``word``."""
    scalar = {"int": types.int64, "float": types.float64, "bool": types.boolean}.get(word)
    if scalar is not None:
        return scalar
    dtype, rest = word.split(".")
    array: Any = types.Array
    return array(from_dtype(np.dtype(dtype)), int(rest[:-2]), rest[-2], readonly=rest[-1] == "r")


@global_compiler_lock
def compiled(fn: Callable[..., Any], options: dict[str, Any], described: str, name: str) -> tuple[bytes, list[str]]:
    """Object code of ``fn`` for the described arguments, its entry called ``name``, and its undefined symbols.

    Raises whatever numba raises, and TypeError where the kernel returns more than one number.
    """
    native.linker()  # numba links the object as well: what it refers to must be known
    words = described.split()
    args = tuple(numba_type(w) for w in words)
    options = {"nopython": True, "nogil": True, "error_model": "numpy", **options}
    made = _Compiler(fn, cpu_target, options, {}, compiler.Compiler).compile(args, None)
    library = made.library
    library.enable_object_caching()
    module = library.create_ir_module(f"febkit.{name}")
    _Entry(module, made, words, args).write(name)
    _runtime(module)
    library.add_ir_module(module)
    library.finalize()
    code = bytes(library._get_compiled_object())
    return code, undefined(code)


class _Entry:
    """The function that Python calls. ``words`` describe its arguments, ``args`` are numba's types of them."""

    def __init__(self, module: Any, made: Any, words: Sequence[str], args: Sequence[Any]) -> None:
        self.module, self.made, self.words, self.args = module, made, words, args
        self.context = made.target_context

    def write(self, name: str) -> None:
        fn = ir.Function(self.module, ir.FunctionType(OBJECT, [OBJECT, OBJECT.as_pointer(), I64]), name)
        self.b = ir.IRBuilder(fn.append_basic_block())
        self.me, argv, n = fn.args
        self._need(self.b.icmp_signed("==", n, ir.Constant(I64, len(self.words))))
        objects = [self.b.load(self.b.gep(argv, [ir.Constant(I64, k)])) for k in range(len(self.words))]
        for o, word, type_ in zip(objects, self.words, self.args):
            self._check(o, word, type_)
        values = [self._value(o, word, type_) for o, word, type_ in zip(objects, self.words, self.args)]
        if "int" in self.words:
            with cgutils.if_unlikely(self.b, cgutils.is_not_null(self.b, self._call(OBJECT, "PyErr_Occurred"))):
                self.b.ret(ir.Constant(OBJECT, None))
        self._work(values)

    def _work(self, values: list[Any]) -> None:
        b, d = self.b, self.made.fndesc
        thread = self._call(OBJECT, "PyEval_SaveThread")
        kernel = self.context.declare_function(self.module, d)
        status, out = self.context.call_conv.call_function(b, kernel, d.restype, d.argtypes, values)
        self._call(VOID, "PyEval_RestoreThread", thread)
        with cgutils.if_unlikely(b, status.is_error):  # kernels raise nothing themselves
            b.ret(self._call(OBJECT, "PyErr_NoMemory"))
        if d.restype == types.none:
            none = self._address("none")
            self._call(VOID, "Py_IncRef", none)
            b.ret(none)
        elif d.restype == types.float64:
            b.ret(self._call(OBJECT, "PyFloat_FromDouble", out))
        elif d.restype == types.boolean:
            b.ret(self._call(OBJECT, "PyBool_FromLong", b.zext(out, I64) if out.type != I64 else out))
        elif d.restype == types.int64:
            b.ret(self._call(OBJECT, "PyLong_FromLongLong", out))
        else:
            raise TypeError(f"a kernel that returns {d.restype} is for numba alone")

    # ---- arguments --------------------------------------------------------------------------------
    def _check(self, o: Any, word: str, type_: Any) -> None:
        b = self.b
        if word in ("int", "float", "bool"):
            wider = {"int": "int64", "float": "float64", "bool": "bool_"}[word]
            of = self._at(o, native.TYPE, OBJECT)
            self._need(b.or_(*(b.icmp_unsigned("==", of, self._address(t)) for t in (word, wider))))
            return
        self._same(self._at(o, native.TYPE, OBJECT), self._address("ndarray"))
        self._same(self._at(o, native.NDIM, I32), ir.Constant(I32, type_.ndim))
        self._same(self._at(o, native.DTYPE, OBJECT), self._address(f"dtype_{np.dtype(word.split('.')[0]).name}"))
        mask = native.ALIGNED | native.CONTIGUOUS[type_.layout] | (native.WRITEABLE if type_.mutable else 0)
        flags = b.and_(self._at(o, native.FLAGS, I32), ir.Constant(I32, mask))
        self._same(flags, ir.Constant(I32, mask))

    def _value(self, o: Any, word: str, type_: Any) -> Any:
        b = self.b
        if word == "int":
            return self._call(I64, "PyLong_AsLongLong", o)
        if word == "float":
            return self._at(o, native.VALUE, F64)
        if word == "bool":
            numpys = b.icmp_unsigned("==", self._at(o, native.TYPE, OBJECT), self._address("bool_"))
            stored = b.icmp_unsigned("!=", self._at(o, native.VALUE, I8), ir.Constant(I8, 0))
            truth = b.select(numpys, stored, b.icmp_unsigned("==", o, self._address("true")))
            return truth
        return self._array(o, type_)

    def _array(self, o: Any, type_: Any) -> Any:
        b, context = self.b, self.context
        array = context.make_array(type_)(context, b)
        size = context.get_abi_sizeof(context.get_data_type(type_.dtype))

        def numbers(offset: int) -> Any:
            first = self._at(o, offset, I64.as_pointer())
            found = [b.load(b.gep(first, [ir.Constant(I64, k)])) for k in range(type_.ndim)]
            return cgutils.pack_array(b, found, I64)

        populate_array(
            array, data=b.bitcast(self._at(o, native.DATA, OBJECT), array.data.type), shape=numbers(native.SHAPE),
            strides=numbers(native.STRIDES), itemsize=ir.Constant(I64, size), meminfo=None, parent=None,
        )  # fmt: skip
        return array._getvalue()

    # ---- words of the machine ---------------------------------------------------------------------
    def _same(self, a: Any, b: Any) -> None:
        self._need(self.b.icmp_unsigned("==", a, b))

    def _need(self, condition: Any) -> None:
        """Hand back ``self`` unless the condition holds."""
        with cgutils.if_unlikely(self.b, self.b.not_(condition)):
            self._call(VOID, "Py_IncRef", self.me)
            self.b.ret(self.me)

    def _at(self, o: Any, offset: int, type_: Any) -> Any:
        return self.b.load(self.b.bitcast(self.b.gep(o, [ir.Constant(I64, offset)]), type_.as_pointer()))

    def _address(self, name: str) -> Any:
        name = native.symbol(name)
        try:
            return self.module.get_global(name)
        except KeyError:
            return ir.GlobalVariable(self.module, I8, name)

    def _call(self, out: Any, name: str, *args: Any) -> Any:
        type_ = ir.FunctionType(out, [a.type for a in args])
        return self.b.call(cgutils.get_or_insert_function(self.module, type_, name), args)


def _runtime(module: Any) -> None:
    """numba's runtime as far as kernels need it: make an array's memory, and give it back.

    Record before the data (numba/core/runtime/nrtdynmod.py): count, destructor, its argument, data, size.
    """
    for safe in ("", "_safe"):
        _allocator(module, f"NRT_MemInfo_alloc{safe}", aligned=False)
        _allocator(module, f"NRT_MemInfo_alloc{safe}_aligned", aligned=True)
    for name, libc, type_ in (
        ("NRT_MemInfo_call_dtor", "free", ir.FunctionType(VOID, [OBJECT])),
        ("NRT_Free", "free", ir.FunctionType(VOID, [OBJECT])),
        ("NRT_Allocate", "malloc", ir.FunctionType(OBJECT, [I64])),
    ):
        fn, b = _define(module, name, type_)
        out = b.call(cgutils.get_or_insert_function(module, type_, libc), fn.args)
        b.ret_void() if type_.return_type == VOID else b.ret(out)


def _define(module: Any, name: str, type_: Any) -> tuple[Any, Any]:
    fn = cgutils.get_or_insert_function(module, type_, name)
    fn.linkage = "weak_odr"
    return fn, ir.IRBuilder(fn.append_basic_block())


def _allocator(module: Any, name: str, aligned: bool) -> None:
    """A function (size[, alignment]) that gives a record whose data lie behind it."""
    fn, b = _define(module, name, ir.FunctionType(OBJECT, [I64, I32] if aligned else [I64]))
    size, align = fn.args[0], b.zext(fn.args[1], I64) if aligned else ir.Constant(I64, 16)
    malloc = cgutils.get_or_insert_function(module, ir.FunctionType(OBJECT, [I64]), "malloc")
    record = b.call(malloc, [b.add(b.add(size, align), ir.Constant(I64, MEMINFO))])
    with cgutils.if_unlikely(b, cgutils.is_null(b, record)):
        b.ret(record)
    first = b.add(b.ptrtoint(record, I64), b.add(ir.Constant(I64, MEMINFO - 1), align))
    data, zero = b.and_(first, b.neg(align)), ir.Constant(I64, 0)
    for k, value in enumerate([ir.Constant(I64, 1), zero, zero, data, size, zero]):
        b.store(value, b.bitcast(b.gep(record, [ir.Constant(I64, 8 * k)]), I64.as_pointer()))
    b.ret(record)


def undefined(code: bytes) -> list[str]:
    """Names of the symbols that a relocatable ELF64 object leaves to others (System V ABI, symbol table)."""
    if code[:6] != b"\x7fELF\x02\x01":
        raise TypeError("not a little-endian ELF64 object")
    (start,) = struct.unpack_from("<Q", code, 0x28)
    size, count = struct.unpack_from("<HH", code, 0x3A)
    sections = [struct.unpack_from("<IIQQQQIIQQ", code, start + k * size) for k in range(count)]
    names = []
    for _, kind, _, _, offset, length, link, _, _, _ in sections:
        if kind != 2:  # SHT_SYMTAB
            continue
        strings = sections[link][4]
        for q in range(offset, offset + length, 24):
            name, _, _, section = struct.unpack_from("<IBBH", code, q)
            if name and section == 0:
                at = strings + name
                names.append(code[at : code.index(b"\0", at)].decode())
    return sorted(names)
