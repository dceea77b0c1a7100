"""What a kernel is made of: its file and every solver file below it, as a hash.

A caller's machine code holds that of its callees, so the hash covers the file of the kernel and every solver file it
imports, directly or not: an edit anywhere below gives another hash.
"""

from __future__ import annotations

import hashlib
import os
import re
from functools import lru_cache
from pathlib import Path

_ROOT = Path(__file__).resolve().parent
_DECORATOR = str(_ROOT / "jit.py")  # every kernel's file imports it; what it imports finds code, and makes none
_MAKER = hashlib.sha256((_ROOT / "compile.py").read_bytes()).digest()
_IMPORT = re.compile(r"^\s*from\s+(\.+)([\w.]*)\s+import\s+\(?([^)#\n]*)", re.M)


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
def source_hash(path: str) -> str:
    """sha256 over a solver file, all solver files below it, and what compiles them."""
    todo, seen = [os.path.realpath(path)], {_DECORATOR}
    while todo:
        p = todo.pop()
        if p not in seen:
            seen.add(p)
            todo += _read(p)[1]
    h = hashlib.sha256(_MAKER)
    for p in sorted(seen - {_DECORATOR}):
        h.update(os.path.basename(p).encode())
        h.update(_read(p)[0])
    return h.hexdigest()
