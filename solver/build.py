"""Makes the objects of the libraries that come with the wheel: ``python -m febkit.solver.build FOLDER LEVEL ...``.

Each kernel of ``shipped.txt`` becomes FOLDER/LEVEL/name.o; setup.py links them. LEVEL may be ``native`` or ``all``.
numba reads and types a kernel once; LLVM makes its code once for each level.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from importlib import import_module
from multiprocessing import get_context
from pathlib import Path

from . import library
from .calls import level
from .jit import Kernel


def kernel(name: str) -> Kernel:
    """The kernel that the table calls "kernels.vectors inner"."""
    module, _, own = name.partition(" ")
    found = getattr(import_module(f".{module}", __package__), own)
    assert isinstance(found, Kernel)
    return found


def _compile(work: tuple[Path, Sequence[str], list[str]]) -> int:
    """Write the objects of some kernels; those of a module, as they call the same others."""
    from .compile import compiled

    folder, levels, names = work
    for name in names:
        k = kernel(name)
        for types in library.table()[name]:
            symbol = k.symbol(types)
            for own, code in zip(levels, compiled(k.function, k.options, types, symbol, levels)):
                (folder / own / f"{symbol}.o").write_bytes(code)
    return len(names)


def main(folder: Path, levels: Sequence[str]) -> None:
    modules: dict[str, list[str]] = {}
    for name in library.table():
        modules.setdefault(name.split()[0], []).append(name)
    for own in levels:
        (folder / own).mkdir(parents=True, exist_ok=True)
    # what kernels call is optimised once for all levels
    os.environ.update(NUMBA_CPU_NAME=levels[len(levels) // 2], NUMBA_CPU_FEATURES="")
    print(f"compiling {len(library.table())} kernels for {', '.join(levels)}", flush=True)
    parts = [(folder, levels, names) for names in sorted(modules.values(), key=len, reverse=True)]
    with get_context("spawn").Pool(os.cpu_count()) as pool:
        for _ in pool.imap_unordered(_compile, parts):
            pass


if __name__ == "__main__":
    asked = {"native": [level()], "all": library.LEVELS if level() in library.LEVELS else [level()]}
    main(Path(sys.argv[1]), asked.get(sys.argv[2], sys.argv[2:]))
