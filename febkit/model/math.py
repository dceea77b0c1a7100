"""FEBio's formulas: text to a numpy function, by a parser of our own; the text is never evaluated as code.

Grammar and meaning follow FEBio 4.11 (FECore, MObjBuilder and MFunctions): blanks do not count; ``^`` binds
tightest and from the left (2^3^2 = 64); a minus sign takes the whole power after it (-x^2 = -(x^2),
2^-x = 2^(-x)); ``|x|`` is the absolute value, ``x!`` the factorial; ``log`` has base 10 and ``ln`` is
natural; ``H(0)`` = 1/2, ``step(0)`` = 1, ``sgn(0)`` = 1; ``mod`` keeps the sign of its first argument;
``a = x+y; 2*a`` substitutes text. Names are case-sensitive.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import reduce
from typing import Any, TypeAlias

import numpy as np

from .source import InputError, UnsupportedError, Where

Number: TypeAlias = Any  # a float or an array of floats
MAX_DEPTH = 60
MAX_LENGTH = 1_000_000
CONSTANTS = {"pi": math.pi, "e": math.e, "gamma": 0.57721566490153286061, "_inf_": 1e308}
SPACE = frozenset("XYZ")


def _special(name: str) -> Callable[[Number], Number]:
    def f(x: Number) -> Number:
        import scipy.special  # paid for only where an array asks for it

        return getattr(scipy.special, name)(x)

    return f


def _factorial(n: float) -> float:
    p = 1.0
    while n > 1.0 and p < math.inf:
        p *= n
        n -= 1.0
    return p


def _falling(a: float, b: float) -> float:
    lo, hi, p = min(a, b), max(a, b), 1.0
    while hi >= lo and 0 < abs(p) < math.inf:
        p *= hi
        hi -= 1.0
    return p


def _binomial(n: float, r: float) -> float:
    if n == r or r == 0.0:
        return 1.0
    return _falling(n, r + 1) / _factorial(n - r) if r >= n / 2 else _falling(n, n - r + 1) / _factorial(r)


def _chebyshev(n: Number, x: Number) -> Number:
    order = int(np.ravel(n)[0])
    if order > 10_000:
        raise InputError("Tn(n, x): n is too large")
    a, b = np.ones_like(x, dtype=float), np.asarray(x, dtype=float)
    if order <= 0:
        return a
    for _ in range(order - 1):
        a, b = b, 2 * x * b - a
    return b


FUNCTIONS: dict[str, Callable[[Number], Number]] = {
    "cos": np.cos, "sin": np.sin, "tan": np.tan,
    "csc": lambda x: 1.0 / np.sin(x), "sec": lambda x: 1.0 / np.cos(x), "cot": lambda x: 1.0 / np.tan(x),
    "acos": np.arccos, "asin": np.arcsin, "atan": np.arctan,
    "cosh": np.cosh, "sinh": np.sinh, "tanh": np.tanh, "acosh": np.arccosh,
    "ln": np.log, "log": np.log10, "exp": np.exp, "sqrt": np.sqrt, "abs": np.abs,
    "sgn": lambda x: np.where(np.less(x, 0), -1.0, 1.0),
    "H": lambda x: np.heaviside(x, 0.5),
    "step": lambda x: np.where(np.less(x, 0), 0.0, 1.0),
    "sinc": lambda x: np.sinc(np.asarray(x) / np.pi),
    "fl": lambda x: x,
    "fac": np.vectorize(_factorial, otypes=[float]),
    "erf": _special("erf"), "erfc": _special("erfc"), "tgamma": _special("gamma"),
    "J0": _special("j0"), "J1": _special("j1"), "Y0": _special("y0"), "Y1": _special("y1"),
}
FUNCTIONS2: dict[str, Callable[[Number, Number], Number]] = {
    "atan2": np.arctan2, "pow": np.power, "mod": np.fmod, "Tn": _chebyshev,
    "binomial": np.vectorize(_binomial, otypes=[float]),
}
FUNCTIONSN: dict[str, Callable[..., Number]] = {
    "max": lambda *a: reduce(np.maximum, a),
    "min": lambda *a: reduce(np.minimum, a),
    "avg": lambda *a: sum(a) / len(a),
}
# the same on single numbers, much quicker there
SCALAR: dict[str, Callable[[float], float]] = {
    "cos": math.cos, "sin": math.sin, "tan": math.tan, "acos": math.acos, "asin": math.asin,
    "atan": math.atan, "cosh": math.cosh, "sinh": math.sinh, "tanh": math.tanh, "acosh": math.acosh,
    "ln": math.log, "log": math.log10, "exp": math.exp, "sqrt": math.sqrt, "abs": abs,
    "sgn": lambda x: -1.0 if x < 0 else 1.0,
    "H": lambda x: 1.0 if x > 0 else 0.0 if x < 0 else 0.5 if x == 0 else x,
    "step": lambda x: 0.0 if x < 0 else 1.0,
    "fac": _factorial, "erf": math.erf, "erfc": math.erfc, "tgamma": math.gamma,
}
SYMBOLIC = frozenset(("derive", "replace", "taylor", "integrate", "expand", "simplify", "solve", "collect",
                      "identity", "mdiag", "transpose", "trace", "det", "inverse"))

_NAME = re.compile(r"(?<![\w.])[A-Za-z_][\w.]*")
_TOKEN = re.compile(
    r"(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)"
    r"|(?P<name>[A-Za-z_](?:[\w.]|\{[^{}]*\})*|\$\{[^{}]*\})"
    r"|(?P<op>==|[-+*/^()|!,=])"
)


# -- tree: tuples ("num", v), ("var", name), ("call", name, args), ("sum", [(sign, x)]),
#    ("product", [(power of +1 or -1, x)]), ("pow", a, b), ("neg", a)
Node: TypeAlias = tuple[Any, ...]


class _Parser:
    def __init__(self, text: str, where: Where | None) -> None:
        self.where = where
        self.shown = text if len(text) <= 80 else text[:77] + "..."
        self.text = self._substitute("".join(text.split()))
        self.tokens = self._tokens()
        self.at = 0
        self.depth = 0

    def error(self, message: str) -> InputError:
        return InputError(f'formula "{self.shown}": {message}', self.where)

    def _substitute(self, text: str) -> str:
        """``name=text;`` definitions in front of the last statement are put in by text, in brackets."""
        *definitions, last = text.split(";")
        given: dict[str, str] = {}
        for d in definitions:
            name, sign, value = d.partition("=")
            if not sign or not value or not _NAME.fullmatch(name):
                raise self.error(f'"{d};" is no definition')
            given[name] = value
        return self._expand(last, given, {}, 0) if given else last

    def _expand(self, text: str, given: dict[str, str], done: dict[str, str], depth: int) -> str:
        """The text with names put in; ``done``: definitions that are expanded already, together of bounded length."""
        if depth > MAX_DEPTH:
            raise self.error("its definitions refer to each other without end, or too deeply")

        def put(m: re.Match[str]) -> str:
            name = m.group()
            if name not in given:
                return name
            if name not in done:
                done[name] = f"({self._expand(given[name], given, done, depth + 1)})"
                if sum(map(len, done.values())) > MAX_LENGTH:
                    raise self.error("too long")
            return done[name]

        out, at, length = [], 0, 0
        for m in _NAME.finditer(text):
            out += [text[at:m.start()], put(m)]
            at = m.end()
            length += len(out[-2]) + len(out[-1])
            if length > MAX_LENGTH:
                raise self.error("too long")
        return "".join([*out, text[at:]])

    def _tokens(self) -> list[tuple[str, str]]:
        out, at = [], 0
        while at < len(self.text):
            m = _TOKEN.match(self.text, at)
            if m is None:
                raise self.error(f"{self.text[at]!r} is not understood")
            out.append((str(m.lastgroup), m.group()))
            at = m.end()
        return out

    @property
    def token(self) -> str:
        return self.tokens[self.at][1] if self.at < len(self.tokens) else ""

    def take(self, expected: str) -> None:
        if self.token != expected:
            place = f'before "{self.token}"' if self.token else "at the end"
            raise self.error(f'"{expected}" is missing {place}')
        self.at += 1

    def parse(self) -> Node:
        node = self.sum()
        if self.at < len(self.tokens):
            raise self.error(f'"{self.token}" is not expected there')
        return node

    def sum(self) -> Node:
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise self.error(f"brackets are nested more than {MAX_DEPTH} deep")
        terms = [(1, self.product())]
        while self.token in ("+", "-"):
            sign = 1 if self.token == "+" else -1
            self.at += 1
            terms.append((sign, self.product()))
        self.depth -= 1
        return terms[0][1] if len(terms) == 1 else ("sum", terms)

    def product(self) -> Node:
        factors = [(1, self.power())]
        while self.token in ("*", "/"):
            sign = 1 if self.token == "*" else -1
            self.at += 1
            factors.append((sign, self.power()))
        return factors[0][1] if len(factors) == 1 else ("product", factors)

    def power(self) -> Node:
        self.depth += 1
        if self.depth > 4 * MAX_DEPTH:
            raise self.error("too many signs in a row")
        node, n = self.primary(), 0
        while self.token == "^":
            self.at += 1
            node, n = ("pow", node, self.primary()), n + 1
            if n > MAX_DEPTH:
                raise self.error("too many powers in a row")
        self.depth -= 1
        return node

    def primary(self) -> Node:
        kind, token = self.tokens[self.at] if self.at < len(self.tokens) else ("", "")
        self.at += 1
        node: Node
        if kind == "number":
            node = ("num", float(token))
        elif kind == "name":
            node = self.named(token[2:-1] if token.startswith("${") else token)
        elif token == "-":
            node = ("neg", self.power())
        elif token == "(":
            node = self.sum()
            self.take(")")
        elif token == "|":
            node = ("call", "abs", [self.sum()])
            self.take("|")
        elif not token:
            raise self.error("it ends too early")
        else:
            raise self.error(f'"{token}" is not expected there')
        n = 0
        while self.token == "!":
            self.at += 1
            node, n = ("call", "fac", [node]), n + 1
            if n > MAX_DEPTH:
                raise self.error("too many factorials in a row")
        return node

    def named(self, name: str) -> Node:
        if self.token != "(":
            return ("num", CONSTANTS[name]) if name in CONSTANTS else ("var", name)
        self.at += 1
        if name in SYMBOLIC:
            raise UnsupportedError(f'formula "{self.shown}": {name}() is not supported', self.where)
        args = [self.sum()]
        while self.token == ",":
            self.at += 1
            args.append(self.sum())
        self.take(")")
        wanted = 1 if name in FUNCTIONS else 2 if name in FUNCTIONS2 else len(args)
        if name not in FUNCTIONS and name not in FUNCTIONS2 and name not in FUNCTIONSN:
            raise self.error(f"there is no function {name}()")
        if len(args) != wanted:
            raise self.error(f"{name}() takes {wanted} argument(s), not {len(args)}")
        return ("call", name, args)


# -- compilation: a node becomes (names it needs, function of an environment)
Env: TypeAlias = Mapping[str, Number]
Code: TypeAlias = Callable[[Env], Number]


@dataclass(frozen=True, slots=True)
class _Piece:
    names: frozenset[str]
    run: Code
    array: bool  # may be an array: then numpy's functions, else those of single numbers


def _scalar(fast: Callable[..., float], slow: Callable[..., Number]) -> Callable[..., float]:
    """A function of single numbers with C's answers (inf, nan) where Python would raise."""
    def f(*x: float) -> float:
        try:
            return fast(*x)
        except (ValueError, OverflowError, ZeroDivisionError, TypeError):
            with np.errstate(all="ignore"):
                return float(slow(*(np.float64(v) for v in x)))
    return f


