"""What cells feel: shape, strain, stress and mass exchange, and how well two models agree about it."""

from __future__ import annotations

from typing import Any

_NAMES = {
    "METRICS": "cells",
    "FIELDS": "fields",
    "cell_metrics": "cells",
    "element_fields": "fields",
    "select_cells": "selection",
    "summarize": "summary",
    "compare": "agreement",
    "bland_altman": "agreement",
    "at_moments": "agreement",
    "spread": "agreement",
    "rank_correlation": "agreement",
    "compare_orders": "agreement",
    "align": "agreement",
    "in_units_of": "agreement",
    "Table": "tables",
}
__all__ = list(_NAMES)


def __dir__() -> list[str]:
    return sorted({*globals(), *_NAMES})


def __getattr__(name: str) -> Any:
    """Load a name's module when it is first used: importing febkit.metrics costs nothing."""
    from importlib import import_module

    if name not in _NAMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_NAMES[name]}"), name)
