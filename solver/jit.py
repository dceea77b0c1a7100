"""The one `kernel` decorator: machine code cached under a hash of the sources it is made of.

A kernel is compiled when it is first called: knowing what the solver can do does not cost it. numba compiles,
and is imported only for that: code on disk is loaded by :mod:`.native`, one object for each list of argument types.
What that cannot hold (tuples as arguments or results) or cannot load goes through numba's dispatcher, made in
:mod:`.dispatch`.

A caller's machine code holds that of its callees. So the folder of a kernel is ``<user cache>/febkit/<hash>``
(:mod:`.cache`) where the hash covers the file of the kernel and every solver file it imports, directly or not; an
edit anywhere below moves to a fresh folder.
"""

from __future__ import annotations

import hashlib
import os
import re
import sys
import threading
from collections.abc import Callable
from functools import lru_cache, update_wrapper
from importlib.util import find_spec
from pathlib import Path
from typing import Any, TypeVar

from . import cache
from .compilation import compiling, paused
from .native import MISS, available, describe, linker, name_of, pack, unpack

_ROOT = Path(__file__).resolve().parent
_OWN = ("cache.py", "compile.py", "dispatch.py", "native.py")  # what makes machine code and keeps it
_MAKERS = hashlib.sha256(b"".join((_ROOT / f).read_bytes() for f in _OWN)).hexdigest()
_FINDING = threading.RLock()  # one thread at a time loads or makes machine code
_ASKING = threading.Lock()  # or a dispatcher, which a compiling thread asks for
_IMPORT = re.compile(r"^\s*from\s+(\.+)([\w.]*)\s+import\s+\(?([^)#\n]*)", re.M)
F = TypeVar("F", bound=Callable[..., Any])


@lru_cache(maxsize=None)
def _listed(folder: str) -> frozenset[str]:
    return frozenset(os.listdir(folder)) if os.path.isdir(folder) else frozenset()


@lru_cache(maxsize=None)
def _read(path: str) -> tuple[bytes, tuple[str, ...]]:
    """sha256 of a solver file, and the solver files that it imports by relative imports."""
    with open(path, "rb") as f:
        source = f.read()
    found = set()
    for dots, module, names in _IMPORT.findall(source.decode()):
        base = os.path.normpath(os.path.join(path, *[".."] * len(dots), *module.split(".")))
        folder, stem = os.path.split(base)
        if f"{stem}.py" in _listed(folder):
            found.add(f"{base}.py")
        inside = (f"{n}.py" for n in ("__init__", *(n.split(" as ")[0].strip() for n in names.split(","))))
        found |= {os.path.join(base, n) for n in inside if n in _listed(base)}
    return hashlib.sha256(source).digest(), tuple(sorted(found))


@lru_cache(maxsize=None)
def source_hash(path: Path) -> str:
    """sha256 over a solver file and all solver files below it, and the versions that compile them."""
    todo, seen = [str(path)], set()
    while todo:
        p = todo.pop()
        if p not in seen:
            seen.add(p)
            todo += _read(p)[1]
    h = hashlib.sha256(f"{_numba_version()} {sys.version_info[:2]} {_MAKERS}".encode())
    for p in sorted(seen):
        h.update(os.path.basename(p).encode())
        h.update(_read(p)[0])
    return h.hexdigest()[:24]


@lru_cache(maxsize=1)
def _numba_version() -> str:
    """What identifies the numba installed, without importing it."""
    spec = find_spec("numba")
    if spec is None or spec.origin is None:
        raise ModuleNotFoundError("numba is not installed")
    return (Path(spec.origin).parent / "_version.py").read_text()


class Kernel:
    """A function that becomes machine code when it is first called, from Python or from another kernel."""

    def __init__(self, function: Callable[..., Any], options: dict[str, Any]) -> None:
        self.function, self.options = function, options
        self._compiled: Any = None
        self._native: tuple[Callable[..., Any], ...] = ()  # loaded, one for each list of argument types
        self._seen: set[str] = set()  # lists of argument types met before
        update_wrapper(self, function)

    @property
    def compiled(self) -> Any:
        """numba's dispatcher, made when it is first asked for."""
        if self._compiled is None:
            with _ASKING:
                if self._compiled is None:
                    from .dispatch import dispatcher

                    self._compiled = dispatcher(self.function, self.options, self.folder, self.source)
        return self._compiled

    @property
    def _numba_type_(self) -> Any:
        """What numba asks a global of a kernel for: kernels call one another as dispatchers."""
        return self.compiled._numba_type_

    @property
    def folder(self) -> Path | None:
        """Where the kernel's machine code is kept; None where it cannot be."""
        root = cache.root()
        if root is None:
            cache.unkept()
            return None
        return root / source_hash(Path(self.function.__code__.co_filename).resolve())

    @property
    def source(self) -> str | None:
        """What tells a kernel from others of its folder: its name, and the numbers and kernels it encloses.

        None where it encloses what has no name on disk.
        """
        fn = self.function
        enclosed = [c.cell_contents for c in fn.__closure__ or ()]
        if not all(isinstance(c, (int, float, str, Kernel)) for c in enclosed):
            return None
        return " ".join([fn.__qualname__, *(c.__qualname__ if isinstance(c, Kernel) else repr(c) for c in enclosed)])

    def __call__(self, *args: Any) -> Any:
        for native in self._native:
            out = native(*args)
            if out is not MISS:
                return out
        types = describe(args) if available() else None
        if types is not None and types not in self._seen:
            with _FINDING:  # the first caller finds the code, the others wait for it
                if types not in self._seen:
                    found = self._find(types)
                    self._native += (found,) if found else ()
                    self._seen.add(types)
            return self(*args)
        return self.compiled(*args)

    def _find(self, types: str) -> Callable[..., Any] | None:
        """Machine code for the described arguments, from disk or made now; None where numba must do."""
        try:
            folder, source = self.folder, self.source
            if folder is None or source is None:
                raise LookupError("it has no place or no name on disk")
            name = name_of(self.__name__, f"{folder.name} {source}", types)
            path = folder / f"{name}.o"
            stored = cache.read(path) or self._make(path, types)
            code, undefined = unpack(stored)
            return linker().link(code, name, undefined)
        except Exception as e:  # numba's dispatcher runs it, or says what is wrong with it
            if os.environ.get("FEBKIT_NATIVE") == "1":
                raise RuntimeError(f"no machine code of its own for {self.__name__}({types}): {e}") from e
            return None

    def _make(self, path: Path, types: str) -> bytes:
        """Machine code for the described arguments, made by this process or by one that was quicker."""
        with paused(), cache.turn(path):
            stored = cache.read(path)
            if stored is None:
                with compiling(self.function):
                    from .compile import compiled

                    stored = pack(*compiled(self.function, self.options, types, path.stem))
                cache.write(path, stored)
            return stored

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") or name == "_compiled":
            raise AttributeError(name)
        return getattr(self.compiled, name)


def kernel(fn: F | None = None, **options: Any) -> Any:
    """Machine code as by ``numba.njit(nogil=True)``, in the cache folder described above, at the first call.

    Kernels release the GIL: the solver runs them on slices of the elements from a pool of threads.
    Kernels take arrays and scalars only (a kernel passed as an argument would recompile per process).
    """
    if fn is None:
        return lambda f: kernel(f, **options)
    # said to each: else a kernel takes the mode of the first that calls it, and its rounding depends on which that was
    return Kernel(fn, {"fastmath": False, **options})