def _divide(a: float, b: float) -> float:
    return a / b


def _fmod(a: float, b: float) -> float:
    return math.fmod(a, b)


_DIVIDE = _scalar(_divide, np.divide)
_POWER = _scalar(math.pow, np.power)
_SCALAR2: dict[str, Callable[..., float]] = {"atan2": math.atan2, "pow": math.pow, "mod": _fmod}


def _power(x: Number, n: Number) -> Number:
    """x^n, by products where n is a small whole number."""
    if isinstance(n, float) and n in (2.0, 3.0, 4.0):
        y = x * x
        return y if n == 2.0 else y * x if n == 3.0 else y * y
    return np.power(x, n)


class _Compiler:
    def __init__(self, constants: Mapping[str, float], scalars: frozenset[str]) -> None:
        self.constants, self.scalars = constants, scalars

    def __call__(self, node: Node) -> _Piece:
        piece: _Piece = getattr(self, "_" + node[0])(*node[1:])
        if not piece.names and node[0] != "num":
            return self._num(_fold(piece.run({})))
        return piece

    def _num(self, v: float) -> _Piece:
        return _Piece(frozenset(), lambda env: v, False)

    def _var(self, name: str) -> _Piece:
        if name in self.constants:
            return self._num(float(self.constants[name]))
        return _Piece(frozenset((name,)), lambda env: env[name], name not in self.scalars)

    def _neg(self, a: Node) -> _Piece:
        p = self(a)
        return _Piece(p.names, lambda env: -p.run(env), p.array)

    def _pow(self, a: Node, b: Node) -> _Piece:
        p, q = self(a), self(b)
        f = _power if p.array or q.array else _POWER
        return _Piece(p.names | q.names, lambda env: f(p.run(env), q.run(env)), p.array or q.array)

    def _call(self, name: str, args: list[Node]) -> _Piece:
        parts = [self(a) for a in args]
        array = any(p.array for p in parts)
        names = frozenset().union(*(p.names for p in parts))
        slow: Callable[..., Number] = (FUNCTIONS.get(name) or FUNCTIONS2.get(name) or FUNCTIONSN[name])  # type: ignore[assignment]
        f = slow
        if not array:
            fast = SCALAR.get(name) or _SCALAR2.get(name)
            f = _scalar(fast, slow) if fast is not None else lambda *x: float(slow(*x))
        if len(parts) == 1:
            run = parts[0].run
            return _Piece(names, lambda env: f(run(env)), array)
        runs = [p.run for p in parts]
        return _Piece(names, lambda env: f(*[r(env) for r in runs]), array)

    def _sum(self, terms: list[tuple[int, Node]]) -> _Piece:
        parts = [(s, self(x)) for s, x in terms]
        names = frozenset().union(*(p.names for _, p in parts))
        fixed = sum(s * p.run({}) for s, p in parts if not p.names)
        single = [(s, p.run) for s, p in parts if p.names and not p.array]
        arrays = [(s, p.run) for s, p in parts if p.array]

        def run(env: Env) -> Number:
            v: Number = fixed
            for s, f in single:
                v = v + f(env) if s > 0 else v - f(env)
            for s, f in arrays:
                v = v + f(env) if s > 0 else v - f(env)
            return v

        return _Piece(names, run, bool(arrays))

    def _product(self, factors: list[tuple[int, Node]]) -> _Piece:
        parts = [(s, self(x)) for s, x in factors]
        names = frozenset().union(*(p.names for _, p in parts))
        single = [(s, p.run) for s, p in parts if not p.array]
        arrays = [(s, p.run) for s, p in parts if p.array]

        def run(env: Env) -> Number:
            v: Number = 1.0
            for s, f in single:
                v = v * f(env) if s > 0 else _DIVIDE(v, f(env))
            for s, f in arrays:
                v = v * f(env) if s > 0 else np.divide(v, f(env))
            return v

        return _Piece(names, run, bool(arrays))


