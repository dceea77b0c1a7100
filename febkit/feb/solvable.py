"""Whether febkit can solve an input: the model is lowered for the solver, and nothing is compiled or solved."""

from __future__ import annotations

from importlib.util import find_spec

from febkit.model import InputError, Model, Where

from .findings import Finding


def ask(model: Model) -> list[Finding]:
    """What febkit's solver lacks for a model; empty where it can solve it."""
    place = Where(model.file)
    if find_spec("febkit.lower") is None:
        return [Finding("hint", "febkit is installed without its solver", place)]
    from febkit.lower import unsupported

    try:
        return [Finding("unsupported", e.message, e.where or place) for e in unsupported(model)]
    except InputError as e:
        return [Finding("error", e.message, e.where or place)]
    except (ArithmeticError, LookupError, TypeError, ValueError, AssertionError) as e:
        # what the checks before have let through, of whatever kind, must not end them
        return [Finding("unsupported", f"setting up the solver failed: {type(e).__name__}: {e}", place)]
