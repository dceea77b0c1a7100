"""A whole study as a graph of steps: build, solve, couple, solve, measure, compare."""

from __future__ import annotations

from typing import Any

_NAMES = {
    "Study": "config",
    "read": "config",
    "Place": "plan",
    "Plan": "plan",
    "make_plan": "plan",
    "Store": "store",
    "results": "gather",
    "Finished": "gather",
    "write_results": "gather",
    "finished": "gather",
    "status": "gather",
    "failures": "gather",
    "agreements": "gather",
    "Summary": "run",
    "carry_out": "run",
    "write_report": "report",
}
__all__ = list(_NAMES)


def __dir__() -> list[str]:
    return sorted({*globals(), *_NAMES})


def __getattr__(name: str) -> Any:
    """Load a name's module when it is first used: importing febkit.study costs nothing."""
    from importlib import import_module

    if name not in _NAMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_NAMES[name]}"), name)