def _fold(v: Number) -> float:
    return float(v)


@dataclass(frozen=True, slots=True)
class Formula:
    """A compiled formula. ``names`` are the variables it needs."""

    text: str
    names: frozenset[str]
    _run: Code = field(repr=False)

    @property
    def steady(self) -> bool:
        """True where time does not occur."""
        return "t" not in self.names

    @property
    def uniform(self) -> bool:
        """True where no place occurs (X, Y, Z)."""
        return not self.names & SPACE

    def __call__(self, X: Number = 0.0, Y: Number = 0.0, Z: Number = 0.0, t: float = 0.0,
                 **extra: Number) -> Number:
        """Value at reference positions X, Y, Z and time t, other variables by name; a float or an array."""
        return self.at({"X": X, "Y": Y, "Z": Z, "t": t, **extra})

    def at(self, env: Env) -> Number:
        """Value where every variable is looked up in ``env``."""
        with np.errstate(all="ignore"):
            return self._run(env)


def compile(text: str, variables: Iterable[str] | None = ("X", "Y", "Z", "t"),
            constants: Mapping[str, float] | None = None, where: Where | None = None,
            scalars: Iterable[str] = ("t",)) -> Formula:
    """The formula ``text``.

    ``variables`` are the names it may use (None: any; see :attr:`Formula.names`), ``constants`` numbers
    put in at once, ``scalars`` variables that are never arrays. Raises InputError, with the place ``where``.
    """
    if len(text) > MAX_LENGTH:
        raise InputError(f"a formula of {len(text)} characters is too long", where)
    if not text.strip():
        raise InputError("a formula is empty", where)
    parser = _Parser(text, where)
    try:
        piece = _Compiler(constants or {}, frozenset(scalars))(parser.parse())
    except InputError:
        raise
    except (ArithmeticError, ValueError, TypeError, RecursionError) as e:
        raise parser.error(str(e)) from None
    if variables is not None:
        strange = sorted(piece.names - frozenset(variables))
        if strange:
            raise parser.error(f"unknown variable {', '.join(strange)}; known are {', '.join(variables)}"
                               + (", " + ", ".join(sorted(constants)) if constants else ""))
    return Formula(text, piece.names, piece.run)


def value(text: str, t: float = 0.0, where: Where | None = None) -> float:
    """The number that a formula of time alone gives."""
    return float(compile(text, ("t",), where=where)(t=t))


