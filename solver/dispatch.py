"""numba's dispatcher of a kernel, with its machine code in :mod:`.cache` and its compiling told.

numba's own files are pickles and carry no checksum: damaged ones crash the process, and they are taken from
whoever put them there. Ours hold the same pickles, one file for each list of argument types.
"""

from __future__ import annotations

import pickle
from collections.abc import Callable
from contextlib import AbstractContextManager, suppress
from pathlib import Path
from typing import Any

import numba
from numba.core import compiler, event
from numba.core.caching import NullCache
from numba.core.serialize import dumps

from . import cache, compilation
from .native import name_of


def dispatcher(fn: Callable[..., Any], options: dict[str, Any], folder: Path | None, source: str | None) -> Any:
    """numba's dispatcher of ``fn``. ``source`` identifies it in ``folder``; without both nothing is kept."""
    made = numba.njit(nogil=True, error_model="numpy", **options)(fn)
    if folder is not None and source is not None and made is not fn:  # not where NUMBA_DISABLE_JIT is set
        made._cache = _Kept(folder, fn.__name__, source)
    return made


class _Kept(NullCache):  # type: ignore[misc]
    """What a dispatcher asks for machine code before it compiles, and gives it to afterwards."""

    def __init__(self, folder: Path, kernel: str, source: str) -> None:
        self.folder, self.kernel, self.source = folder, kernel, f"{folder.name} {source}"

    @property
    def cache_path(self) -> str:
        return str(self.folder)

    def _path(self, signature: Any) -> Path:
        return self.folder / f"{name_of(self.kernel, self.source, str(signature))}.numba"

    def load_overload(self, signature: Any, target: Any) -> Any:
        body = cache.read(self._path(signature))
        if body is None:
            cache.ready(self.folder)  # whether what is compiled now will be kept is said before
            return None
        target.refresh()
        try:
            return compiler.CompileResult._rebuild(target, *pickle.loads(body))
        except Exception:  # made by a numba or from a module that is not here: compile it anew
            return None

    def save_overload(self, signature: Any, result: Any) -> None:
        if result.lifted or result.library.has_dynamic_globals:
            return
        with suppress(pickle.PicklingError, TypeError):  # it encloses what has no place on disk
            cache.write(self._path(signature), dumps(result._reduce()))


class _Told(event.Listener):  # type: ignore[misc]
    """numba says when it compiles: not when it finds machine code on disk. Its compiler serves one thread at a time."""

    def __init__(self) -> None:
        self.inside: list[AbstractContextManager[None]] = []

    def on_start(self, said: Any) -> None:
        made = compilation.compiling(said.data["dispatcher"].py_func)
        made.__enter__()
        self.inside.append(made)

    def on_end(self, said: Any) -> None:
        if self.inside:
            self.inside.pop().__exit__(None, None, None)


event.register("numba:compile", _Told())
