"""febkit: read, write, convert and solve FEBio models; tissue-to-cell hand-off; results as xarray.

>>> import febkit
>>> model = febkit.read("model.feb")                     # doctest: +SKIP
>>> result = febkit.solve(model, plotfile="model.xplt")  # doctest: +SKIP
>>> ds = febkit.open_results("model.xplt")               # doctest: +SKIP
"""

from __future__ import annotations

from ._version import __version__
from .meshio_start import watch as _watch_meshio

TYPE_CHECKING = False  # importing typing would be most of the cost of importing febkit
if TYPE_CHECKING:
    from typing import Any

    from febkit.feb import read, write
    from febkit.results import open as open_results
    from febkit.solving import solve

# public name -> (module, name there); imported when first used, so that `import febkit` costs nothing
_LAZY = {
    "read": ("febkit.feb", "read"),
    "write": ("febkit.feb", "write"),
    "solve": ("febkit.solving", "solve"),
    "open_results": ("febkit.results", "open"),
}

__all__ = ["__version__", "open_results", "read", "solve", "write"]

_watch_meshio()


def __getattr__(name: str) -> Any:
    if name in _LAZY:
        from importlib import import_module

        module, attribute = _LAZY[name]
        return getattr(import_module(module), attribute)
    raise AttributeError(f"module 'febkit' has no attribute {name!r}")
