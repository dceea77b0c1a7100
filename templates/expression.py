"""Small expressions in template files: ``${depth/2}``, ``if="case in ('A', 'C')"``, ``for="i in cells"``."""

from __future__ import annotations

import ast
import math
import operator
import re
from collections.abc import Callable, Mapping
from itertools import pairwise
from typing import Any

from febkit.model import InputError, Where

from .materials import mixture

_PLACE = re.compile(r"\$\{([^{}]*)\}")
MOST = 1_000_000  # entries of a list, and letters of a text
BITS = 10_000  # of a whole number


def _power(a: Any, b: Any) -> Any:
    if isinstance(a, int) and isinstance(b, int) and b > 0 and a.bit_length() * b > BITS:
        raise InputError(f"a whole number of more than {BITS} bits")
    return operator.pow(a, b)


def _product(a: Any, b: Any) -> Any:
    for x, n in ((a, b), (b, a)):
        if isinstance(n, int) and isinstance(x, str | list | tuple) and len(x) * n > MOST:
            raise InputError(f"a list or text of more than {MOST} entries")
    return operator.mul(a, b)


def _range(*args: int) -> range:
    r = range(*args)
    n = max(0, -((r.start - r.stop) // r.step))  # len() knows no more than a machine's word
    if n > MOST:
        raise InputError(f"a range of more than {MOST} numbers")
    return r


_BINARY: dict[type, Callable[[Any, Any], Any]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: _product, ast.Div: operator.truediv,
    ast.Pow: _power, ast.FloorDiv: operator.floordiv, ast.Mod: operator.mod,
}
_UNARY: dict[type, Callable[[Any], Any]] = {
    ast.USub: operator.neg, ast.UAdd: operator.pos, ast.Not: operator.not_,
}
_COMPARE: dict[type, Callable[[Any, Any], Any]] = {
    ast.Eq: operator.eq, ast.NotEq: operator.ne, ast.Lt: operator.lt, ast.LtE: operator.le,
    ast.Gt: operator.gt, ast.GtE: operator.ge,
    ast.In: lambda a, b: a in b, ast.NotIn: lambda a, b: a not in b,
}


def must_points(times: list[float], longest: float, early: float = math.inf,
                until: float = 0.0) -> list[tuple[float, float]]:
    """(time, largest step to reach it) of a dtmax curve with must points at ``times``.

    Steps are no longer than ``longest``, and up to time ``until`` no longer than ``early``.
    """
    steps = [b - a for a, b in pairwise(times)]
    return [(t, min(dt, longest, early if t <= until else longest))
            for t, dt in zip(times, steps[:1] + steps, strict=True)]


FUNCTIONS: dict[str, Callable[..., Any]] = {
    "sqrt": math.sqrt, "exp": math.exp, "log": math.log, "abs": abs, "min": min, "max": max, "round": round,
    "len": len, "range": _range, "must_points": must_points, "mixture": mixture,
}


def evaluate(text: str, names: Mapping[str, Any], where: Where | None = None) -> Any:
    """Value of an expression: arithmetic, comparisons, ``a if c else b``, lists, a few functions.

    >>> evaluate("2*n + 1 if case in ('A', 'B') else 0", {"n": 3, "case": "A"})
    7
    """
    shown = text if len(text) <= 200 else text[:197] + "..."
    try:
        value = _value(ast.parse(text.strip(), mode="eval").body, names)
        if isinstance(value, complex) or (isinstance(value, float) and not math.isfinite(value)):
            raise InputError(f"its value is {value}, no finite number")
        return value
    except InputError as e:
        raise InputError(f"in the expression '{shown}': {e.message}", where) from None
    except (ArithmeticError, LookupError, MemoryError, RecursionError, SyntaxError, TypeError, ValueError) as e:
        raise InputError(f"the expression '{shown}' cannot be evaluated: {e or type(e).__name__}", where) from None


def _value(node: ast.expr, names: Mapping[str, Any]) -> Any:
    match node:
        case ast.Constant(value=v):
            return v
        case ast.Name(id=name):
            if name not in names:
                raise InputError(f"'{name}' is no parameter; known are {', '.join(sorted(names))}")
            return names[name]
        case ast.BinOp(left=a, op=op, right=b) if type(op) in _BINARY:
            return _BINARY[type(op)](_value(a, names), _value(b, names))
        case ast.UnaryOp(op=op, operand=a) if type(op) in _UNARY:
            return _UNARY[type(op)](_value(a, names))
        case ast.BoolOp(op=op, values=v):
            return (all if isinstance(op, ast.And) else any)(_value(x, names) for x in v)
        case ast.Compare(left=a, ops=[op], comparators=[b]) if type(op) in _COMPARE:
            return _COMPARE[type(op)](_value(a, names), _value(b, names))
        case ast.IfExp(test=c, body=a, orelse=b):
            return _value(a if _value(c, names) else b, names)
        case ast.Tuple(elts=v) | ast.List(elts=v):
            return [y for x in v for y in _items(x, names)]
        case ast.Subscript(value=a, slice=b):
            return _value(a, names)[_value(b, names)]
        case ast.Call(func=ast.Name(id=f), args=args, keywords=[]) if f in FUNCTIONS:
            return FUNCTIONS[f](*(_value(x, names) for x in args))
    raise InputError(f"{type(node).__name__} is not allowed in a template")


def _items(node: ast.expr, names: Mapping[str, Any]) -> list[Any]:
    """Values of an entry of a list: one, or those that a starred one holds."""
    return list(_value(node.value, names)) if isinstance(node, ast.Starred) else [_value(node, names)]


def written(value: Any) -> str:
    """A value as .feb files write it: numbers to 12 digits, lists with commas, true as 1."""
    if isinstance(value, bool):
        return "1" if value else "0"
    if isinstance(value, float):
        return format(value, ".12g")
    if isinstance(value, list | tuple):
        return ",".join(written(v) for v in value)
    return str(value)


def fill(text: str, names: Mapping[str, Any], where: Where | None = None) -> str:
    """Text with every ``${expression}`` replaced by its value."""
    return _PLACE.sub(lambda m: written(evaluate(m.group(1), names, where)), text)
