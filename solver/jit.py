"""The one `kernel` decorator: a function that runs as machine code, found or made when it is first called.

Machine code is a plain C function for a list of argument types (:mod:`.compile`), called by :mod:`.calls`. Its name
holds a hash of the sources it is made of (:mod:`.sources`). It is looked for in the library that comes with the wheel
(:mod:`.library`), then in the user's cache (:mod:`.cache`); only what is in neither is compiled, by numba, which is
imported for nothing else. What plain C cannot hold (tuples as arguments or results) runs through numba's dispatcher.
"""

from __future__ import annotations

import hashlib
import os
import threading
from collections.abc import Callable
from contextlib import nullcontext
from functools import cached_property, lru_cache, update_wrapper
from importlib.util import find_spec
from pathlib import Path
from typing import Any, TypeVar

from . import cache, library
from .calls import Calls, describe, level, takes
from .compilation import compiling, paused
from .sources import source_hash

_FINDING = threading.RLock()  # one thread at a time loads or makes machine code
PLAIN = os.environ.get("NUMBA_DISABLE_JIT", "0") == "0"  # else kernels run as Python
F = TypeVar("F", bound=Callable[..., Any])


class Kernel(Calls):  # type: ignore[misc]
    """A function that becomes machine code when it is first called, from Python or from another kernel."""

    def __init__(self, function: Callable[..., Any], options: dict[str, Any]) -> None:
        super().__init__()
        self.function, self.options = function, options
        self.found: dict[str, bool] = {}  # lists of argument types met: is there plain machine code for them?
        update_wrapper(self, function)

    @cached_property
    def compiled(self) -> Any:
        """numba's dispatcher."""
        import numba

        return numba.njit(nogil=True, error_model="numpy", **self.options)(self.function)

    @property
    def _numba_type_(self) -> Any:
        """What numba asks a global of a kernel for: kernels call one another as dispatchers."""
        return self.compiled._numba_type_

    @property
    def source(self) -> str | None:
        """What tells a kernel from all others: sources, options, name, and the numbers and kernels it encloses.

        None where it encloses what has no name on disk.
        """
        fn = self.function
        enclosed = [c.cell_contents for c in fn.__closure__ or ()]
        if not all(isinstance(c, (int, float, str, Kernel)) for c in enclosed):
            return None
        words = (c.__qualname__ if isinstance(c, Kernel) else repr(c) for c in enclosed)
        options = {k: sorted(v) if isinstance(v, set) else v for k, v in self.options.items()}  # sets have no order
        return " ".join([source_hash(fn.__code__.co_filename), str(options), fn.__qualname__, *words])

    def symbol(self, types: str) -> str:
        """The name of the machine code for these types. Raises LookupError where it has none."""
        if self.source is None:
            raise LookupError("it encloses what has no name")
        digest = hashlib.sha256(f"{self.source} ({types})".encode()).hexdigest()
        return f"{self.__name__}_{digest[:24]}"

    def missed(self, *args: Any) -> Any:
        """The first call with arguments of these types: find the code for them, then call it."""
        types = describe(args) if PLAIN else None
        if types is None:
            return self.compiled(*args)
        with _FINDING:  # the first caller finds the code, the others wait for it
            if types not in self.found:
                self.found[types] = self._find(types)
        return self(*args) if self.found[types] else self.compiled(*args)

    def _find(self, types: str) -> bool:
        """Take machine code for the described arguments from disk, or make it; False where numba must do."""
        try:
            self.add(*(self._shipped(types) or self._made(types)))
            return True
        except Exception as e:  # numba's dispatcher runs it, or says what is wrong with it
            if os.environ.get("FEBKIT_NATIVE") == "1":
                raise RuntimeError(f"no machine code of its own for {self.__name__}({types}): {e}") from e
            return False

    def _shipped(self, types: str) -> tuple[int, str] | None:
        """The address of machine code that came with the wheel and takes these types, and its own types."""
        module = self.__module__.removeprefix("febkit.solver.")
        fitting = (t for t in library.listed(f"{module} {self.__name__}") if takes(t, types))
        for own in sorted(fitting, key=lambda t: t != types):
            address = library.address(self.symbol(own))
            if address:
                return address, own
        return None

    def _made(self, types: str) -> tuple[int, str]:
        """The address of machine code from the user's cache, made by this process or by one that was quicker."""
        from .linker import link

        name, kept = self.symbol(types), folder()
        path = kept / f"{name}.o" if kept else None
        code = cache.read(path) if path else None
        if code is None:
            with paused(), cache.turn(path) if path else nullcontext():
                code = cache.read(path) if path else None
                if code is None:
                    with compiling(self.function):
                        from .compile import compiled

                        (code,) = compiled(self.function, self.options, types, name, [level()])
                    if path:
                        cache.write(path, code)
        return link(code, name), types


def folder() -> Path | None:
    """Where this numba's machine code for this processor is kept, under the settings it runs with."""
    root = cache.root()
    if root is None:
        cache.unkept()
        return None
    text = "\n".join([_numba_version(), *library.settings()])
    return root / f"{level()}-{hashlib.sha256(text.encode()).hexdigest()[:16]}"


@lru_cache(maxsize=1)
def _numba_version() -> str:
    """What identifies the numba installed, without importing it."""
    spec = find_spec("numba")
    if spec is None or spec.origin is None:
        raise ModuleNotFoundError("numba is not installed")
    return (Path(spec.origin).parent / "_version.py").read_text()


def kernel(fn: F | None = None, **options: Any) -> Any:
    """Machine code as by ``numba.njit(nogil=True)``, found or made at the first call.

    Kernels release the GIL: the solver runs them on slices of the elements from a pool of threads.
    Kernels take arrays and numbers only, and return at most one number.
    """
    if fn is None:
        return lambda f: kernel(f, **options)
    # said to each: else a kernel takes the mode of the first that calls it, and its rounding depends on which that was
    return Kernel(fn, {"fastmath": False, **options})
