"""Objects linked into this process; LLVM does the work, without numba."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import llvmlite.binding as llvm  # type: ignore[import-untyped]

_kept: list[Any] = []  # what is linked is there as long as this


@lru_cache(maxsize=1)
def _linker() -> Any:
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    return llvm.create_lljit_compiler(suppress_errors=True)


def link(code: bytes, name: str) -> int:
    """The address of the function ``name`` of an object. Raises RuntimeError where it needs what is not here."""
    builder = llvm.JITLibraryBuilder().add_object_img(code).add_current_process().export_symbol(name)
    _kept.append(builder.link(_linker(), f"{name}.{len(_kept)}"))
    return int(_kept[-1][name])
