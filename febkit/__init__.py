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

    from febkit import materials
    from febkit.feb import write
    from febkit.fitting import Experiment, Parameter, fit
    from febkit.modelling import Model
    from febkit.modelling.curves import Curve
    from febkit.modelling.model import read
    from febkit.results import open as open_results
    from febkit.sampling.sweep import sweep
    from febkit.solving import solve
    from febkit.viewer import view

# public name -> (module, name there); imported when first used, so that `import febkit` costs nothing
_LAZY = {
    "read": ("febkit.modelling.model", "read"),
    "write": ("febkit.feb", "write"),
    "solve": ("febkit.solving", "solve"),
    "open_results": ("febkit.results", "open"),
    "sweep": ("febkit.sampling.sweep", "sweep"),
    "view": ("febkit.viewer", "view"),
    "Model": ("febkit.modelling", "Model"),
    "Curve": ("febkit.modelling.curves", "Curve"),
    "fit": ("febkit.fitting", "fit"),
    "Experiment": ("febkit.fitting", "Experiment"),
    "Parameter": ("febkit.fitting", "Parameter"),
}

__all__ = [
    "Curve", "Experiment", "Model", "Parameter", "__version__", "fit", "materials", "open_results", "read", "solve",
    "sweep", "view", "write",
]  # fmt: skip

_watch_meshio()


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})


def __getattr__(name: str) -> Any:
    if name in _LAZY:
        from importlib import import_module

        module, attribute = _LAZY[name]
        return getattr(import_module(module), attribute)
    if name == "materials":
        from importlib import import_module

        return import_module("febkit.materials")
    raise AttributeError(f"module 'febkit' has no attribute {name!r}")
