"""Numbers on the command line: finite, within limits."""

from __future__ import annotations

from math import isfinite
from typing import Any

import click


class Finite(click.FloatRange):
    """A number that is neither infinite nor nan; both pass click's own comparisons."""

    name = "number"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        number = super().convert(value, param, ctx)
        if not isfinite(number):
            self.fail(f"{value} is not finite", param, ctx)
        return number


FINITE = Finite()
POSITIVE = Finite(0.0, min_open=True)
NOT_NEGATIVE = Finite(0.0)
