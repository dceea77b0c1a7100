"""Figures, drawn without a display: functions of datasets that return matplotlib figures, which notebooks show."""

from __future__ import annotations

from typing import Any

_NAMES = {
    "histories": "history",
    "early_exchange": "history",
    "bland_altman": "agreement",
    "outside_counts": "agreement",
    "errors": "agreement",
    "convergence": "agreement",
    "xy": "curve",
    "profiles": "depth",
    "depth_map": "depth",
    "sizes": "depth",
    "sections": "section",
    "cut": "section",
    "scene": "render",
    "movie": "animation",
    "fitted": "residuals",
    "save": "canvas",
}
__all__ = list(_NAMES)


def __dir__() -> list[str]:
    return sorted({*globals(), *_NAMES})


def __getattr__(name: str) -> Any:
    """Load a name's module when it is first used: importing febkit.plots costs nothing."""
    from importlib import import_module

    if name not in _NAMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_NAMES[name]}"), name)
